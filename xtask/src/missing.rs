//! Tools that this machine lacks, each with the command that installs it.

use std::fmt;

use crate::{
    system::{Family, System},
    tools::Tool,
    version::Version,
};

/// A tool that is not available.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Missing {
    tool: Tool,
    /// Reason, in one line.
    why: String,
    remedy: String,
}

impl Missing {
    /// Creates it from the error that prevented the tool.
    pub(crate) fn new(tool: Tool, system: &System, error: &anyhow::Error) -> Self {
        let text = format!("{error:#}");
        let remedy = match error.downcast_ref::<TooOld>() {
            // The system would install the version that was refused.
            Some(too_old) if tool == Tool::Qemu => too_old.remedy(),
            _ => remedy(tool, system),
        };
        Self {
            tool,
            why: text.split_whitespace().collect::<Vec<_>>().join(" "),
            remedy,
        }
    }

    /// Creates it for an active toolchain without clippy.
    pub(crate) fn clippy(system: &System) -> Self {
        let of_rustup = || "rustup component add clippy".to_owned();
        Self {
            tool: Tool::Clippy,
            why: "the active toolchain has none".to_owned(),
            remedy: if system.has_rustup {
                of_rustup()
            } else {
                remedy(Tool::Clippy, system)
            },
        }
    }

    /// Adds an earlier finding to the reason.
    pub(crate) fn after(mut self, found: &str) -> Self {
        self.why = format!("{found}; {}", self.why);
        self
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tool, why, remedy } = self;
        write!(f, "no {tool}: {why}; to mend it: {remedy}")
    }
}

impl std::error::Error for Missing {}

/// Error: the package lists offer a version that is too old.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TooOld {
    pub(crate) package: &'static str,
    pub(crate) offered: Version,
    pub(crate) oldest: Version,
}

impl TooOld {
    fn remedy(&self) -> String {
        let Self {
            package, oldest, ..
        } = self;
        format!("put {package} {oldest} or later on the search path")
    }
}

impl fmt::Display for TooOld {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            package,
            offered,
            oldest,
        } = self;
        write!(
            f,
            "{package} is {offered} in the package lists, and {oldest} or later is needed"
        )
    }
}

impl std::error::Error for TooOld {}

/// Returns the command by which a user of that system gets the tool.
fn remedy(tool: Tool, system: &System) -> String {
    if system.has_rustup {
        match tool {
            // The toolchain's own linker and clippy are then used.
            Tool::Compiler | Tool::Linker | Tool::Clippy => {
                return "rustup target add thumbv7em-none-eabihf".to_owned();
            }
            Tool::Coverage => return "rustup component add llvm-tools".to_owned(),
            Tool::Qemu
            | Tool::Llvm
            | Tool::Pip
            | Tool::Aarch64
            | Tool::ArmGcc
            | Tool::Cmake
            | Tool::Cppcheck
            | Tool::Browser
            | Tool::Gappa => {}
        }
    }
    // A Rust that is not a distribution's comes with everything that a target needs.
    let rustup = |install: &str| format!("{install} rustup");
    match (system.family, tool) {
        (Family::Debian, _) => format!("sudo apt-get install {}", tool.packages().join(" ")),
        (
            Family::Ubuntu,
            Tool::Qemu
            | Tool::Llvm
            | Tool::Pip
            | Tool::Aarch64
            | Tool::ArmGcc
            | Tool::Cmake
            | Tool::Cppcheck
            | Tool::Gappa,
        ) => {
            format!("sudo apt-get install {}", tool.packages().join(" "))
        }
        // Ubuntu's own package of Chromium is a snap, which has no files of its own.
        (Family::Ubuntu, Tool::Browser) => "sudo snap install chromium".to_owned(),
        // Ubuntu has none of Debian's packages of a compiler for browsers.
        (Family::Ubuntu, _) => rustup("sudo apt-get install"),
        (Family::Arch, Tool::Aarch64) => {
            "sudo pacman -S aarch64-linux-gnu-gcc qemu-user-static".to_owned()
        }
        (Family::Fedora | Family::MacOs | Family::Windows | Family::Other, Tool::Aarch64) => {
            "run it on Debian, Ubuntu or Arch, or on a 64-bit Arm".to_owned()
        }
        (Family::Fedora, Tool::Gappa) => "sudo dnf install gappa".to_owned(),
        (Family::MacOs, Tool::Gappa) => "brew install gappa".to_owned(),
        (Family::Arch | Family::Windows | Family::Other, Tool::Gappa) => {
            "put gappa on the search path".to_owned()
        }
        (Family::Fedora, Tool::Qemu) => "sudo dnf install qemu-system-arm".to_owned(),
        (Family::Fedora, Tool::Llvm) => "sudo dnf install llvm".to_owned(),
        (Family::Fedora, Tool::Pip) => "sudo dnf install python3-pip".to_owned(),
        (Family::Fedora, Tool::ArmGcc) => {
            "sudo dnf install arm-none-eabi-gcc arm-none-eabi-newlib".to_owned()
        }
        (Family::Fedora, Tool::Cmake) => "sudo dnf install cmake".to_owned(),
        (Family::Fedora, Tool::Cppcheck) => "sudo dnf install cppcheck".to_owned(),
        (Family::Fedora, Tool::Browser) => "sudo dnf install chromium".to_owned(),
        (Family::Fedora, _) => rustup("sudo dnf install"),
        (Family::Arch, Tool::Qemu) => "sudo pacman -S qemu-system-arm".to_owned(),
        (Family::Arch, Tool::Llvm) => "sudo pacman -S llvm".to_owned(),
        (Family::Arch, Tool::Pip) => "sudo pacman -S python-pip".to_owned(),
        (Family::Arch, Tool::ArmGcc) => {
            "sudo pacman -S arm-none-eabi-gcc arm-none-eabi-newlib".to_owned()
        }
        (Family::Arch, Tool::Cmake) => "sudo pacman -S cmake".to_owned(),
        (Family::Arch, Tool::Cppcheck) => "sudo pacman -S cppcheck".to_owned(),
        (Family::Arch, Tool::Browser) => "sudo pacman -S chromium".to_owned(),
        (Family::Arch, _) => rustup("sudo pacman -S"),
        (Family::MacOs, Tool::Qemu) => "brew install qemu".to_owned(),
        (Family::MacOs, Tool::Llvm) => "brew install llvm".to_owned(),
        (Family::MacOs, Tool::Pip) => "brew install python".to_owned(),
        (Family::MacOs, Tool::ArmGcc) => "brew install gcc-arm-embedded".to_owned(),
        (Family::MacOs, Tool::Cmake) => "brew install cmake".to_owned(),
        (Family::MacOs, Tool::Cppcheck) => "brew install cppcheck".to_owned(),
        (Family::MacOs, Tool::Browser) => "brew install --cask google-chrome".to_owned(),
        (Family::MacOs, _) => rustup("brew install"),
        (Family::Windows, Tool::Qemu) => {
            "winget install --id SoftwareFreedomConservancy.QEMU".to_owned()
        }
        (Family::Windows, Tool::Llvm) => "winget install --id LLVM.LLVM".to_owned(),
        (Family::Windows, Tool::Pip) => "winget install --id Python.Python.3.13".to_owned(),
        (Family::Windows, Tool::ArmGcc) => {
            "winget install --id Arm.GnuArmEmbeddedToolchain".to_owned()
        }
        (Family::Windows, Tool::Cmake) => "winget install --id Kitware.CMake".to_owned(),
        (Family::Windows, Tool::Cppcheck) => "winget install --id Cppcheck.Cppcheck".to_owned(),
        (Family::Windows, Tool::Browser) => "winget install --id Google.Chrome".to_owned(),
        (Family::Windows, _) => "winget install --id Rustlang.Rustup".to_owned(),
        (Family::Other, Tool::Qemu) => {
            "put qemu-system-arm, 7.2 or later, on the search path".to_owned()
        }
        (Family::Other, Tool::Llvm) => "put llvm-mca, 19 or later, on the search path".to_owned(),
        (Family::Other, Tool::Pip) => {
            "put python3, 3.11 or later, with pip on the search path".to_owned()
        }
        (Family::Other, Tool::ArmGcc) => "put arm-none-eabi-gcc on the search path".to_owned(),
        (Family::Other, Tool::Cmake) => "put cmake on the search path".to_owned(),
        (Family::Other, Tool::Cppcheck) => "put cppcheck on the search path".to_owned(),
        (Family::Other, Tool::Browser) => "put chromium on the search path".to_owned(),
        (Family::Other, _) => "rustup target add thumbv7em-none-eabihf".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn missing(tool: Tool, family: Family, has_rustup: bool) -> String {
        let system = System {
            family,
            release: String::new(),
            has_rustup,
        };
        let error = anyhow::anyhow!("E: no\n  network").context("package lists");
        Missing::new(tool, &system, &error).to_string()
    }

    #[test]
    fn what_is_too_old_is_not_recommended() {
        let system = System {
            family: Family::Ubuntu,
            release: String::new(),
            has_rustup: true,
        };
        let too_old = TooOld {
            package: "qemu-system-arm",
            offered: Version::new(6, 2),
            oldest: Version::new(7, 2),
        };
        let text = Missing::new(Tool::Qemu, &system, &too_old.into()).to_string();
        let expected = "no QEMU: qemu-system-arm is 6.2 in the package lists, and 7.2 or later is needed; to mend it: put qemu-system-arm 7.2 or later on the search path";
        assert_eq!(text, expected);
    }

    #[test]
    fn every_system_has_one_command_in_one_line() {
        for (family, qemu, compiler) in [
            (
                Family::Debian,
                "sudo apt-get install qemu-system-arm",
                "sudo apt-get install rustc-web cargo-web rust-web-src",
            ),
            (
                Family::Ubuntu,
                "sudo apt-get install qemu-system-arm",
                "sudo apt-get install rustup",
            ),
            (
                Family::Fedora,
                "sudo dnf install qemu-system-arm",
                "sudo dnf install rustup",
            ),
            (
                Family::Arch,
                "sudo pacman -S qemu-system-arm",
                "sudo pacman -S rustup",
            ),
            (Family::MacOs, "brew install qemu", "brew install rustup"),
            (Family::Windows, "QEMU", "Rustup"),
            (
                Family::Other,
                "7.2 or later, on the search path",
                "rustup target add thumbv7em-none-eabihf",
            ),
        ] {
            let qemu_text = missing(Tool::Qemu, family, true);
            assert!(qemu_text.ends_with(qemu), "{qemu_text}");
            assert!(qemu_text.starts_with("no QEMU: package lists: E: no network; to mend it: "));
            assert_eq!(qemu_text.lines().count(), 1);
            assert!(missing(Tool::Compiler, family, false).ends_with(compiler));
            let with_rustup = missing(Tool::Compiler, family, true);
            assert!(with_rustup.ends_with("rustup target add thumbv7em-none-eabihf"));
        }
        let clippy = missing(Tool::Clippy, Family::Debian, false);
        assert!(
            clippy.ends_with("sudo apt-get install rust-web-clippy"),
            "{clippy}"
        );
    }
}
