//! The point kernel on the emulated cores: `tests/kernel` holds what is scheduled by hand against the portable one.

use anyhow::{Result, ensure};
use xshell::cmd;

use crate::{bench::CORES, route::QEMU, target::Target, workspace::Workspace};

/// Builds the comparison and runs it on every core.
///
/// # Errors
/// Where the build fails, or a bit differs.
pub(crate) fn test(workspace: &Workspace, target: &Target<'_>) -> Result<()> {
    let _root = workspace.shell.push_dir(&workspace.root);
    let build = target.cargo("build --release -p kernel-check");
    eprintln!("$ {build}");
    build.run()?;
    let image = target.programs().join("kernel-check");
    for (core, machine) in CORES {
        // Half a minute where nothing else runs.
        let qemu = cmd!(
            workspace.shell,
            "timeout 300 {QEMU} -M {machine} -display none -monitor none -serial none -semihosting-config enable=on,target=native -kernel {image}"
        );
        let output = qemu.quiet().ignore_status().output()?;
        eprint!("{core}: {}", String::from_utf8_lossy(&output.stdout));
        ensure!(
            output.status.success(),
            "the kernels differ on {machine}, or it did not end ({})",
            output.status
        );
    }
    Ok(())
}
