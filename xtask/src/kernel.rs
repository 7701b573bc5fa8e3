//! The point kernel on the emulated cores: `tests/kernel` holds what is scheduled by hand, or by a compiler that fills
//! vectors, against the portable one.

use std::time::Duration;

use anyhow::{Context as _, Result};

use crate::{
    cores::{Core, Program, programs},
    emulator::Emulator,
    target::Targets,
    workspace::Workspace,
};

/// A comparison takes a minute at most where nothing else runs.
const LIMIT: Duration = Duration::from_mins(30);

/// Builds the comparison and runs it on every core that is built for.
///
/// # Errors
/// Where the build fails, or a bit differs.
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
