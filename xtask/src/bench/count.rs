//! Instructions, counted in QEMU on the emulated cores.

use anyhow::{Context as _, Result, ensure};
use serde::Deserialize;
use xshell::cmd;

use super::cost::Instructions;
use crate::{
    cores::{Core, Program},
    route::QEMU,
    workspace::Workspace,
};

/// A line of the counting program.
#[derive(Debug, Deserialize)]
struct Counted {
    kernel: String,
    unit: String,
    repetitions: f64,
    instructions: f64,
}

/// The counting program.
pub(super) const PROGRAM: &str = "instruction-count";

/// Counts on every core that there is a program for.
///
/// # Errors
/// Where QEMU fails, or prints nothing.
pub(super) fn count(workspace: &Workspace, programs: &[Program<'_>]) -> Result<Vec<Instructions>> {
    let mut rows = Vec::new();
    for Program {
        core,
        target,
        image,
    } in programs
    {
        let Core { name, machine, .. } = core;
        let compiler = target.compiler()?;
        // One instruction takes one nanosecond of the emulated time.
        let qemu = cmd!(
            workspace.shell,
            "timeout 600 {QEMU} -M {machine} -display none -monitor none -serial none -icount shift=0 -semihosting-config enable=on,target=native -kernel {image}"
        );
        let counted = qemu
            .quiet()
            .read()
            .with_context(|| format!("count on {machine}"))?;
        ensure!(!counted.is_empty(), "nothing was counted on {machine}");
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
                core: (*name).to_owned(),
                kernel,
                count: (100.0 * instructions / repetitions).round() / 100.0,
                unit,
                compiler: compiler.clone(),
            });
        }
    }
    Ok(rows)
}
