//! The firmware's image, found or built.

use std::env;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::open::OpenError;

/// Environment variable that names the image where `--firmware` does not.
pub const VARIABLE: &str = "FMC_FIRMWARE";

/// Advice on getting an image.
const HELP: &str = "build it in the workspace with `cargo xtask firmware`, or name one with \
                    --firmware FILE or the variable FMC_FIRMWARE";

/// An image of the firmware for QEMU's boards.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Path of the file.
    pub path: PathBuf,
    /// Content of the file, symbols included.
    pub elf: Vec<u8>,
}

impl Image {
    /// Finds the image that the user named, else that beside this program, else builds one.
    ///
    /// # Errors
    /// [`OpenError::Image`] for a file that is not firmware; [`OpenError::NotHere`] where there is
    /// none and none can be built.
    pub fn find(named: Option<&Path>) -> Result<Self, OpenError> {
        let variable = env::var_os(VARIABLE).filter(|value| !value.is_empty());
        if let Some(path) = named.map(Path::to_owned).or(variable.map(PathBuf::from)) {
            return Self::read(&path);
        }
        let target_dir = target_dir();
        let place = |dir: &Path| dir.join("firmware").join("mps2");
        if let Some(path) = target_dir
            .as_deref()
            .map(place)
            .filter(|path| path.is_file())
        {
            return Self::read(&path);
        }
        let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let not_here = |reason: &str| OpenError::NotHere {
            reason: reason.to_owned(),
            help: HELP.to_owned(),
        };
        if !workspace.join("Cargo.toml").is_file() {
            return Err(not_here("there is no image of the firmware"));
        }
        build(&workspace, target_dir.as_deref()).map_err(|error| {
            not_here(&format!(
                "there is no image of the firmware and it cannot be built: {error}"
            ))
        })?;
        let built = target_dir
            .into_iter()
            .chain([workspace.join("target")])
            .map(|dir| place(&dir))
            .find(|path| path.is_file())
            .ok_or_else(|| {
                not_here("the firmware was built, but its image is not where it should be")
            })?;
        Self::read(&built)
    }

    fn read(path: &Path) -> Result<Self, OpenError> {
        let wrong = |what: String| OpenError::Image {
            path: path.to_owned(),
            what,
        };
        let elf = fs::read(path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
        if !is_elf_for_arm(&elf) {
            return Err(wrong(
                "is not a firmware: it is not an ELF file for 32-bit ARM".to_owned(),
            ));
        }
        Ok(Self {
            path: path.to_owned(),
            elf,
        })
    }
}

/// Tests magic number, class (32 bits), byte order (little) and machine (40, ARM) of the ELF
/// header.
fn is_elf_for_arm(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x7fELF\x01\x01") && bytes.get(18..20) == Some(&[40, 0])
}

/// Returns Cargo's target directory if this program is in it: `<target>/release/host-sim`.
pub(super) fn target_dir() -> Option<PathBuf> {
    let program = env::current_exe().ok()?;
    let dir = program.parent()?.parent()?;
    // Cargo marks its target directories with this file.
    dir.join("CACHEDIR.TAG").is_file().then(|| dir.to_owned())
}

/// Builds the firmware, with its progress on the error stream.
fn build(workspace: &Path, target_dir: Option<&Path>) -> io::Result<()> {
    let _ = writeln!(io::stderr(), "building the firmware: cargo xtask firmware");
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .args(["xtask", "firmware"])
        .current_dir(workspace)
        .stdin(Stdio::null())
        // Standard output is reserved for this program's answer.
        .stdout(Stdio::null());
    if let Some(dir) = target_dir {
        command.env("CARGO_TARGET_DIR", dir);
    }
    let status = command
        .status()
        .map_err(|error| io::Error::other(format!("cargo: {error}")))?;
    if status.success() {
        Ok(())
    } else {
        Err(io::Error::other(format!(
            "cargo xtask firmware ended with {status}"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_of_other_machines_are_no_firmware() {
        let mut header = [0_u8; 52];
        header[..6].copy_from_slice(b"\x7fELF\x01\x01");
        header[18] = 40;
        assert!(is_elf_for_arm(&header));
        for (index, byte) in [(0, b'M'), (4, 2), (18, 62)] {
            let mut other = header;
            other[index] = byte;
            assert!(!is_elf_for_arm(&other), "{index}");
        }
        assert!(!is_elf_for_arm(b"\x7fELF\x01\x01"));
        assert!(!is_elf_for_arm(b""));
    }
}
