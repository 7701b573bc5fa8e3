//! `cargo xtask python`: the wheels for Python, tested with the packages that use them.

mod build;
mod packages;

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::{Context as _, Result};
use xshell::cmd;

use self::build::{Link, Wheel};
use crate::{
    NOT_CHECKED,
    equipment::Equipment,
    exchange,
    python::{Python, succeed},
    tools::Toolbox,
    verify,
    workspace::Workspace,
};

/// The camera.
const CAMERA: Wheel = Wheel {
    directory: "bindings/python",
    file: "fmc_camera",
    largest: 1_000_000,
};

/// Files of other programs.
const EXPORT: Wheel = Wheel {
    directory: "bindings/python-export",
    file: "fmc_camera_export",
    largest: 1_000_000,
};

/// Builds the wheels into target/python, tests them with everything that can be had, and takes
/// times.
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
    let (wheels, python) = build(workspace, python, link)?;
    let python = with_spark(workspace, python);
    test(workspace, &python)?;
    let bench = workspace
        .root
        .join(CAMERA.directory)
        .join("benches/points.py");
    let command = python.run(&workspace.shell).quiet().arg(bench);
    eprintln!("$ {command}");
    command.run()?;
    for wheel in wheels {
        println!("{}", wheel.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// Builds the wheels for this machine and tests them.
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

/// Builds the wheels, and returns them with the interpreter that has them.
fn build(workspace: &Workspace, python: Python, link: Link) -> Result<([PathBuf; 2], Python)> {
    let out = workspace.target_dir.join("python");
    let _lock = Workspace::lock(&out, "builds the wheels for Python")?;
    let directory = out.join("wheels");
    let site = out.join("site");
    for old in [&directory, &site] {
        if old.exists() {
            fs::remove_dir_all(old).with_context(|| old.display().to_string())?;
        }
    }
    let camera = CAMERA.build(workspace, &python, link, &directory)?;
    let export = EXPORT.build(workspace, &python, link, &directory)?;
    let wheels = [camera, export];
    for wheel in &wheels {
        let unpack = python.run(&workspace.shell).args(["-m", "zipfile", "-e"]);
        unpack.arg(wheel).arg(&site).quiet().run()?;
    }
    Ok((wheels, python.with_modules(site)))
}

/// Runs the tests.
fn test(workspace: &Workspace, python: &Python) -> Result<()> {
    let host_sim = verify::tested_host_sim(workspace)?;
    let tests: &Path = &workspace.root.join(CAMERA.directory);
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
