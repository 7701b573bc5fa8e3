//! System on which xtask runs, as far as it determines the origin of tools.

use std::{env::consts::ARCH, fs};

use crate::machine::on_path;

/// Kind of system, by the way in which a user installs programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// Debian and its derivatives.
    Debian,
    /// Ubuntu and its derivatives.
    Ubuntu,
    /// Fedora, Red Hat and their derivatives.
    Fedora,
    /// Arch Linux.
    Arch,
    /// macOS, with Homebrew.
    MacOs,
    /// Windows.
    Windows,
    /// Any other system.
    Other,
}

/// An operating system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct System {
    pub(crate) family: Family,
    /// Name, version and processor: `debian 12 x86_64`.
    pub(crate) release: String,
    /// `true` if Rust was installed by rustup.
    pub(crate) has_rustup: bool,
}

impl System {
    /// Returns the system on which xtask runs.
    pub(crate) fn here() -> Self {
        let has_rustup = on_path("rustup").is_some();
        let fixed = |family, name: &str| Self {
            family,
            release: format!("{name} {ARCH}"),
            has_rustup,
        };
        if cfg!(windows) {
            return fixed(Family::Windows, "windows");
        }
        if cfg!(target_os = "macos") {
            return fixed(Family::MacOs, "macos");
        }
        let text = fs::read_to_string("/etc/os-release").unwrap_or_default();
        Self {
            has_rustup,
            ..Self::of_os_release(&text)
        }
    }

    /// Returns the system that `/etc/os-release` describes.
    fn of_os_release(text: &str) -> Self {
        let of = |key: &str| {
            let value = text
                .lines()
                .find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
            value.unwrap_or_default().trim_matches(['"', '\''])
        };
        let names = [of("ID"), of("ID_LIKE")];
        let is = |name: &str| {
            names
                .iter()
                .flat_map(|names| names.split_whitespace())
                .any(|word| word == name)
        };
        let family = [
            ("ubuntu", Family::Ubuntu),
            ("debian", Family::Debian),
            ("fedora", Family::Fedora),
            ("rhel", Family::Fedora),
            ("arch", Family::Arch),
        ]
        .into_iter()
        .find(|(name, _)| is(name))
        .map_or(Family::Other, |(_, family)| family);
        Self {
            family,
            release: format!("{} {} {ARCH}", of("ID"), of("VERSION_ID")),
            has_rustup: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn family_is_told_by_name_or_likeness() {
        for (text, family, release) in [
            (
                "NAME=\"Debian GNU/Linux\"\nID=debian\nVERSION_ID=\"12\"\n",
                Family::Debian,
                "debian 12",
            ),
            (
                "ID=linuxmint\nID_LIKE=\"ubuntu debian\"\nVERSION_ID=22\n",
                Family::Ubuntu,
                "linuxmint 22",
            ),
            (
                "ID=ubuntu\nID_LIKE=debian\nVERSION_ID=\"24.04\"\n",
                Family::Ubuntu,
                "ubuntu 24.04",
            ),
            ("ID=fedora\nVERSION_ID=43\n", Family::Fedora, "fedora 43"),
            (
                "ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\nVERSION_ID=9\n",
                Family::Fedora,
                "rocky 9",
            ),
            ("ID=arch\nBUILD_ID=rolling\n", Family::Arch, "arch "),
            ("ID=alpine\nVERSION_ID=3\n", Family::Other, "alpine 3"),
            ("", Family::Other, " "),
        ] {
            let system = System::of_os_release(text);
            assert_eq!(system.family, family, "{text}");
            assert_eq!(system.release, format!("{release} {ARCH}"));
        }
    }
}
