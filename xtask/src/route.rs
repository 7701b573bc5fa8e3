//! Which toolchain builds for a target: the decision alone, a pure function of facts about the machine.
//!
//! A target needs a core library of its own. In order of preference it comes
//! 1. ready-made with the active toolchain (`rustup target add`, or `rust-toolchain.toml`, has installed it),
//! 2. from the library sources of the active toolchain,
//! 3. from the library sources of the distribution's toolchain, where that is installed,
//! 4. the same from the distribution's packages, unpacked by [`crate::tools`].
//!
//! Each target goes its own way. For the firmware's, tools are fetched; for the other nothing is fetched that is not
//! there already, and where no toolchain builds for it, it is left out.

use crate::tools::Tool;

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
    /// The distribution's installed toolchain; all `false` where it is absent or older than the workspace allows.
    pub(crate) installed: Toolchain,
    /// The distribution's toolchain as it has been fetched before; all `false` where it has not.
    pub(crate) fetched: Toolchain,
    /// Some linker that knows the target.
    pub(crate) linker: bool,
}

/// Whose compiler is used, and where its core library for the target comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Route {
    /// The active toolchain with its compiled core library.
    Active,
    /// The active toolchain, core built from its sources.
    ActiveFromSource,
    /// The distribution's installed toolchain, core built from its sources.
    Installed,
    /// The distribution's toolchain under the target directory, core built from its sources.
    Fetched,
}

/// A route, and what is to be fetched for it. Each tool by itself: without the last ones there is still a compiler.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Plan {
    /// The route.
    pub(crate) route: Route,
    /// None on most machines.
    pub(crate) fetch: Vec<Tool>,
    /// Whether the route's clippy is there already.
    pub(crate) has_clippy: bool,
}

/// The first route that the facts allow.
pub(crate) fn plan(facts: Facts) -> Plan {
    let Facts {
        active,
        installed,
        fetched,
        linker,
    } = facts;
    let (route, toolchain) = if active.target_core {
        (Route::Active, active)
    } else if active.library_sources {
        (Route::ActiveFromSource, active)
    } else if installed.library_sources {
        (Route::Installed, installed)
    } else {
        (Route::Fetched, fetched)
    };
    let has_compiler = toolchain.target_core || toolchain.library_sources;
    // A compiler with a compiled core library brings its linker along.
    let has_linker = linker || route == Route::Active;
    // The distribution's clippy does not go with another's compiler.
    let may_fetch_clippy = matches!(route, Route::Installed | Route::Fetched);
    let fetch = [
        (!has_compiler).then_some(Tool::Compiler),
        (!has_linker).then_some(Tool::Linker),
        (!toolchain.clippy && may_fetch_clippy).then_some(Tool::Clippy),
    ];
    Plan {
        route,
        fetch: fetch.into_iter().flatten().collect(),
        has_clippy: toolchain.clippy,
    }
}

#[cfg(test)]
mod tests {
    use super::{Architecture::*, *};

    /// Each kind of machine: what its toolchains and the machine itself offer, the route, and what is fetched.
    const MACHINES: &str = "
        active         | installed      | fetched        | machine | route            | fetched now
        core clippy    |                |                |         | Active           |
        core clippy    | sources clippy | sources clippy | linker  | Active           |
        core           | sources clippy |                | linker  | Active           |
        sources clippy |                |                | linker  | ActiveFromSource |
        sources clippy | sources clippy |                |         | ActiveFromSource | Linker
        sources        | sources clippy |                | linker  | ActiveFromSource |
        clippy         | sources clippy |                | linker  | Installed        |
        clippy         | sources        |                | linker  | Installed        | Clippy
        clippy         | sources        |                |         | Installed        | Linker Clippy
        clippy         |                | sources clippy | linker  | Fetched          |
        clippy         |                | sources        | linker  | Fetched          | Clippy
        clippy         |                | clippy         | linker  | Fetched          | Compiler
        clippy         | clippy         |                | linker  | Fetched          | Compiler Clippy
                       |                |                |         | Fetched          | Compiler Linker Clippy";

    fn toolchain(offers: &str) -> Toolchain {
        Toolchain {
            target_core: offers.contains("core"),
            library_sources: offers.contains("sources"),
            clippy: offers.contains("clippy"),
        }
    }

    #[test]
    fn every_kind_of_machine_gets_its_route() {
        let rows = MACHINES.lines().skip(2);
        assert_eq!(rows.clone().count(), 14);
        for row in rows {
            let cells: Vec<_> = row.split('|').map(str::trim).collect();
            let facts = Facts {
                active: toolchain(cells[0]),
                installed: toolchain(cells[1]),
                fetched: toolchain(cells[2]),
                linker: cells[3].contains("linker"),
            };
            let Plan {
                route,
                fetch,
                has_clippy,
            } = plan(facts);
            let of_route = match route {
                Route::Active | Route::ActiveFromSource => facts.active,
                Route::Installed => facts.installed,
                Route::Fetched => facts.fetched,
            };
            assert_eq!(has_clippy, of_route.clippy, "{row}");
            let fetch: Vec<_> = fetch.iter().map(|tool| format!("{tool:?}")).collect();
            assert_eq!(
                (format!("{route:?}").as_str(), fetch.join(" ").as_str()),
                (cells[4], cells[5]),
                "{row}"
            );
        }
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
}
