//! Tool unpacked from its packages, with the launchers by which its programs find the libraries of
//! the packages.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, bail, ensure};
use xshell::{Shell, cmd};

use super::{Tool, closure};
use crate::{machine::file_names, version::Version};

/// Directory of a tool.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Unpacked {
    pub(super) directory: PathBuf,
    /// Directory of the tool whose libraries it needs as well.
    pub(super) base: Option<PathBuf>,
}

impl Unpacked {
    pub(super) fn new(directory: PathBuf, base: Option<PathBuf>) -> Self {
        Self { directory, base }
    }

    /// Returns the directory of the packages' files.
    pub(crate) fn root(&self) -> PathBuf {
        self.directory.join("root")
    }

    /// Returns the directory of the launchers, for a search path.
    pub(crate) fn bin(&self) -> PathBuf {
        self.directory.join("bin")
    }

    /// Returns the launcher of a program.
    pub(crate) fn program(&self, name: &str) -> PathBuf {
        self.bin().join(name)
    }

    /// Returns the path of the list of its packages, in the form of dpkg's list of installed ones.
    pub(super) fn status(&self) -> PathBuf {
        self.directory.join("status")
    }

    /// Returns the version of the package that determines the tool's.
    fn version(&self, tool: Tool) -> Option<String> {
        let status = fs::read_to_string(self.status()).ok()?;
        closure::version_of(&status, tool.packages().first()?)
    }

    fn release(&self) -> PathBuf {
        self.directory.join("release")
    }

    /// Writes the launchers, and the release to which the packages belong.
    pub(super) fn finish(&self, tool: Tool, release: &str) -> Result<()> {
        let own = library_directories(&self.root(), "");
        let base = self.base.as_deref().map_or_else(Vec::new, |base| {
            let name = base.file_name().unwrap_or_default().to_string_lossy();
            library_directories(&base.join("root"), &format!("../{name}/"))
        });
        let libraries: Vec<_> = own.into_iter().chain(base).collect();
        fs::create_dir_all(self.bin()).with_context(|| self.bin().display().to_string())?;
        for name in tool.programs() {
            let path = self.program(name);
            write_program(
                &path,
                &launcher(tool.programs_directory(), name, &libraries),
            )
            .with_context(|| path.display().to_string())?;
        }
        fs::write(self.release(), release).with_context(|| self.release().display().to_string())
    }

    /// Checks that the tool is of this release, complete, and runs.
    ///
    /// # Errors
    /// A message that says what is wrong.
    pub(super) fn try_out(&self, shell: &Shell, tool: Tool, release: &str) -> Result<()> {
        let of = fs::read_to_string(self.release())
            .with_context(|| self.directory.display().to_string())?;
        ensure!(of == release, "{tool} is of {of}, and this is {release}");
        for file in tool.files() {
            ensure!(
                self.root().join("usr").join(file).is_file(),
                "its packages have no {file}"
            );
        }
        if let (Some(base), Some(rests_on)) = (&self.base, tool.rests_on()) {
            let base = Self::new(base.clone(), None).version(rests_on);
            ensure!(
                base.is_none() || base == self.version(tool),
                "it is of another version than the compiler under target/tools, which is to be removed first"
            );
        }
        for name in tool.programs() {
            let program = self.program(name);
            let answer = cmd!(shell, "{program} --version")
                .quiet()
                .ignore_status()
                .output()?;
            let text = String::from_utf8_lossy(&answer.stdout);
            if !answer.status.success() {
                let fault = String::from_utf8_lossy(&answer.stderr);
                bail!(
                    "{name} does not start: {}",
                    fault.lines().next().unwrap_or("it says nothing")
                );
            }
            let version = Version::find(&text);
            if let Some(oldest) = tool
                .oldest()
                .filter(|_| tool.programs().first() == Some(name))
            {
                ensure!(
                    version.is_some_and(|version| version >= oldest),
                    "{name} is of another version than {oldest} or later: {}",
                    text.lines().next().unwrap_or_default()
                );
            }
        }
        Ok(())
    }
}

/// Returns the directories of shared libraries below a root, relative to a tool's directory:
/// `prefix`, then `root/…`. Behind them stand those that a package keeps for its own libraries,
/// which find them at the system's place alone.
fn library_directories(root: &Path, prefix: &str) -> Vec<String> {
    let sorted = |directory: &str| {
        let mut names = file_names(&root.join(directory));
        names.sort();
        names
    };
    let of_system: Vec<_> = ["usr/lib", "lib"]
        .into_iter()
        .flat_map(|parent| {
            let names = sorted(parent).into_iter();
            names
                .filter(|name| name.contains("-linux-gnu"))
                .map(move |name| format!("{parent}/{name}"))
        })
        .collect();
    let of_packages: Vec<_> = of_system
        .iter()
        .flat_map(|parent| {
            let names = sorted(parent).into_iter();
            names.map(move |name| format!("{parent}/{name}"))
        })
        .filter(|place| {
            let is_library = |name: &String| name.starts_with("lib") && name.contains(".so");
            file_names(&root.join(place)).iter().any(is_library)
        })
        .collect();
    let places = of_system.into_iter().chain(of_packages);
    places
        .map(|place| format!("{prefix}root/{place}"))
        .collect()
}

/// Returns the text of a program that runs another one with these directories of libraries, which
/// are relative to the tool's.
fn launcher(place: &str, name: &str, libraries: &[String]) -> String {
    let libraries: Vec<_> = libraries
        .iter()
        .map(|directory| format!("$here/{directory}"))
        .collect();
    let libraries = libraries.join(":");
    format!(
        "#!/bin/sh
# Runs {name} of the packages in ../root with the libraries that came along.
here=$(cd \"${{0%/*}}/..\" && pwd)
export LD_LIBRARY_PATH=\"{libraries}${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}\"
exec \"$here/root/{place}/{name}\" \"$@\"
"
    )
}

#[cfg(unix)]
fn write_program(path: &Path, text: &str) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    fs::write(path, text)?;
    fs::set_permissions(path, fs::Permissions::from_mode(0o755))
}

/// Writes the text alone: this system fetches no packages of Debian's kind.
#[cfg(not(unix))]
fn write_program(path: &Path, text: &str) -> io::Result<()> {
    fs::write(path, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a tool whose program answers `answer` to everything.
    fn unpacked(directory: &Path, release: &str, answer: &str) -> Unpacked {
        let tool = Unpacked::new(directory.to_owned(), None);
        let programs = tool.root().join("usr/bin");
        fs::create_dir_all(&programs).unwrap();
        let libraries = tool.root().join("usr/lib/x86_64-linux-gnu");
        for part in ["pulseaudio", "plugins"] {
            fs::create_dir_all(libraries.join(part)).unwrap();
        }
        fs::write(libraries.join("pulseaudio/libpulsecommon-16.1.so"), "").unwrap();
        write_program(&programs.join("qemu-system-arm"), answer).unwrap();
        tool.finish(Tool::Qemu, release).unwrap();
        tool
    }

    #[test]
    #[cfg(unix)]
    fn tool_is_tried_before_it_is_used() {
        let shell = Shell::new().unwrap();
        let folder = shell.create_temp_dir().unwrap();
        let good = "#!/bin/sh\necho \"QEMU emulator version 7.2.22 $LD_LIBRARY_PATH\"\n";
        let tool = unpacked(folder.path(), "debian 12", good);
        tool.try_out(&shell, Tool::Qemu, "debian 12").unwrap();
        let program = tool.program("qemu-system-arm");
        let text = cmd!(shell, "{program} --version").quiet().read().unwrap();
        let path = "/root/usr/lib/x86_64-linux-gnu:";
        let own = "/root/usr/lib/x86_64-linux-gnu/pulseaudio";
        assert!(text.contains(path) && text.contains(own), "{text}");

        let refused = |tool: &Unpacked, release| {
            let refused = tool.try_out(&shell, Tool::Qemu, release);
            refused.unwrap_err().to_string()
        };
        let text = refused(&tool, "debian 13");
        assert_eq!(text, "QEMU is of debian 12, and this is debian 13");
        for (answer, why) in [
            (
                "#!/bin/sh\necho 'QEMU emulator version 6.2.0'\n",
                "7.2 or later: QEMU emulator version 6.2.0",
            ),
            (
                "#!/bin/sh\necho libfdt.so is missing >&2\nexit 127\n",
                "does not start: libfdt.so is missing",
            ),
        ] {
            let tool = unpacked(folder.path(), "debian 12", answer);
            let text = refused(&tool, "debian 12");
            assert!(text.contains(why), "{text}");
        }
        let clippy = |version: &str| {
            let clippy = Unpacked::new(folder.path().join("clippy"), Some(tool.directory.clone()));
            let programs = clippy.root().join("usr/bin");
            fs::create_dir_all(&programs).unwrap();
            for name in Tool::Clippy.programs() {
                write_program(&programs.join(name), "#!/bin/sh\necho clippy 0.1.96\n").unwrap();
            }
            clippy.finish(Tool::Clippy, "debian 12").unwrap();
            let status = |package, version| {
                format!("Package: {package}\nVersion: {version}\nStatus: install ok installed\n\n")
            };
            fs::write(tool.status(), status("rustc-web", "1.96.0-1")).unwrap();
            fs::write(clippy.status(), status("rust-web-clippy", version)).unwrap();
            clippy.try_out(&shell, Tool::Clippy, "debian 12")
        };
        clippy("1.96.0-1").unwrap();
        let text = clippy("1.96.0-2").unwrap_err().to_string();
        assert!(text.contains("another version than the compiler"), "{text}");
        fs::remove_file(tool.root().join("usr/bin/qemu-system-arm")).unwrap();
        assert!(refused(&tool, "debian 12").contains("does not start"));
        fs::remove_dir_all(&tool.directory).unwrap();
        assert!(tool.try_out(&shell, Tool::Qemu, "debian 12").is_err());
    }
}
