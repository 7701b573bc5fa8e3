//! Closure of a tool's packages: texts to and from apt, without calling it.

use crate::version::Version;

/// A package at a version.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Package {
    pub(super) name: String,
    pub(super) version: String,
}

impl Package {
    /// Returns the version of the packaged program, without Debian's own numbers.
    pub(super) fn upstream(&self) -> Option<Version> {
        let (_, upstream) = self
            .version
            .split_once(':')
            .unwrap_or(("", self.version.as_str()));
        Version::find(upstream)
    }
}

/// Fields of dpkg's status that describe what is installed.
const KEPT: [&str; 6] = [
    "Package:",
    "Source:",
    "Architecture:",
    "Multi-Arch:",
    "Version:",
    "Provides:",
];

/// Returns dpkg's status for the question which packages of `source` are absent. It lists all
/// installed packages, but not their dependencies and conflicts, since the tool is unpacked beside
/// them; it lists none of `source`, whose installed packages may be of another version.
pub(super) fn status(installed: &str, source: &str) -> String {
    let others = stanzas(installed).filter(|stanza| source_of(stanza) != Some(source));
    others.map(self::installed).collect()
}

/// Returns true if a package is installed at that version, for that processor or for all.
pub(super) fn has(installed: &str, package: &Package, architecture: &str) -> bool {
    stanzas(installed).any(|stanza| {
        field(stanza, "Package:") == Some(&package.name)
            && field(stanza, "Version:") == Some(&package.version)
            && [Some("all"), Some(architecture)].contains(&field(stanza, "Architecture:"))
    })
}

/// Returns the version at which a package is installed.
pub(super) fn version_of(installed: &str, package: &str) -> Option<String> {
    let is_it = |stanza: &&str| field(stanza, "Package:") == Some(package);
    let stanza = stanzas(installed).find(is_it)?;
    field(stanza, "Version:").map(str::to_owned)
}

/// Returns the stanzas of the packages that are completely installed.
fn stanzas(status: &str) -> impl Iterator<Item = &str> {
    status.split("\n\n").filter(|stanza| {
        let state = field(stanza, "Status:").unwrap_or_default();
        state.split_whitespace().next_back() == Some("installed")
    })
}

/// Converts a stanza into that of an installed package.
pub(super) fn installed(stanza: &str) -> String {
    let is_kept = |line: &&str| KEPT.iter().any(|field| line.starts_with(field));
    let kept: Vec<_> = stanza.lines().filter(is_kept).collect();
    format!("{}\nStatus: install ok installed\n\n", kept.join("\n"))
}

/// Returns the source package from which a stanza's package is built.
pub(super) fn source_of(stanza: &str) -> Option<&str> {
    let value = field(stanza, "Source:").or_else(|| field(stanza, "Package:"))?;
    value.split_whitespace().next()
}

fn field<'a>(stanza: &'a str, name: &str) -> Option<&'a str> {
    let value = stanza.lines().find_map(|line| line.strip_prefix(name))?;
    Some(value.trim())
}

/// Returns the packages that `apt-get install --simulate` would install, without the C library: it
/// belongs to the system's loader, and its release has the one for which the other packages are
/// built.
pub(super) fn installs(simulation: &str) -> Vec<Package> {
    let package = |line: &str| {
        let rest = line.strip_prefix("Inst ")?;
        let (name, rest) = rest.split_once(' ')?;
        let (_, version) = rest.split_once('(')?;
        Some(Package {
            name: name.to_owned(),
            version: version.split_whitespace().next()?.to_owned(),
        })
    };
    let is_c_library = |package: &Package| ["libc6", "libc-bin"].contains(&package.name.as_str());
    simulation
        .lines()
        .filter_map(package)
        .filter(|package| !is_c_library(package))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const INSTALLED: &str = "Package: zlib1g
Status: install ok installed
Architecture: amd64
Source: zlib
Version: 1:1.2.13
Provides: libz1
Depends: libc6 (>= 2.14)
Breaks: libxml2 (<< 2.7)
Description: compression
 of many kinds

Package: qemu-utils
Status: hold ok installed
Source: qemu (1:99)
Version: 1:99.0
Breaks: qemu-system-common (<< 1:98)

Package: gone
Status: deinstall ok config-files
Version: 1

Package: half
Status: install ok half-configured
Version: 1

Package: qemu
Status: install ok installed
Version: 1
";

    #[test]
    fn installed_packages_are_there_and_stand_in_nobodys_way() {
        let expected = "Package: zlib1g
Architecture: amd64
Source: zlib
Version: 1:1.2.13
Provides: libz1
Status: install ok installed

";
        assert_eq!(status(INSTALLED, "qemu"), expected);
        // The output can be read again.
        assert_eq!(status(&status(INSTALLED, "qemu"), ""), expected);
        let zlib = Package {
            name: "zlib1g".to_owned(),
            version: "1:1.2.13".to_owned(),
        };
        assert!(!has(INSTALLED, &zlib, "i386"));
        assert!(has(INSTALLED, &zlib, "amd64") && has(&status(INSTALLED, "qemu"), &zlib, "amd64"));
        let newer = Package {
            version: "1:1.2.14".to_owned(),
            ..zlib
        };
        assert!(!has(INSTALLED, &newer, "amd64"));
        let gone = Package {
            name: "gone".to_owned(),
            version: "1".to_owned(),
        };
        assert!(!has(INSTALLED, &gone, "amd64"));
        let other = status(INSTALLED, "other");
        assert_eq!(other.matches("Package: ").count(), 3);
        assert!(!other.contains("Breaks"));
    }

    #[test]
    fn packages_are_those_that_would_be_installed_whatever_would_be_removed() {
        let simulation = "NOTE: This is only a simulation!
Remv qemu-utils [1:99.0]
Inst libc6 [2.36-9] (2.36-10 Debian:12.15/oldstable [amd64])
Inst libfdt1 (1.6.1-4+b1 Debian:12.15/oldstable [amd64])
Inst libglib2.0-0 [2.74.6-2] (2.74.6-3 Debian-Security:12/oldstable-security [amd64]) []
Inst qemu-system-arm (1:7.2+dfsg-7+deb12u18+b3 Debian:12.15/oldstable [amd64])
Conf libfdt1 (1.6.1-4+b1 Debian:12.15/oldstable [amd64])
";
        let packages = installs(simulation);
        let names: Vec<_> = packages
            .iter()
            .map(|package| format!("{}={}", package.name, package.version))
            .collect();
        assert_eq!(
            names,
            [
                "libfdt1=1.6.1-4+b1",
                "libglib2.0-0=2.74.6-3",
                "qemu-system-arm=1:7.2+dfsg-7+deb12u18+b3"
            ]
        );
        assert_eq!(packages[2].upstream(), Some(Version::new(7, 2)));
    }
}
