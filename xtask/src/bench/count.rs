//! Instructions, counted in QEMU on the emulated cores.

use std::path::PathBuf;

use anyhow::{Context as _, Result, ensure};
use serde::Deserialize;
use xshell::cmd;

use super::cost::Instructions;
use crate::{
    route::{Architecture, QEMU},
    target::{Target, Targets},
    workspace::Workspace,
};

/// A core, and the emulated machine that has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Core {
    pub(crate) name: &'static str,
    pub(crate) machine: &'static str,
    pub(crate) architecture: Architecture,
}

/// The cores.
pub(crate) const CORES: [Core; 3] = [
    Core {
        name: "cortex-m4f",
        machine: "mps2-an386",
        architecture: Architecture::Armv7em,
    },
    Core {
        name: "cortex-m7",
        machine: "mps2-an500",
        architecture: Architecture::Armv7em,
    },
    Core {
        name: "cortex-m55",
        machine: "mps3-an547",
        architecture: Architecture::Helium,
    },
];

/// A line of the counting program.
#[derive(Debug, Deserialize)]
struct Counted {
    kernel: String,
    unit: String,
    repetitions: f64,
    instructions: f64,
}

/// The counting program.
pub(super) fn image(target: &Target<'_>) -> PathBuf {
    target.programs().join("instruction-count")
}

/// Counts on every core that is built for.
pub(super) fn count(workspace: &Workspace, targets: &Targets<'_>) -> Result<Vec<Instructions>> {
    let _root = workspace.shell.push_dir(&workspace.root);
    let mut rows = Vec::new();
    for Core {
        name: core,
        machine,
        architecture,
    } in CORES
    {
        let Some(target) = targets.of(architecture) else {
            continue;
        };
        let build = target.cargo("build --release -p instruction-count");
        eprintln!("$ {build}");
        build.run()?;
        let image = image(target);
        let compiler = target.compiler()?;
        // One instruction takes one nanosecond of the emulated time.
        let qemu = cmd!(
            workspace.shell,
            "timeout 60 {QEMU} -M {machine} -display none -monitor none -serial none -icount shift=0 -semihosting-config enable=on,target=native -kernel {image}"
        );
        let counted = qemu
            .quiet()
            .read()
            .with_context(|| format!("count on {machine}"))?;
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(counted.as_bytes());
        for line in reader.deserialize() {
            let Counted {
                kernel,
                unit,
                repetitions,
                instructions,
            } = line?;
            rows.push(Instructions {
                core: core.to_owned(),
                kernel,
                count: (100.0 * instructions / repetitions).round() / 100.0,
                unit,
                compiler: compiler.clone(),
            });
        }
    }
    ensure!(!rows.is_empty(), "the counting program printed nothing");
    Ok(rows)
}
