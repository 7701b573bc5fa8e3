//! `cargo xtask web`: the page that computes with the camera's own code, and its checks in a
//! browser.

mod browser;
mod drive;
mod module;
mod page;

use std::{fs, process::ExitCode};

use anyhow::{Context as _, Result};

use crate::{NOT_CHECKED, NOT_STARTED, tools::Toolbox, workspace::Workspace};

/// Builds the page into target/web and checks it; with `update` it becomes the one in docs.
///
/// # Errors
/// An error if it cannot be built, or if a check fails.
pub(crate) fn run(workspace: &Workspace, update: bool) -> Result<ExitCode> {
    let toolbox = Toolbox::new(workspace);
    let _root = workspace.shell.push_dir(&workspace.root);
    let built = match build(workspace, &toolbox) {
        Ok(built) => built,
        Err(error) => {
            eprintln!("xtask: the page was not built: {error:#}");
            return Ok(ExitCode::from(NOT_STARTED));
        }
    };
    if update {
        let path = workspace.root.join(page::CHECKED_IN);
        fs::write(&path, &built).with_context(|| path.display().to_string())?;
    }
    checked(workspace, &toolbox, &built)?;
    println!("{}", workspace.target_dir.join("web/index.html").display());
    Ok(ExitCode::SUCCESS)
}

/// Builds the page and checks it.
///
/// # Errors
/// An error if it cannot be built, or if a check fails.
pub(crate) fn check(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<()> {
    let built = build(workspace, toolbox)?;
    checked(workspace, toolbox, &built)
}

/// Returns the page, and writes it into target/web.
fn build(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<String> {
    let out = workspace.target_dir.join("web");
    let _lock = Workspace::lock(&out, "builds the page")?;
    let module = module::build(workspace, toolbox, &out)?;
    let page = page::page(&workspace.root, &module)?;
    let path = out.join("index.html");
    fs::write(&path, &page).with_context(|| path.display().to_string())?;
    eprintln!(
        "{} bytes of page, with {} bytes of {} without a reachable panic",
        page.len(),
        module.bytes.len(),
        module.compiler
    );
    Ok(page)
}

fn checked(workspace: &Workspace, toolbox: &Toolbox<'_>, built: &str) -> Result<()> {
    eprintln!("{}", page::compare(&workspace.root, built)?);
    match browser::find(toolbox) {
        Ok(program) => drive::check(workspace, &program),
        Err(lack) => {
            eprintln!("{NOT_CHECKED}the page in a browser: {lack:#}");
            Ok(())
        }
    }
}
