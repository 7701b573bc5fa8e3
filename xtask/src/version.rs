//! Versions, as far as decisions depend on them: major and minor number.

use std::fmt;

/// Major and minor number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Version {
    major: u32,
    minor: u32,
}

impl Version {
    /// Creates a version from its numbers.
    pub(crate) const fn new(major: u32, minor: u32) -> Self {
        Self { major, minor }
    }

    /// Finds the first word of a text that begins with two numbers separated by a point, in what a
    /// program says of itself or in a manifest's `rust-version`.
    pub(crate) fn find(text: &str) -> Option<Self> {
        text.split_whitespace().find_map(|word| {
            let mut parts = word.split('.');
            let major = parts.next()?.parse().ok()?;
            let minor = parts.next()?;
            let end = minor
                .find(|c: char| !c.is_ascii_digit())
                .unwrap_or(minor.len());
            let minor = minor.get(..end)?.parse().ok()?;
            Some(Self { major, minor })
        })
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.major, self.minor)
    }
}

#[cfg(test)]
mod tests {
    use super::Version;

    #[test]
    fn version_is_read_from_programs_packages_and_manifests() {
        for (text, expected) in [
            (
                "rustc 1.96.0 (ac68faa20 2026-05-25) (built from a source tarball)",
                Some((1, 96)),
            ),
            ("rustc 1.97.0-nightly (0123456 2026-01-01)", Some((1, 97))),
            (
                "QEMU emulator version 7.2.22 (Debian 1:7.2+dfsg-7)\nCopyright (c) 2003-2022",
                Some((7, 2)),
            ),
            ("7.2+dfsg-7+deb12u18", Some((7, 2))),
            ("1.95", Some((1, 95))),
            ("", None),
            ("rustc", None),
            ("version x.y", None),
        ] {
            let expected = expected.map(|(major, minor)| Version::new(major, minor));
            assert_eq!(Version::find(text), expected, "{text:?}");
        }
        assert!(Version::new(10, 0) > Version::new(7, 2));
        assert!(Version::new(7, 2) > Version::new(6, 2));
    }
}
