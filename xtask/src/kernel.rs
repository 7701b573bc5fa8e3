//! The point kernel on the emulated cores: `tests/kernel` holds what is scheduled by hand, or by a compiler that fills
//! vectors, against the portable one.

use anyhow::{Result, ensure};
use xshell::cmd;

use crate::{
    cores::{Core, Program, programs},
    route::QEMU,
    target::Targets,
    workspace::Workspace,
};

/// Builds the comparison and runs it on every core that is built for.
///
/// # Errors
/// Where the build fails, or a bit differs.
pub(crate) fn test(workspace: &Workspace, targets: &Targets<'_>) -> Result<()> {
    let _root = workspace.shell.push_dir(&workspace.root);
    for Program { core, image, .. } in programs(targets, "kernel-check")? {
        let Core { name, machine, .. } = core;
        // A minute at most where nothing else runs.
        let qemu = cmd!(
            workspace.shell,
            "timeout 1800 {QEMU} -M {machine} -display none -monitor none -serial none -semihosting-config enable=on,target=native -kernel {image}"
        );
        let output = qemu.quiet().ignore_status().output()?;
        eprint!("{name}: {}", String::from_utf8_lossy(&output.stdout));
        ensure!(
            output.status.success(),
            "the kernels differ on {machine}, or it did not end ({})",
            output.status
        );
    }
    Ok(())
}
