//! `cargo xtask python`: the wheel for Python, tested with the packages that use it.

mod build;
mod packages;

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::{Context as _, Result, ensure};
use xshell::cmd;

use self::build::Link;
use crate::{
    NOT_CHECKED,
    equipment::Equipment,
    exchange,
    python::{Python, succeed},
    tools::Toolbox,
    verify,
    workspace::Workspace,
};

/// Directory of the crate, from the root.
const CRATE: &str = "bindings/python";

/// Largest size of the wheel, bytes.
const LARGEST_WHEEL: u64 = 1_000_000;

/// Builds the wheel into target/python, tests it with everything that can be had, and takes times.
///
/// # Errors
/// An error if the set-up fails, or a check.
pub(crate) fn run(workspace: &Workspace) -> Result<ExitCode> {
    let equipment = Equipment::for_needs(workspace, &[]);
    let _root = workspace.shell.push_dir(&workspace.root);
    let python = python(workspace, equipment.toolbox())?;
    let (python, link) = match python.clone().and(workspace, "zig", &packages::ZIG) {
        Ok(python) => (python, Link::Zig),
        Err(error) => {
            eprintln!("{NOT_CHECKED}wheel for other systems than this one: {error:#}");
            (python, Link::System)
        }
    };
    let (wheel, python) = build(workspace, python, link)?;
    let python = with_spark(workspace, python);
    test(workspace, &python)?;
    let bench = workspace.root.join(CRATE).join("benches/points.py");
    let command = python.run(&workspace.shell).quiet().arg(bench);
    eprintln!("$ {command}");
    command.run()?;
    println!("{}", wheel.display());
    Ok(ExitCode::SUCCESS)
}

/// Builds the wheel for this machine and tests it.
///
/// # Errors
/// An error if a build or a test fails.
pub(crate) fn check(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<()> {
    let python = python(workspace, toolbox)?;
    let (_, python) = build(workspace, python, Link::System)?;
    eprintln!("{NOT_CHECKED}points in Spark: cargo xtask python");
    test(workspace, &python)
}

/// Returns an interpreter with the packages of the tests.
fn python(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<Python> {
    Python::with(workspace, toolbox, exchange::READERS, &exchange::PACKAGES)
        .and_then(|python| python.and(workspace, "wheel", &packages::TESTS))
        .context("the wheel for Python cannot be built and tested")
}

/// Adds Spark where there is Java, or says why it is not tested.
fn with_spark(workspace: &Workspace, python: Python) -> Python {
    let java = succeed(cmd!(workspace.shell, "java -version")).context("no Java");
    let spark = java.and_then(|_| python.clone().and(workspace, "spark", &packages::SPARK));
    spark.unwrap_or_else(|error| {
        eprintln!("{NOT_CHECKED}points in Spark: {error:#}");
        python
    })
}

/// Builds the wheel, and returns it with the interpreter that has it.
fn build(workspace: &Workspace, python: Python, link: Link) -> Result<(PathBuf, Python)> {
    let out = workspace.target_dir.join("python");
    let _lock = Workspace::lock(&out, "builds the wheel for Python")?;
    let wheel = build::wheel(workspace, &python, link, &out.join("wheels"))?;
    let size = fs::metadata(&wheel)
        .with_context(|| wheel.display().to_string())?
        .len();
    eprintln!("{}: {size} bytes", wheel.display());
    ensure!(
        size <= LARGEST_WHEEL,
        "the wheel is larger than {LARGEST_WHEEL} bytes"
    );
    let site = out.join("site");
    if site.exists() {
        fs::remove_dir_all(&site).with_context(|| site.display().to_string())?;
    }
    let unpack = python.run(&workspace.shell).args(["-m", "zipfile", "-e"]);
    unpack.arg(&wheel).arg(&site).quiet().run()?;
    Ok((wheel, python.with_modules(site)))
}

/// Runs the tests.
fn test(workspace: &Workspace, python: &Python) -> Result<()> {
    let host_sim = verify::tested_host_sim(workspace)?;
    let tests: &Path = &workspace.root.join(CRATE);
    let command = python
        .run(&workspace.shell)
        .quiet()
        .env("HOST_SIM", host_sim)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir"])
        .arg(tests)
        .arg(tests);
    eprintln!("$ {command}");
    command.run().map_err(Into::into)
}
