//! The library for C as WebAssembly, linked with what the page calls and nothing else.

use std::{
    env::consts::EXE_SUFFIX,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};

use crate::{
    machine::{file_names, on_path},
    other_target::{OtherTarget, active_sysroot},
    tools::Toolbox,
    workspace::Workspace,
};

/// Compiler's name of the target.
const TARGET: &str = "wasm32-unknown-unknown";

/// Name of the archive that cargo makes.
const ARCHIVE: &str = "libfmc_camera_web.a";

/// Arguments of cargo.
const BUILD: &str = "rustc --package fmc-camera-web --lib --crate-type staticlib";

/// Settings of the profile. With `z` there remain checks of bounds that cannot fail, and the link
/// takes them for panics.
const PROFILE: [&str; 4] = [
    "profile.release.opt-level=\"s\"",
    "profile.release.lto=\"fat\"",
    "profile.release.codegen-units=1",
    "profile.release.debug=false",
];

/// Functions that the page calls, and the end of the module's own memory.
const EXPORTS: [&str; 12] = [
    "__heap_base",
    "fmc_camera_id",
    "fmc_camera_init",
    "fmc_camera_record_defaults",
    "fmc_camera_version",
    "fmc_correct",
    "fmc_error_text",
    "fmc_exposure_defaults",
    "fmc_frame_init",
    "fmc_frame_interior",
    "fmc_web_added",
    "fmc_web_budget",
];

/// A module that has been built.
#[derive(Debug)]
pub(super) struct Module {
    /// The module.
    pub(super) bytes: Vec<u8>,
    /// Name and number of its compiler.
    pub(super) compiler: String,
}

/// Builds the module. It has no import: the link fails where a panic can be reached, as that of a
/// program in C does.
///
/// # Errors
/// An error if it does not compile or link, or if there is no compiler or linker and none can be
/// fetched.
pub(super) fn build(workspace: &Workspace, toolbox: &Toolbox<'_>, out: &Path) -> Result<Module> {
    let target = OtherTarget::find(workspace, toolbox, TARGET, "core")?;
    let linker = linker(workspace)?;
    workspace.tell(&format!(
        "{}, linker {}",
        target.description(),
        linker.display()
    ));
    let artifacts = workspace.target_dir.join("wasm");
    let build = target.cargo(workspace, BUILD).arg("--target-dir");
    let build = build.arg(&artifacts);
    let build = PROFILE
        .iter()
        .fold(build, |build, setting| build.args(["--config", setting]));
    eprintln!("$ {build}");
    build.run()?;
    let path = out.join("fmc_camera.wasm");
    let link = workspace.shell.cmd(&linker).quiet();
    let is_rust_lld = linker
        .file_stem()
        .is_some_and(|name| name.to_string_lossy().starts_with("rust-lld"));
    let link = if is_rust_lld {
        link.args(["-flavor", "wasm"])
    } else {
        link
    };
    let link = link
        .args(["--no-entry", "--gc-sections", "--strip-all", "-O2"])
        .args(["--stack-first", "-z", "stack-size=65536"])
        .args(EXPORTS.map(|name| format!("--export={name}")))
        .arg(artifacts.join(TARGET).join("release").join(ARCHIVE))
        .arg("-o")
        .arg(&path);
    eprintln!("$ {link}");
    link.run()?;
    let version = target.compiler(workspace)?;
    let compiler: Vec<_> = version.split_whitespace().take(2).collect();
    Ok(Module {
        bytes: fs::read(&path).with_context(|| path.display().to_string())?,
        compiler: compiler.join(" "),
    })
}

/// Finds LLVM's linker for WebAssembly: the one that comes with the active toolchain, or one on the
/// search path.
fn linker(workspace: &Workspace) -> Result<PathBuf> {
    let hosts = active_sysroot(workspace)?.join("lib/rustlib");
    let rust_lld = |host: &String| {
        let bin = hosts.join(host).join("bin");
        bin.join(format!("rust-lld{EXE_SUFFIX}"))
    };
    let with_compiler = file_names(&hosts);
    with_compiler
        .iter()
        .map(rust_lld)
        .find(|path| path.is_file())
        .or_else(|| on_path("wasm-ld"))
        .context("no linker for WebAssembly: neither rust-lld of the active toolchain nor wasm-ld on the search path; to mend it: install LLVM's lld")
}
