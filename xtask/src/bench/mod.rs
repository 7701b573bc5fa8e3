//! `cargo xtask bench`: cost of the camera's work on the targets, counted in QEMU.

mod comparison;
mod cost;
mod cost_problem;
mod count;
mod cycles;
#[cfg(test)]
mod documented;
mod figure;
mod footprint;
mod host;
mod kernel_loop;
mod limit;
mod llvm;
mod load;
#[cfg(test)]
mod prose;
#[cfg(test)]
mod quotes;

use std::{fs, process::ExitCode};

use anyhow::{Context as _, Result, ensure};

use crate::{
    cores::{self, Program},
    emulator::Emulator,
    target::{Lints, Targets},
    tools::Toolbox,
    workspace::Workspace,
};
use cost::{Cost, Instructions, amounts};
pub(crate) use cost::{Footprint, read as read_table};
use llvm::Llvm;

/// File names of the comparison and of its figure.
const PERFORMANCE: &str = "performance.csv";
const FIGURE: &str = "performance.svg";

/// Prints counts, modelled cycles and times as CSV, and the images' footprint on the error stream;
/// draws the cost of a point on every core. With `update` it writes the tables and the figure in
/// docs, otherwise those in target/bench.
///
/// # Errors
/// An error if the set-up, a build, QEMU or a timing program fails.
pub(crate) fn run(workspace: &Workspace, update: bool) -> Result<ExitCode> {
    let toolbox = Toolbox::new(workspace);
    let emulator = Emulator::set_up(workspace, &toolbox)?;
    let targets = Targets::set_up(workspace, &toolbox, Lints::NotWanted)?;
    let llvm = Llvm::set_up(&workspace.shell, &toolbox);
    let programs = programs(workspace, &targets)?;
    let counted = count::count(&emulator, &programs)?;
    let cycles = llvm.map_or_else(|| Ok(vec![]), |llvm| cycles::cycles(&llvm, &programs))?;
    let footprint = vec![footprint::footprint(
        workspace,
        &targets.armv7em,
        &emulator,
    )?];
    for load in load::loads(&counted) {
        eprintln!("{load}");
    }
    eprint!("\n{}", cost::text(&footprint)?);
    // Limits are not written here, whatever is found.
    let measured = [amounts(&counted), amounts(&footprint)].concat();
    for finding in limit::held(&limit::read(&workspace.root)?, &measured) {
        eprintln!("note: {finding}");
    }
    if update {
        cost::replace(&workspace.root, counted.clone())?;
        cost::replace(&workspace.root, footprint)?;
    }
    // The times of the PC come last: they take minutes.
    let timed = host::times(workspace)?;
    let rows = comparison::rows(&counted, &cycles, timed);
    print!("{}", cost::text(&rows)?);
    let compared: Vec<_> = rows
        .into_iter()
        .filter(comparison::Row::is_compared)
        .collect();
    let (tables, figures) = if update {
        let docs = workspace.root.join("docs");
        (docs.clone(), docs.join("figures"))
    } else {
        let out = workspace.target_dir.join("bench");
        fs::create_dir_all(&out).with_context(|| format!("{}", out.display()))?;
        (out.clone(), out)
    };
    for (path, text) in [
        (tables.join(PERFORMANCE), cost::text(&compared)?),
        (figures.join(FIGURE), figure::svg(&compared)?),
    ] {
        fs::write(&path, text).with_context(|| format!("{}", path.display()))?;
        eprintln!("{}", path.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// Compares the counts with the committed tables and limits.
///
/// # Errors
/// An error if a cost exceeds its table or its limit, or cannot be compared.
pub(crate) fn check(
    workspace: &Workspace,
    targets: &Targets<'_>,
    emulator: &Emulator,
    toolbox: &Toolbox<'_>,
) -> Result<()> {
    let root = &workspace.root;
    let instructions: Vec<Instructions> = cost::read(&root.join(Instructions::TABLE))?;
    let footprints: Vec<Footprint> = cost::read(&root.join(Footprint::TABLE))?;
    let limits = limit::read(root)?;
    let programs = programs(workspace, targets)?;
    let counted = count::count(emulator, &programs)?;
    load::check(&load::loads(&counted))?;
    let footprint = [footprint::footprint(workspace, &targets.armv7em, emulator)?];
    let table = [amounts(&instructions), amounts(&footprints)].concat();
    let measured = [amounts(&counted), amounts(&footprint)].concat();
    for note in cost_problem::notes(&table, &limits, &measured) {
        eprintln!("note: {note}");
    }
    let findings = cost_problem::findings(&table, &limits, &measured);
    let mut text: Vec<_> = findings.iter().map(ToString::to_string).collect();
    if let Some(llvm) = Llvm::set_up(&workspace.shell, toolbox) {
        let cycles = cycles::cycles(&llvm, &programs)?;
        text.extend(cycles.iter().filter_map(cycles::Cycles::over_limit));
    }
    let text: Vec<_> = text.iter().map(|text| format!("\n    {text}")).collect();
    ensure!(
        text.is_empty(),
        "costs are not those of the tables and limits:{}",
        text.concat()
    );
    Ok(())
}

/// Compares one footprint with the committed tables and limits; with `update` it replaces its row
/// first.
///
/// # Errors
/// An error if a cost exceeds its table or its limit.
pub(crate) fn compare_footprint(
    workspace: &Workspace,
    footprint: Footprint,
    update: bool,
) -> Result<()> {
    let root = &workspace.root;
    let footprint = vec![footprint];
    if update {
        cost::replace(root, footprint.clone())?;
    }
    let table: Vec<Footprint> = cost::read(&root.join(Footprint::TABLE))?;
    let findings =
        cost_problem::findings(&amounts(&table), &limit::read(root)?, &amounts(&footprint));
    let text: Vec<_> = findings
        .iter()
        .map(|found| format!("\n    {found}"))
        .collect();
    ensure!(
        text.is_empty(),
        "costs are not those of the tables and limits:{}",
        text.concat()
    );
    Ok(())
}

/// Builds the counting program for every core.
fn programs<'a>(workspace: &Workspace, targets: &'a Targets<'_>) -> Result<Vec<Program<'a>>> {
    let _root = workspace.shell.push_dir(&workspace.root);
    cores::programs(targets, count::PROGRAM)
}
