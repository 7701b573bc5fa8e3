//! `cargo xtask coverage`: lines and branches of the camera logic and of the link that the
//! library's own tests reach.
//!
//! A branch is one outcome of one condition: of `a && b` both are looked at. What is not reached is
//! compared, function by function, with a list that has the reasons.

mod list;

use std::{env::consts::EXE_SUFFIX, fs, path::PathBuf, process::ExitCode};

use anyhow::{Context as _, Result, ensure};
use lcov::Report;

use self::list::{Found, LIST};
use crate::{
    CHECK_FAILED,
    checks::FEATURES_OF_TESTS,
    crate_program::CrateProgram,
    machine::on_path,
    source,
    tools::{Tool, Toolbox},
    workspace::Workspace,
};

const CARGO_LLVM_COV: CrateProgram = CrateProgram {
    name: "cargo-llvm-cov",
    version: "0.9.1",
    before_version: "cargo-llvm-cov ",
    options: "",
};

/// Version of LLVM whose programs are fetched; a compiler of another one needs others.
const LLVM: &str = "22";

/// Folders that are measured.
const MEASURED: [&str; 2] = ["src/flight/", "src/io/"];

/// Runs the library's tests and compares what they do not reach with the list.
///
/// # Errors
/// An error if tools are missing, if a test fails, or if the list cannot be read.
pub(crate) fn run(workspace: &Workspace) -> Result<ExitCode> {
    let [cov, profdata] = programs(workspace)?;
    let program = CARGO_LLVM_COV.find(workspace)?;
    let target_dir = workspace.target_dir.join("coverage");
    fs::create_dir_all(&target_dir).with_context(|| target_dir.display().to_string())?;
    let report = target_dir.join("lcov.info");
    let _directory = workspace.shell.push_dir(&workspace.root);
    let measure = workspace
        .shell
        .cmd(program)
        .args([
            "llvm-cov",
            "--branch",
            "--locked",
            "--package",
            "fmc-camera",
        ])
        .args(["--features", FEATURES_OF_TESTS])
        .args(["--lib", "--test", "library", "--lcov", "--output-path"])
        .arg(&report)
        .env("CARGO_LLVM_COV_TARGET_DIR", &target_dir)
        .env("LLVM_COV", cov)
        .env("LLVM_PROFDATA", profdata)
        // Outcomes of conditions are not measured by a compiler of the stable channel otherwise.
        .env("RUSTC_BOOTSTRAP", "1");
    measure.run()?;
    let measured = Report::from_file(&report).with_context(|| report.display().to_string())?;
    let mut sources = vec![];
    for (key, file) in &measured.sections {
        let path = key.source_file.strip_prefix(&workspace.root);
        let name = path.unwrap_or(&key.source_file).display().to_string();
        let name = name.replace('\\', "/");
        if MEASURED.iter().any(|folder| name.starts_with(folder)) {
            sources.push((name, file));
        }
    }
    let names: Vec<_> = sources.iter().map(|(name, _)| name.clone()).collect();
    let of_tests = source::modules_of_tests(&workspace.root, &names)?;
    let mut found = Found::default();
    for (name, file) in sources {
        if !source::is_of_tests(&of_tests, &name) {
            let code = fs::read_to_string(workspace.root.join(&name));
            let code = code.with_context(|| name.clone())?;
            found.add(&name, code.lines().map(str::to_owned).collect(), file);
        }
    }
    ensure!(
        found.lines[1] > 0 && found.branches[1] > 0,
        "nothing of {} is reached: the measurement is blind",
        MEASURED.join(" and ")
    );
    let faults = found.faults(&list::read(&workspace.root)?);
    let [[lines, reached], [branches, taken]] = [found.lines, found.branches];
    println!("{reached} of {lines} lines and {taken} of {branches} branches are reached");
    if faults.is_empty() {
        println!("the others are in {LIST}");
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!(
        "xtask: {LIST} is not what was found:\n{}",
        faults.join("\n")
    );
    Ok(ExitCode::from(CHECK_FAILED))
}

/// Returns the paths of llvm-cov and llvm-profdata of the compiler's version: its own, those of the
/// search path, or Debian's.
fn programs(workspace: &Workspace) -> Result<[PathBuf; 2]> {
    let names = ["llvm-cov", "llvm-profdata"];
    let rustc = |argument: &str| {
        workspace
            .shell
            .cmd("rustc")
            .args(argument.split(' '))
            .quiet()
            .read()
    };
    let libraries = PathBuf::from(rustc("--print target-libdir")?);
    let own = names.map(|name| {
        libraries
            .with_file_name("bin")
            .join(format!("{name}{EXE_SUFFIX}"))
    });
    if own.iter().all(|program| program.is_file()) {
        return Ok(own);
    }
    let version = rustc("-vV")?;
    let major = version
        .lines()
        .find_map(|line| line.strip_prefix("LLVM version: ")?.split('.').next())
        .context("rustc -vV does not name its LLVM")?;
    let named = names.map(|name| format!("{name}-{major}"));
    if let [Some(cov), Some(profdata)] = named.each_ref().map(|name| on_path(name)) {
        return Ok([cov, profdata]);
    }
    ensure!(
        major == LLVM,
        "rustc was built with LLVM {major}, whose llvm-cov is neither beside it (rustup component \
        add llvm-tools) nor on the search path as llvm-cov-{major}; Debian's of LLVM {LLVM} can be \
        fetched"
    );
    let tool = Toolbox::new(workspace).provide(Tool::Coverage)?;
    Ok(named.map(|name| tool.program(&name)))
}
