//! Counts of instructions in QEMU on the emulated cores.

use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use serde::Deserialize;

use super::cost::Instructions;
use crate::{
    cores::{Core, Program},
    emulator::Emulator,
};

/// Longest time of the counting; it takes some seconds if nothing else runs.
const LIMIT: Duration = Duration::from_mins(10);

/// Line of the counting program's output.
#[derive(Debug, Deserialize)]
struct Counted {
    kernel: String,
    unit: String,
    repetitions: f64,
    instructions: f64,
}

/// Name of the counting program.
pub(super) const PROGRAM: &str = "instruction-count";

/// Counts on every core for which there is a program.
///
/// # Errors
/// An error if QEMU fails or prints nothing.
pub(super) fn count(emulator: &Emulator, programs: &[Program<'_>]) -> Result<Vec<Instructions>> {
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
        let counted = emulator
            .run(machine, &["-icount", "shift=0"], image, LIMIT)
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
