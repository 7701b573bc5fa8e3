//! Emulated cores, and programs that are built for each.

use std::path::PathBuf;

use anyhow::Result;

use crate::{
    route::Architecture,
    target::{Target, Targets},
};

/// A core, and the emulated machine that has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Core {
    pub(crate) name: &'static str,
    pub(crate) machine: &'static str,
    pub(crate) architecture: Architecture,
}

/// The emulated cores.
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

/// A program for one core.
#[derive(Debug)]
pub(crate) struct Program<'a> {
    pub(crate) core: Core,
    pub(crate) target: &'a Target<'a>,
    pub(crate) image: PathBuf,
}

/// Builds a package of this workspace, whose program has its name, for every core with a target.
///
/// # Errors
/// An error if a build fails.
pub(crate) fn programs<'a>(targets: &'a Targets<'_>, package: &str) -> Result<Vec<Program<'a>>> {
    let mut programs: Vec<Program<'a>> = Vec::new();
    for core in CORES {
        let Some(target) = targets.of(core.architecture) else {
            continue;
        };
        let is_built = |built: &Program<'_>| built.core.architecture == core.architecture;
        if !programs.iter().any(is_built) {
            let build = target.cargo(&format!("build --release -p {package}"));
            eprintln!("$ {build}");
            build.run()?;
        }
        programs.push(Program {
            core,
            target,
            image: target.programs().join(package),
        });
    }
    Ok(programs)
}
