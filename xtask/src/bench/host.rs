//! Times on this PC: the kernel per point, beside copying the same bytes, another crate, and
//! `OpenCV`.

use std::env::consts::EXE_SUFFIX;

use anyhow::{Context as _, Result};
use serde::Deserialize;
use xshell::cmd;

use super::comparison::{Row, rounded};
use crate::workspace::Workspace;

/// Numbers of points per call.
const SIZES: [&str; 5] = ["1000", "10000", "100000", "1000000", "10000000"];

/// Line of the timing programs' output.
#[derive(Debug, Deserialize)]
struct Timed {
    core: String,
    kernel: String,
    points: u32,
    ns_per_point: f64,
    of_memcpy: Option<f64>,
    clock_ghz: Option<f64>,
}

/// Times all contenders in one run, in turns; `OpenCV` only if `python3` has it.
///
/// # Errors
/// An error if the build or a program fails.
pub(super) fn times(workspace: &Workspace) -> Result<Vec<Row>> {
    let _root = workspace.shell.push_dir(&workspace.root);
    let build = workspace.cargo("build --release -p host-benches --locked");
    eprintln!("$ {build}");
    build.run()?;
    let program = workspace
        .target_dir
        .join(format!("release/host-benches{EXE_SUFFIX}"));
    let compiler = cmd!(workspace.shell, "rustc --version").quiet().read()?;
    let compiler: Vec<_> = compiler.split_whitespace().take(2).collect();
    eprintln!("$ host-benches {}", SIZES.join(" "));
    let timed = cmd!(workspace.shell, "{program} {SIZES...}")
        .quiet()
        .read()?;
    let rows = of_csv(&timed, &compiler.join(" "))?;
    let mut other = rows.iter().map(|row| &row.kernel);
    if !other.any(|kernel| kernel.starts_with("OpenCV")) {
        eprintln!(
            "note: OpenCV is not timed: python3 has none (pip install opencv-python-headless)"
        );
    }
    Ok(rows)
}

fn of_csv(text: &str, compiler: &str) -> Result<Vec<Row>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows = reader.deserialize().map(|line| {
        let line: Timed = line?;
        Ok(Row {
            core: line.core,
            kernel: line.kernel,
            instructions: None,
            unit: "point".to_owned(),
            compiler: compiler.to_owned(),
            points: Some(line.points),
            cycles: line.clock_ghz.map(|ghz| rounded(ghz * line.ns_per_point)),
            cycles_by: line
                .clock_ghz
                .map(|ghz| format!("clock {ghz} GHz"))
                .unwrap_or_default(),
            ns: Some(line.ns_per_point),
            of_memcpy: line.of_memcpy,
            of_ours: None,
        })
    });
    rows.collect::<csv::Result<_>>()
        .context("rows of a timing program")
}
