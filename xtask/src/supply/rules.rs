//! Rules for what an image holds: licences, and crates in two versions.

use std::collections::{BTreeMap, BTreeSet};

use spdx::{Expression, LicenseReq, ParseMode};

use super::image::Part;

/// Licences of which one must cover every crate. All ask for their text to go along at most; the
/// last for the sources of that crate, if they are changed.
const ALLOWED: [&str; 9] = [
    "MIT",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "Unicode-3.0",
    "Zlib",
    "0BSD",
    "MPL-2.0",
];

/// Images for which [`TWICE`] must name every crate that they hold in two versions: those in a
/// camera.
const IN_A_CAMERA: [&str; 3] = ["qemu", "board", "c"];

/// Crates that an image in a camera holds in two versions, and why.
const TWICE: [(&str, &str); 8] = [
    (
        "bitflags",
        "cortex-m 0.7 and the board's support have one each",
    ),
    ("cobs", "postcard has an older one than the link"),
    ("embassy-hal-internal", "embassy's crates have one each"),
    ("embedded-hal", "cortex-m 0.7 implements the traits of 0.2"),
    ("embedded-io", "embassy implements the traits of both"),
    ("embedded-io-async", "embassy implements the traits of both"),
    ("nb", "embedded-hal 0.2 has the older one"),
    ("rand_core", "embassy implements the traits of both"),
];

/// Returns what is wrong with the licences and versions of the crates.
pub(super) fn faults(parts: &BTreeSet<Part>) -> Vec<String> {
    let mut faults = Vec::new();
    let mut versions: BTreeMap<(&str, &str), BTreeSet<&str>> = BTreeMap::new();
    for part in parts {
        if let Err(why) = check_licence(&part.licence) {
            faults.push(format!(
                "{}: {} {}: {why}; allowed: {}",
                part.image,
                part.name,
                part.version,
                ALLOWED.join(", ")
            ));
        }
        let of = versions.entry((&part.image, &part.name)).or_default();
        of.insert(&part.version);
    }
    for ((image, name), versions) in versions {
        let is_named = TWICE.iter().any(|(twice, _)| *twice == name);
        if IN_A_CAMERA.contains(&image) && versions.len() > 1 && !is_named {
            let versions: Vec<&str> = versions.into_iter().collect();
            faults.push(format!(
                "{image}: {name} in the versions {}; allowed: one, or a reason in xtask/src/supply/rules.rs",
                versions.join(", ")
            ));
        }
    }
    faults
}

fn check_licence(licence: &str) -> Result<(), String> {
    let licence = licence.trim();
    if licence.is_empty() {
        return Err("states no licence".to_owned());
    }
    // Older crates have a slash for "or".
    let expression = Expression::parse_mode(licence, ParseMode::LAX)
        .map_err(|error| format!("licence {licence:?}: {}", error.reason))?;
    let is_allowed = |asked: &LicenseReq| {
        let id = asked.license.id();
        id.is_some_and(|id| ALLOWED.contains(&id.name))
    };
    if expression.evaluate(is_allowed) {
        Ok(())
    } else {
        Err(format!("licence {licence}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(image: &str, version: &str, licence: &str) -> Part {
        Part {
            image: image.to_owned(),
            name: "x".to_owned(),
            version: version.to_owned(),
            licence: licence.to_owned(),
            has_unsafe: "no".to_owned(),
        }
    }

    #[test]
    fn licence_that_is_not_allowed_is_a_fault() {
        for allowed in [
            "MIT",
            "MIT/Apache-2.0",
            "GPL-2.0-only OR MIT",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
        ] {
            assert_eq!(check_licence(allowed), Ok(()), "{allowed}");
        }
        for refused in ["GPL-3.0-only", "MIT AND AGPL-3.0-only", "", "of my own"] {
            assert!(check_licence(refused).is_err(), "{refused}");
        }
        let faults = faults(&BTreeSet::from([part("board", "1.0.0", "GPL-3.0-only")]));
        assert_eq!(faults.len(), 1);
        assert!(faults[0].starts_with("board: x 1.0.0: licence GPL-3.0-only; allowed: MIT"));
    }

    #[test]
    fn crate_in_two_versions_is_a_fault_in_a_camera() {
        let twice = |image| BTreeSet::from(["1.0.0", "2.0.0"].map(|it| part(image, it, "MIT")));
        assert_eq!(faults(&twice("host-sim")), Vec::<String>::new());
        let faults = faults(&twice("qemu"));
        assert_eq!(faults.len(), 1);
        assert!(faults[0].contains("x in the versions 1.0.0, 2.0.0"));
    }
}
