//! Which toolchain builds for a target: the decision alone, a pure function of facts about the machine.
//!
//! A target needs a core library of its own. In order of preference it comes
//! 1. ready-made with the active toolchain (`rustup target add`, or `rust-toolchain.toml`, has installed it),
//! 2. from the library sources of the active toolchain,
//! 3. from the library sources of the distribution's toolchain,
//! 4. the same after installing the distribution's packages, where apt-get and the right to use it exist.
//!
//! To run the firmware, QEMU is needed as well: the one on the search path, or the distribution's.
//!
//! Each target goes its own way. The firmware's must find one; for the other nothing is installed, and where no
//! toolchain builds for it, it is left out.

use std::fmt;

/// What is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Architecture {
    /// Armv7E-M with hardware floating point: Cortex-M4F and M7, which the firmware is for.
    Armv7em,
    /// Armv8.1-M with vectors of four numbers (Helium): Cortex-M55.
    Helium,
}

impl Architecture {
    /// The compiler's name of it.
    pub(crate) fn target(self) -> &'static str {
        match self {
            Self::Armv7em => "thumbv7em-none-eabihf",
            Self::Helium => "thumbv8m.main-none-eabihf",
        }
    }

    /// The processor to compile for, where the target's name says too little.
    pub(crate) fn processor(self) -> Option<&'static str> {
        match self {
            Self::Armv7em => None,
            Self::Helium => Some("cortex-m55"),
        }
    }

    /// Cargo's variable for a setting of the target: `LINKER`, `RUSTFLAGS`.
    pub(crate) fn variable(self, setting: &str) -> String {
        let target = self.target().replace(['-', '.'], "_").to_uppercase();
        format!("CARGO_TARGET_{target}_{setting}")
    }
}

/// Debian's packages of a compiler, its cargo and its library sources.
const COMPILER_PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
/// Debian's package of clippy for the same compiler.
const CLIPPY_PACKAGE: &str = "rust-web-clippy";
/// The package of a linker that knows the target.
const LINKER_PACKAGE: &str = "lld";
/// QEMU's program for the target, and the package of it.
pub(crate) const QEMU: &str = "qemu-system-arm";

/// What is to be set up; the greater includes the lesser.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Need {
    /// A toolchain that builds for the target.
    Toolchain,
    /// The same, and QEMU to run what it builds.
    ToolchainAndQemu,
}

/// What one toolchain offers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Toolchain {
    /// The target's compiled core library.
    pub(crate) target_core: bool,
    /// The sources of the standard library.
    pub(crate) library_sources: bool,
    /// Clippy.
    pub(crate) clippy: bool,
}

/// What the decision for one target rests on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Facts {
    /// The toolchain that runs xtask.
    pub(crate) active: Toolchain,
    /// The distribution's toolchain; all `false` where it is absent or older than the workspace allows.
    pub(crate) distribution: Toolchain,
    /// Some linker that knows the target.
    pub(crate) linker: bool,
    /// QEMU for the target.
    pub(crate) qemu: bool,
    /// apt-get, and the right to install with it.
    pub(crate) may_install: bool,
}

/// Whose compiler is used, and where its core library for the target comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Route {
    /// The active toolchain with its compiled core library.
    Active,
    /// The active toolchain, core built from its sources.
    ActiveFromSource,
    /// The distribution's toolchain, core built from its sources.
    Distribution,
}

/// A route and the packages it needs first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Plan {
    /// The route.
    pub(crate) route: Route,
    /// Packages to install, none on most machines.
    pub(crate) install: Vec<&'static str>,
}

/// No toolchain for the target or no QEMU, and no right to install them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NoRoute {
    target: &'static str,
    missing: Vec<&'static str>,
}

impl fmt::Display for NoRoute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.missing.iter().any(|package| *package != QEMU) {
            let target = self.target;
            write!(
                f,
                "no toolchain here builds for {target}. Either\n    rustup target add {target}\n"
            )?;
        }
        if self.missing.contains(&QEMU) {
            writeln!(
                f,
                "no QEMU here runs the firmware. Either put {QEMU}, 7.2 or later, on the search path"
            )?;
        }
        write!(
            f,
            "or, on Debian or Ubuntu,\n    sudo apt-get install {}",
            self.missing.join(" ")
        )
    }
}

impl std::error::Error for NoRoute {}

/// The first route that the machine allows.
///
/// # Errors
/// [`NoRoute`] where packages are missing and may not be installed; its text names both ways out.
pub(crate) fn choose(
    architecture: Architecture,
    facts: Facts,
    need: Need,
) -> Result<Plan, NoRoute> {
    let Facts {
        active,
        distribution,
        linker,
        qemu,
        may_install,
    } = facts;
    let mut install = vec![];
    let route = if active.target_core {
        Route::Active
    } else if active.library_sources && active.clippy {
        Route::ActiveFromSource
    } else {
        if !distribution.library_sources {
            install.extend(COMPILER_PACKAGES);
        }
        if !distribution.clippy {
            install.push(CLIPPY_PACKAGE);
        }
        Route::Distribution
    };
    // A compiler with a compiled core library brings its linker along.
    if route != Route::Active && !linker {
        install.push(LINKER_PACKAGE);
    }
    if need == Need::ToolchainAndQemu && !qemu {
        install.push(QEMU);
    }
    if install.is_empty() || may_install {
        Ok(Plan { route, install })
    } else {
        Err(NoRoute {
            target: architecture.target(),
            missing: install,
        })
    }
}

/// The first route that the machine allows as it is.
///
/// # Errors
/// [`NoRoute`] where packages are missing, whether or not they may be installed.
pub(crate) fn choose_without_installing(
    architecture: Architecture,
    facts: Facts,
) -> Result<Route, NoRoute> {
    let facts = Facts {
        may_install: false,
        ..facts
    };
    choose(architecture, facts, Need::Toolchain).map(|plan| plan.route)
}

/// Major and minor number in the answer to `rustc --version`, or in a `rust-version` of a manifest.
pub(crate) fn version(text: &str) -> Option<(u32, u32)> {
    let number = text
        .trim_start_matches("rustc ")
        .split_whitespace()
        .next()?;
    let mut parts = number.split('.').map(str::parse);
    Some((parts.next()?.ok()?, parts.next()?.ok()?))
}

#[cfg(test)]
mod tests {
    use super::{Architecture::*, *};

    /// Each kind of machine: what its toolchains and the machine itself offer, the route, and the packages it installs.
    /// QEMU is needed in the rows that tell whether there is one.
    const MACHINES: &str = "
        active         | distribution   | machine     | route            | packages
        core clippy    |                |             | Active           |
        core           | sources clippy | linker apt  | Active           |
        sources clippy |                | linker      | ActiveFromSource |
        sources clippy | sources clippy | linker apt  | ActiveFromSource |
        clippy         | sources clippy | linker      | Distribution     |
        sources clippy | sources clippy | apt         | ActiveFromSource | lld
        sources        | sources        | apt         | Distribution     | rust-web-clippy lld
        clippy         | sources        | linker apt  | Distribution     | rust-web-clippy
        clippy         | sources clippy | apt         | Distribution     | lld
        clippy         |                | linker apt  | Distribution     | rustc-web cargo-web rust-web-src rust-web-clippy
                       |                | apt         | Distribution     | rustc-web cargo-web rust-web-src rust-web-clippy lld
        clippy         | sources        | linker      | refused          | rust-web-clippy
        sources clippy |                |             | refused          | lld
        clippy         |                | linker      | refused          | rustc-web cargo-web rust-web-src rust-web-clippy
        core clippy    |                | has-qemu    | Active           |
        core clippy    |                | apt no-qemu | Active           | qemu-system-arm
        clippy         | sources clippy | apt no-qemu | Distribution     | lld qemu-system-arm
        core clippy    |                | no-qemu     | refused          | qemu-system-arm";

    fn toolchain(offers: &str) -> Toolchain {
        Toolchain {
            target_core: offers.contains("core"),
            library_sources: offers.contains("sources"),
            clippy: offers.contains("clippy"),
        }
    }

    #[test]
    fn every_kind_of_machine_gets_its_route() {
        for row in MACHINES.lines().skip(2) {
            let cells: Vec<_> = row.split('|').map(str::trim).collect();
            let facts = Facts {
                active: toolchain(cells[0]),
                distribution: toolchain(cells[1]),
                linker: cells[2].contains("linker"),
                qemu: cells[2].contains("has-qemu"),
                may_install: cells[2].contains("apt"),
            };
            let need = if cells[2].contains("qemu") {
                Need::ToolchainAndQemu
            } else {
                Need::Toolchain
            };
            let (route, packages) = match choose(Armv7em, facts, need) {
                Ok(plan) => (format!("{:?}", plan.route), plan.install),
                Err(refused) => ("refused".to_owned(), refused.missing),
            };
            assert_eq!(
                (route.as_str(), packages.join(" ").as_str()),
                (cells[3], cells[4]),
                "{row}"
            );
        }
    }

    #[test]
    fn refusal_names_both_ways_out() {
        let refused = choose(Armv7em, Facts::default(), Need::ToolchainAndQemu).unwrap_err();
        let text = refused.to_string();
        assert!(
            text.contains("rustup target add thumbv7em-none-eabihf"),
            "{text}"
        );
        assert!(
            text.contains(
                "apt-get install rustc-web cargo-web rust-web-src rust-web-clippy lld qemu-system-arm"
            ),
            "{text}"
        );
        assert!(
            text.contains("put qemu-system-arm, 7.2 or later, on the search path"),
            "{text}"
        );
    }

    #[test]
    fn refusal_speaks_only_of_what_is_missing() {
        let toolchain_alone = choose(Armv7em, Facts::default(), Need::Toolchain).unwrap_err();
        assert!(!toolchain_alone.to_string().contains("QEMU"));
        let has_toolchain = Facts {
            active: toolchain("core clippy"),
            ..Facts::default()
        };
        let qemu_alone = choose(Armv7em, has_toolchain, Need::ToolchainAndQemu).unwrap_err();
        assert!(!qemu_alone.to_string().contains("toolchain"));
    }

    #[test]
    fn nothing_is_installed_for_helium() {
        let machine = |active, distribution, linker| Facts {
            active: toolchain(active),
            distribution: toolchain(distribution),
            linker,
            qemu: true,
            may_install: true,
        };
        for (active, distribution, linker, expected) in [
            ("core clippy", "", false, Some(Route::Active)),
            ("sources clippy", "", true, Some(Route::ActiveFromSource)),
            ("clippy", "sources clippy", true, Some(Route::Distribution)),
            // The firmware's target makes do with less: a toolchain that has it, and its own linker.
            ("clippy", "", false, None),
            ("clippy", "sources clippy", false, None),
            ("sources clippy", "", false, None),
            ("clippy", "sources", true, None),
        ] {
            let facts = machine(active, distribution, linker);
            let route = choose_without_installing(Helium, facts);
            assert_eq!(route.ok(), expected, "{active} | {distribution} | {linker}");
        }
        let refused = choose_without_installing(Helium, machine("clippy", "", true)).unwrap_err();
        let text = refused.to_string();
        assert!(
            text.contains("rustup target add thumbv8m.main-none-eabihf"),
            "{text}"
        );
    }

    #[test]
    fn variables_of_a_target_are_those_that_cargo_reads() {
        assert_eq!(
            Armv7em.variable("LINKER"),
            "CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER"
        );
        assert_eq!(
            Helium.variable("RUSTFLAGS"),
            "CARGO_TARGET_THUMBV8M_MAIN_NONE_EABIHF_RUSTFLAGS"
        );
    }

    #[test]
    fn version_is_read_from_compiler_and_manifest() {
        for (text, expected) in [
            (
                "rustc 1.96.0 (ac68faa20 2026-05-25) (built from a source tarball)",
                Some((1, 96)),
            ),
            ("rustc 1.97.0-nightly (0123456 2026-01-01)", Some((1, 97))),
            ("1.95", Some((1, 95))),
            ("", None),
            ("rustc", None),
        ] {
            assert_eq!(version(text), expected, "{text:?}");
        }
    }
}
