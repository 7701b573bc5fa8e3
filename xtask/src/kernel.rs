//! Point kernel on the emulated cores: `tests/kernel` compares the hand-scheduled kernel, or the
//! one that a compiler vectorised, with the portable one.

use std::time::Duration;

use anyhow::{Context as _, Result};

use crate::{
    cores::{Core, Program, programs},
    emulator::Emulator,
    target::Targets,
    workspace::Workspace,
};

/// Longest time of a comparison; it takes a minute at most if nothing else runs.
const LIMIT: Duration = Duration::from_mins(30);

/// Builds the comparison and runs it on every core with a target.
///
/// # Errors
/// An error if the build fails, or if a bit differs.
pub(crate) fn test(
    workspace: &Workspace,
    targets: &Targets<'_>,
    emulator: &Emulator,
) -> Result<()> {
    let _root = workspace.shell.push_dir(&workspace.root);
    for Program { core, image, .. } in programs(targets, "kernel-check")? {
        let Core { name, machine, .. } = core;
        let printed = emulator.run(machine, &[], &image, LIMIT);
        let printed =
            printed.with_context(|| format!("the kernels differ on {name}, or did not end"))?;
        eprint!("{name}: {printed}");
    }
    Ok(())
}
