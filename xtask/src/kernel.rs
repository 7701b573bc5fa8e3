//! The point kernel on the emulated cores: `tests/kernel` holds it against the portable one, a point at a time.

use std::path::Path;

use anyhow::{Result, ensure};
use xshell::cmd;

use crate::{
    bench::{CORES, VECTOR_CORE},
    route::QEMU,
    target::Target,
    workspace::Workspace,
};

/// Builds the comparison and runs it on every core.
///
/// # Errors
/// Where the build fails, or a bit differs.
pub(crate) fn test(workspace: &Workspace, target: &Target<'_>) -> Result<()> {
    let _root = workspace.shell.push_dir(&workspace.root);
    let build = target.cargo("build --release -p kernel-check");
    eprintln!("$ {build}");
    build.run()?;
    for core in CORES {
        test_on(workspace, core, &target.programs().join("kernel-check"))?;
    }
    match target.build_for_vectors("kernel-check")? {
        Some(image) => test_on(workspace, VECTOR_CORE, &image),
        None => Ok(()),
    }
}

/// Runs it on one core.
fn test_on(workspace: &Workspace, (core, machine): (&str, &str), image: &Path) -> Result<()> {
    // Half a minute on a machine that does nothing else.
    let qemu = cmd!(
        workspace.shell,
        "timeout 600 {QEMU} -M {machine} -display none -monitor none -serial none -semihosting-config enable=on,target=native -kernel {image}"
    );
    let output = qemu.quiet().ignore_status().output()?;
    eprint!("{core}: {}", String::from_utf8_lossy(&output.stdout));
    ensure!(
        output.status.success(),
        "the kernels differ on {machine}, or the comparison did not end ({})",
        output.status
    );
    Ok(())
}
