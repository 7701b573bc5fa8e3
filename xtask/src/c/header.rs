//! The header by itself: clean in C99, C11 and C++11, and under cppcheck's rules of MISRA C.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, ensure};
use xshell::cmd;

use super::{
    compiler::{Compiler, host_compiler, host_compiler_of_cpp, option},
    library::directory,
};
use crate::{
    NOT_CHECKED,
    machine::on_path,
    tools::{Tool, Toolbox},
    workspace::Workspace,
};

/// Name of the header.
const HEADER: &str = "fmc_camera.h";

/// Rules of MISRA C:2012 from which the header deviates; `docs/c.md` says why of each.
const DEVIATIONS: [&str; 1] = ["2.5"];

/// Checks the header with every compiler there is, and with cppcheck.
///
/// # Errors
/// An error if there is a warning, or a rule is broken that is not listed.
pub(super) fn check(
    workspace: &Workspace,
    gcc: &Compiler<'_>,
    toolbox: &Toolbox<'_>,
    out: &Path,
) -> Result<()> {
    let host = host_compiler(workspace);
    for compiler in [Some(gcc), host.as_ref()].into_iter().flatten() {
        for standard in ["-std=c99", "-std=c11"] {
            let compile = compiler
                .command()
                .args([standard, "-Wall", "-Wextra", "-pedantic", "-Werror"])
                .args(["-ffreestanding", "-fsyntax-only", "-x", "c"])
                .arg(directory(workspace, "include").join(HEADER));
            compile.run()?;
        }
    }
    match host_compiler_of_cpp(workspace) {
        Some(compiler) => compiler
            .command()
            .args(["-std=c++11", "-Wall", "-Wextra", "-pedantic", "-Werror"])
            .args(["-fsyntax-only", "-x", "c++"])
            .arg(directory(workspace, "include").join(HEADER))
            .run()?,
        None => eprintln!("{NOT_CHECKED}the header in C++11: no C++ compiler on the search path"),
    }
    misra(workspace, toolbox, out)
}

fn misra(workspace: &Workspace, toolbox: &Toolbox<'_>, out: &Path) -> Result<()> {
    let (cppcheck, addon) = match cppcheck(toolbox)? {
        Ok(found) => found,
        Err(lack) => {
            eprintln!("{NOT_CHECKED}the header by MISRA C: {lack}");
            return Ok(());
        }
    };
    if on_path("python3").is_none() {
        eprintln!("{NOT_CHECKED}the header by MISRA C: no python3 on the search path");
        return Ok(());
    }
    let unit = out.join("misra.c");
    fs::write(&unit, format!("#include \"{HEADER}\"\n")).context("misra.c")?;
    let shell = &workspace.shell;
    let check = cmd!(shell, "{cppcheck} --std=c99 --quiet --inline-suppr")
        .arg(format!("--addon={addon}"))
        .arg(option("I", &directory(workspace, "include")))
        .args(["--suppress=missingIncludeSystem", "--template={id}:{line}"])
        .arg(&unit)
        .quiet()
        .ignore_status();
    let output = check.output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    let mut rules: BTreeMap<&str, usize> = BTreeMap::new();
    for line in text.lines() {
        let rule = line.split_once("misra-c2012-").and_then(|(_, rule)| {
            let (rule, _) = rule.split_once(':')?;
            Some(rule)
        });
        let rule = rule.with_context(|| format!("cppcheck says \"{line}\""))?;
        *rules.entry(rule).or_default() += 1;
    }
    for (rule, count) in &rules {
        ensure!(
            DEVIATIONS.contains(rule),
            "the header breaks rule {rule} of MISRA C in {count} places:\n{text}"
        );
    }
    ensure!(
        DEVIATIONS.iter().all(|rule| rules.contains_key(rule)),
        "cppcheck finds other deviations from MISRA C than listed: {rules:?}"
    );
    eprintln!("header by MISRA C: deviations from rules {rules:?} alone");
    Ok(())
}

/// Returns cppcheck and its rules of MISRA C, or what is missing.
fn cppcheck(toolbox: &Toolbox<'_>) -> Result<Result<(PathBuf, String), String>> {
    if let Some(program) = on_path("cppcheck") {
        return Ok(Ok((program, "misra".to_owned())));
    }
    let tool = match toolbox.provide(Tool::Cppcheck) {
        Ok(tool) => tool,
        Err(missing) => return Ok(Err(missing.to_string())),
    };
    let programs = tool.root().join("usr/bin");
    let Some(files) = files(&tool.root().join("usr")) else {
        return Ok(Err("its package has no std.cfg".to_owned()));
    };
    // It looks for them beside itself.
    for name in ["cfg", "addons", "platforms"] {
        let link = programs.join(name);
        if !link.exists() {
            link_to(&files.join(name), &link).with_context(|| link.display().to_string())?;
        }
    }
    let addon = files.join("addons/misra.py").display().to_string();
    Ok(Ok((tool.program("cppcheck"), addon)))
}

/// Returns the directory of cppcheck's files below that of a system.
fn files(usr: &Path) -> Option<PathBuf> {
    let libraries = fs::read_dir(usr.join("lib"))
        .into_iter()
        .flatten()
        .flatten();
    let places = libraries.map(|entry| entry.path().join("cppcheck"));
    let mut places = places.chain([usr.join("share/cppcheck")]);
    places.find(|place| place.join("cfg/std.cfg").is_file())
}

#[cfg(unix)]
fn link_to(original: &Path, link: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(original, link)
}

/// Fails: this system fetches no packages of Debian's kind.
#[cfg(not(unix))]
fn link_to(_: &Path, _: &Path) -> std::io::Result<()> {
    Err(std::io::ErrorKind::Unsupported.into())
}
