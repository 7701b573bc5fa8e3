//! Choice of the toolchain that builds for a target: only the decision, a pure function of facts
//! about the machine.
//!
//! A target needs a compiled core library. In order of preference it comes
//! 1. ready-made with the active toolchain (`rustup target add`, or `rust-toolchain.toml`, has
//!    installed it),
//! 2. from the library sources of the active toolchain,
//! 3. from the library sources of the distribution's toolchain, if that is installed,
//! 4. from the same sources of the distribution's packages, unpacked by [`crate::tools`].
//!
//! The decision is made for each target separately. Tools are fetched only for the firmware's
//! target; the other one is left out if the toolchains that are present cannot build for it.

use crate::tools::Tool;

/// Architecture of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Architecture {
    /// Armv7E-M with hardware floating point: Cortex-M4F and M7, the firmware's target.
    Armv7em,
    /// Armv7E-M with floating point in software, for the C library.
    Armv7emSoft,
    /// Armv8-M with hardware floating point: Cortex-M33, for the C library.
    Armv8m,
    /// Armv8.1-M with vectors of four numbers (Helium): Cortex-M55.
    Helium,
}

impl Architecture {
    /// Returns the compiler's name of the target.
    pub(crate) fn target(self) -> &'static str {
        match self {
            Self::Armv7em => "thumbv7em-none-eabihf",
            Self::Armv7emSoft => "thumbv7em-none-eabi",
            Self::Armv8m | Self::Helium => "thumbv8m.main-none-eabihf",
        }
    }

    /// Returns the processor to compile for, if the target's name does not determine it.
    pub(crate) fn processor(self) -> Option<&'static str> {
        match self {
            Self::Armv7em | Self::Armv7emSoft | Self::Armv8m => None,
            Self::Helium => Some("cortex-m55"),
        }
    }

    /// Returns cargo's variable for a setting of the target: `LINKER`, `RUSTFLAGS`.
    pub(crate) fn variable(self, setting: &str) -> String {
        let target = self.target().replace(['-', '.'], "_").to_uppercase();
        format!("CARGO_TARGET_{target}_{setting}")
    }
}

/// Parts that one toolchain has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Toolchain {
    /// `true` with the target's compiled core library.
    pub(crate) target_core: bool,
    /// `true` with the sources of the standard library.
    pub(crate) library_sources: bool,
    /// `true` with clippy.
    pub(crate) clippy: bool,
}

/// Facts on which the decision for one target is based.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Facts {
    /// Toolchain that runs xtask.
    pub(crate) active: Toolchain,
    /// Distribution's installed toolchain; all `false` if it is absent or older than the workspace
    /// allows.
    pub(crate) installed: Toolchain,
    /// Distribution's toolchain that has been fetched before; all `false` if it has not.
    pub(crate) fetched: Toolchain,
    /// `true` if some linker knows the target.
    pub(crate) linker: bool,
}

/// Origin of the compiler and of its core library for the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Route {
    /// Active toolchain with its compiled core library.
    Active,
    /// Active toolchain, core built from its sources.
    ActiveFromSource,
    /// Distribution's installed toolchain, core built from its sources.
    Installed,
    /// Distribution's toolchain under the target directory, core built from its sources.
    Fetched,
}

/// A route, and the tools to be fetched for it. Each tool is fetched separately: without the last
/// ones there is still a compiler.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Plan {
    /// Route.
    pub(crate) route: Route,
    /// Tools to be fetched; none on most machines.
    pub(crate) fetch: Vec<Tool>,
    /// `true` if the route's clippy is already present.
    pub(crate) has_clippy: bool,
}

/// Chooses the first route that the facts allow.
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
    // A compiler with a compiled core library includes a linker.
    let has_linker = linker || route == Route::Active;
    // The distribution's clippy does not work with another's compiler.
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

    /// Kinds of machines: what the toolchains and the machine itself offer, the route, and what is
    /// fetched.
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
