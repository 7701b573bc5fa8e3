//! The image for the board, flown on a model of its chip: `tests/board`, with Unicorn and a reader
//! of ELF files from the Python package index.
//!
//! Unicorn is under the GPL: a tool of this test, which nothing that is shipped contains.

use anyhow::Result;

use crate::{
    NOT_CHECKED,
    firmware::{self, Image},
    python::Python,
    target::Target,
    tools::Toolbox,
    verify,
    workspace::Workspace,
};

/// Script that runs the tests.
const SCRIPT: &str = "tests/board/run.py";

/// Packages with their versions, so that a new one cannot change what is tested.
const PACKAGES: [&str; 2] = ["pyelftools==0.32", "unicorn==2.1.4"];

/// Tests that leave out instructions.
pub(crate) const SKIPS: [&str; 2] = ["test_skips_shutter", "test_skips_signature"];

/// Builds image and `host-sim`, and runs these tests of the model, or all but the skips; without
/// Python or its packages they are left out, and named.
///
/// # Errors
/// An error if a build or a test fails.
pub(crate) fn check(
    workspace: &Workspace,
    target: &Target<'_>,
    toolbox: &Toolbox<'_>,
    tests: &[&str],
) -> Result<()> {
    let left_out = |why: &str| {
        eprintln!("{NOT_CHECKED}the image for the board in flight on a model of its chip: {why}");
        Ok(())
    };
    if !cfg!(unix) {
        return left_out("this system has no pseudo-terminals");
    }
    let python = match Python::with(workspace, toolbox, "model", &PACKAGES) {
        Ok(python) => python,
        Err(error) => {
            let text = format!("{error:#}");
            return left_out(&text.split_whitespace().collect::<Vec<_>>().join(" "));
        }
    };
    let image = firmware::build(workspace, target, Image::NucleoH743zi)?;
    let host_sim = verify::tested_host_sim(workspace)?;
    let command = python
        .run(&workspace.shell)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .quiet()
        .arg(workspace.root.join(SCRIPT))
        .arg(image)
        .arg(host_sim)
        .args(tests);
    eprintln!("$ {command}");
    command.run().map_err(Into::into)
}
