//! Places where arithmetic can overflow as far as the compiler can tell: each is in a list, with
//! the bound that keeps its values from it.
//!
//! The images that fly wrap. Here they are built with checks of every operation, in a directory of
//! their own: what the compiler can bound itself has no check left, and the rest is compared with
//! the list in both directions.

mod list;
mod place;

use std::{collections::BTreeSet, fs, path::Path};

use anyhow::{Context as _, Result, bail, ensure};
use xshell::Cmd;

use self::{
    list::{Extent, Found, LIST, MADE_WITH, Row},
    place::Place,
};
use crate::{
    NOT_CHECKED,
    firmware::{self, Image},
    no_panic::PANIC_SYMBOL,
    source::Sources,
    target::Target,
    workspace::Workspace,
};

/// File of the negative control, whose sum no row has.
const CONTROL: &str = "tests/no-panic/src/negative_control.rs";

/// Builds what is checked, and compares its places with the list.
///
/// # Errors
/// An error if a build fails, if a place is not in the list as it is, or if the negative control is
/// not found.
pub(crate) fn check(workspace: &Workspace, target: &Target<'_>) -> Result<()> {
    let target = &target.checking_overflow();
    let mut found = Found::default();
    let mut sources = Sources::new(&workspace.root);
    let mut add = |name: &str, places: BTreeSet<Place>| {
        eprintln!("{name}: {} places", places.len());
        for place in places {
            found.add(place, &mut sources);
        }
    };
    for image in [Image::Mps2, Image::NucleoH743zi] {
        let program = firmware::link_in_whole_flash(target, image)?;
        add(&image.to_string(), read(&program)?);
    }
    add("the library's functions and the control", library(target)?);
    let control = found.take(CONTROL);
    let extent = extent(target)?;
    let rows = list::read(&workspace.root)?;
    check_control(&control, &rows, extent)?;
    let faults = found.faults(&rows, extent);
    if !faults.is_empty() {
        bail!("arithmetic that can overflow:\n{}", faults.join("\n"));
    }
    eprintln!("{found}, all with a bound in {LIST}");
    Ok(())
}

/// Shows that a sum without a bound is found.
fn check_control(control: &Found, rows: &[Row], extent: Extent) -> Result<()> {
    let faults = control.faults(rows, extent);
    let is_it = |fault: &&String| fault.starts_with(CONTROL) && fault.contains("not in");
    let fault = faults.iter().find(is_it);
    let fault = fault.with_context(|| format!("{CONTROL} can overflow: the check sees nothing"))?;
    eprintln!("{fault}\nexpected: it is the negative control");
    Ok(())
}

/// Returns what of the list the builds are compared with, and says what is left out.
fn extent(target: &Target<'_>) -> Result<Extent> {
    let compiler = target.compiler()?;
    let extent = Extent {
        is_exact: compiler == MADE_WITH,
        has_core: target.builds_core(),
    };
    if !extent.is_exact {
        eprintln!(
            "note: {LIST} was made with {MADE_WITH}; with {compiler} functions without a row are \
            faults, other numbers of places are not"
        );
    }
    if !extent.has_core {
        eprintln!("{NOT_CHECKED}overflow in the core library, which came compiled");
    }
    Ok(extent)
}

/// Builds the program that keeps the library's public functions, with arguments that nothing
/// bounds, and the negative control.
fn library(target: &Target<'_>) -> Result<BTreeSet<Place>> {
    let link: Cmd<'_> = target
        .cargo("rustc --release -p no-panic-check --features fmc-camera/board-mps2 --")
        .arg(format!("-Clink-arg=--defsym={PANIC_SYMBOL}=0"))
        .args(["--cfg", "negative_control"]);
    eprintln!("$ {link}");
    link.run()?;
    read(&target.programs().join("no-panic-check"))
}

fn read(program: &Path) -> Result<BTreeSet<Place>> {
    let told = || program.display().to_string();
    let elf = fs::read(program).with_context(told)?;
    let places = place::places(&elf).with_context(told)?;
    ensure!(
        !places.is_empty(),
        "{} has no check: the check is blind",
        told()
    );
    Ok(places)
}
