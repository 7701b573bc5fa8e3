//! Firmware: its lints, the proof that it cannot panic, its images for QEMU, and their tests.

use std::{fmt, fs, path::PathBuf, process::ExitCode};

use anyhow::{Context as _, Result};
use xshell::Cmd;

use crate::{
    checks::TESTED,
    emulator::Emulator,
    no_panic, stack,
    target::{Lints, Target},
    tools::Toolbox,
    workspace::Workspace,
};

/// Function of the drills that overflows the stack.
const OVERFLOW: &str = "firmware::board::mps2::drills::overflow";

/// Image of the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Image {
    /// For QEMU's mps2-an386 and mps2-an500.
    Mps2,
    /// The image for QEMU with accidents on request.
    Mps2WithDrills,
    /// For ST's NUCLEO-H743ZI2.
    NucleoH743zi,
}

impl Image {
    /// Returns the feature of the library and the firmware.
    fn board(self) -> &'static str {
        match self {
            Self::Mps2 | Self::Mps2WithDrills => "board-mps2",
            Self::NucleoH743zi => "board-nucleo-h743zi",
        }
    }

    /// Returns the flags of the compiler for the firmware alone; the library is compiled without
    /// them.
    fn flags(self) -> &'static [&'static str] {
        match self {
            Self::Mps2 | Self::NucleoH743zi => &[],
            Self::Mps2WithDrills => &["--cfg", "drills"],
        }
    }

    /// Returns the path where the image is kept.
    fn path(self, workspace: &Workspace) -> PathBuf {
        directory(workspace).join(self.to_string())
    }
}

impl fmt::Display for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mps2 => "mps2",
            Self::Mps2WithDrills => "mps2-drills",
            Self::NucleoH743zi => "nucleo-h743zi",
        })
    }
}

/// Returns the directory where the images are kept.
fn directory(workspace: &Workspace) -> PathBuf {
    workspace.target_dir.join("firmware")
}

/// Builds the image for QEMU and prints its path.
///
/// # Errors
/// An error if the set-up or the build fails.
pub(crate) fn run(workspace: &Workspace) -> Result<ExitCode> {
    let target = Target::set_up(workspace, &Toolbox::new(workspace), Lints::NotWanted)?;
    let image = build(workspace, &target, Image::Mps2)?;
    println!("{}", image.display());
    Ok(ExitCode::SUCCESS)
}

/// Sets up target and QEMU, and builds the image that `host-sim` runs in it.
///
/// # Errors
/// An error if the set-up or the build fails.
pub(crate) fn set_up(workspace: &Workspace) -> Result<Emulator> {
    let toolbox = Toolbox::new(workspace);
    // The emulator comes first: it takes seconds, and without it the rest is of no use.
    let emulator = Emulator::set_up(workspace, &toolbox)?;
    let target = Target::set_up(workspace, &toolbox, Lints::NotWanted)?;
    build(workspace, &target, Image::Mps2)?;
    Ok(emulator)
}

/// Builds an image and copies it to where `host-sim` looks, because the next build replaces it.
///
/// # Errors
/// An error if the build fails.
pub(crate) fn build(workspace: &Workspace, target: &Target<'_>, image: Image) -> Result<PathBuf> {
    let _root = workspace.shell.push_dir(&workspace.root);
    // Another xtask may build another image in the same place, or its QEMU may load the image that
    // is kept.
    let _lock = Workspace::lock(&directory(workspace), "builds the firmware")?;
    let build = rustc(target, image, &[]);
    eprintln!("$ {build}");
    build.run()?;
    let kept = image.path(workspace);
    let new = kept.with_extension("new");
    let shell = &workspace.shell;
    shell.copy_file(target.programs().join("firmware"), &new)?;
    fs::rename(&new, &kept).with_context(|| kept.display().to_string())?;
    Ok(kept)
}

/// Lints an image.
///
/// # Errors
/// An error if there is a lint.
pub(crate) fn lint(target: &Target<'_>, image: Image) -> Result<()> {
    let clippy = cargo(target, "clippy", image);
    let clippy = clippy.args(["--", "-D", "warnings"]).args(image.flags());
    eprintln!("$ {clippy}");
    clippy.run().map_err(Into::into)
}

/// Links an image with its relocations kept, and returns the path where cargo put it.
///
/// # Errors
/// An error if the build fails.
pub(crate) fn link_with_relocations(target: &Target<'_>, image: Image) -> Result<PathBuf> {
    let link = rustc(target, image, &["-Clink-arg=--emit-relocs"]);
    eprintln!("$ {link}");
    link.run()?;
    Ok(target.programs().join("firmware"))
}

/// Links an image as if its board had more flash, and returns the path where cargo put it.
///
/// # Errors
/// An error if the build fails.
pub(crate) fn link_in_whole_flash(target: &Target<'_>, image: Image) -> Result<PathBuf> {
    let link = rustc(target, image, &["-Clink-arg=--defsym=_whole_flash=1"]);
    eprintln!("$ {link}");
    link.run()?;
    Ok(target.programs().join("firmware"))
}

/// Shows that the linker finds no panic in the flight image.
///
/// # Errors
/// An error if it finds one, or does not find that of the negative control.
pub(crate) fn check_no_panic(target: &Target<'_>) -> Result<()> {
    let link = |flags: &[&str]| {
        let flags = [&["--cfg", "link_check"], flags].concat();
        rustc(target, Image::Mps2, &flags)
    };
    no_panic::prove("the firmware", link)
}

/// Builds the images, bounds the stack of the one that flies, and runs the tests of `host-sim` that
/// need them.
///
/// # Errors
/// An error if a build or a test fails, or the stack of an image has no bound.
pub(crate) fn test(workspace: &Workspace, target: &Target<'_>, emulator: &Emulator) -> Result<()> {
    let flight = build(workspace, target, Image::Mps2)?;
    let with_drills = build(workspace, target, Image::Mps2WithDrills)?;
    stack::check(&workspace.root, &flight)?;
    stack::check_recursion(&workspace.root, &with_drills, OVERFLOW)?;
    // All packages are built, because their features together determine those of the dependencies.
    let test = format!("test {TESTED} --locked --test main -- firmware:: --ignored");
    let test = workspace
        .cargo(&test)
        .env("FMC_FIRMWARE", flight)
        .env("FMC_FIRMWARE_WITH_DRILLS", with_drills)
        .env("PATH", emulator.search_path()?);
    eprintln!("$ {test}");
    test.run().map_err(Into::into)
}

/// Returns the command that builds an image, with additional flags of the compiler.
fn rustc<'a>(target: &Target<'a>, image: Image, flags: &[&str]) -> Cmd<'a> {
    let rustc = cargo(target, "rustc", image);
    rustc.arg("--").args(image.flags()).args(flags)
}

/// Returns a cargo command for the firmware, in release as for the library, so that the core
/// library is built once.
fn cargo<'a>(target: &Target<'a>, subcommand: &str, image: Image) -> Cmd<'a> {
    let board = image.board();
    target.cargo(&format!(
        "{subcommand} --release -p fmc-camera --bin firmware --features {board}"
    ))
}
