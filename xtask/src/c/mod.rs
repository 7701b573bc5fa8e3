//! `cargo xtask c`: the library for C, with its header and what build systems need, checked by
//! programs in C on this PC and in QEMU.

mod build_systems;
mod compiler;
mod cost;
mod header;
mod library;
mod package;
mod program;

use std::{fs, process::ExitCode};

use anyhow::{Context as _, Result};

use self::{
    build_systems::Trial,
    compiler::{Compiler, host_compiler},
    library::Library,
    program::Programs,
};
use crate::{
    NOT_CHECKED, NOT_STARTED, bench, checks::Step, emulator::Emulator, equipment::Equipment,
    route::Architecture, target::Target, tools::Toolbox, workspace::Workspace,
};

/// Directory of the crate, from the root.
const CRATE: &str = "bindings/c";

/// Builds the library into target/c and checks it; with `update` its sizes go into the table.
///
/// # Errors
/// An error if the set-up fails, or a check.
pub(crate) fn run(workspace: &Workspace, update: bool) -> Result<ExitCode> {
    let needs = Step::C.needs();
    let equipment = Equipment::for_needs(workspace, needs);
    if let Some(lack) = equipment.lack(needs) {
        eprintln!("xtask: the library for C was not built: {lack}");
        return Ok(ExitCode::from(NOT_STARTED));
    }
    let _root = workspace.shell.push_dir(&workspace.root);
    let target = &equipment.targets()?.armv7em;
    build(
        workspace,
        target,
        equipment.emulator()?,
        equipment.toolbox(),
        update,
    )?;
    println!("{}", directory(workspace).display());
    Ok(ExitCode::SUCCESS)
}

/// Builds the library and checks it.
///
/// # Errors
/// An error if a build or a check fails.
pub(crate) fn check(
    workspace: &Workspace,
    target: &Target<'_>,
    emulator: &Emulator,
    toolbox: &Toolbox<'_>,
) -> Result<()> {
    build(workspace, target, emulator, toolbox, false)
}

/// Returns the directory of what is built.
fn directory(workspace: &Workspace) -> std::path::PathBuf {
    workspace.target_dir.join("c")
}

fn build(
    workspace: &Workspace,
    target: &Target<'_>,
    emulator: &Emulator,
    toolbox: &Toolbox<'_>,
    update: bool,
) -> Result<()> {
    let out = directory(workspace);
    let _lock = Workspace::lock(&out, "builds the library for C")?;
    let gcc = Compiler::for_arm(workspace, toolbox)?;
    let control = library::with_control(workspace, target, &out)?;
    let armv7em = Library::build(workspace, target, Architecture::Armv7em, &out)?;
    let mut libraries = vec![armv7em];
    for architecture in [Architecture::Armv7emSoft, Architecture::Armv8m] {
        match Target::without_fetching(workspace, toolbox, architecture)? {
            Ok(target) => libraries.push(Library::build(workspace, &target, architecture, &out)?),
            Err(lack) => eprintln!("{NOT_CHECKED}C on {}: {lack}", architecture.target()),
        }
    }
    package::write(workspace, &out, &libraries)?;
    header::check(workspace, &gcc, toolbox, &out)?;

    let programs = Programs::new(workspace, &out);
    let mut printed = None;
    let host = host_compiler(workspace);
    if let Some(host) = &host {
        let library = library::for_host(workspace, &out)?;
        printed = Some(programs.on_host(host, &library)?);
    } else {
        eprintln!("{NOT_CHECKED}C on this PC: no cc on the search path");
    }
    for library in &libraries {
        programs.in_emulator(&gcc, library, emulator, printed.as_ref())?;
    }
    programs.refuses_panic(&gcc, &control)?;
    let trial = Trial {
        workspace,
        programs: &programs,
        emulator,
        out: &out,
        libraries: &libraries,
        arm: &gcc,
        host: host.as_ref(),
    };
    trial.run(toolbox)?;

    let cost = cost::measure(&programs, &gcc, &control, emulator, target)?;
    let stacks = cost.stacks();
    fs::write(out.join("stack.csv"), &stacks).context("stack.csv")?;
    eprint!("{stacks}");
    eprintln!(
        "{} bytes of code and constants, {} of variables; a call takes {} instructions over correct_slice",
        cost.footprint.flash_bytes, cost.footprint.static_ram_bytes, cost.over_bare
    );
    cost.is_within_limits()?;
    cost.is_documented(&workspace.root.join("docs/c.md"))?;
    bench::compare_footprint(workspace, cost.footprint, update)
}
