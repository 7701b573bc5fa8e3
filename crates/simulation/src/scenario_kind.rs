//! Kinds of scenarios, told apart by their tables.

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;

/// Command for which a scenario is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ScenarioKind {
    /// `strip`, also `flight`.
    Strip,
    /// `mission`.
    Mission,
    /// `block`.
    Block,
}

impl ScenarioKind {
    const ALL: [Self; 3] = [Self::Strip, Self::Mission, Self::Block];

    /// Returns the error of a text that is read as this kind and is of another: `error`, if it is
    /// not.
    ///
    /// A mission has `[[vh]]`, a block `[block]`, a strip `[control]` without it.
    pub(crate) fn expected(self, file: &str, text: &TomlText<'_>, error: InputError) -> InputError {
        let is_of = |kind: &Self| match kind {
            Self::Mission => text.has(&["vh"]),
            Self::Block => text.has(&["block"]),
            Self::Strip => text.has(&["control"]) && !text.has(&["block"]),
        };
        let mut kinds = Self::ALL.into_iter().filter(is_of);
        match (kinds.next(), kinds.next()) {
            (Some(found), None) if found != self => InputError::invalid(format!(
                "{file}: is the scenario of a {}, which has {}; a {} has {}",
                found.name(),
                found.table(),
                self.name(),
                self.table()
            ))
            .with_help(found.help(self)),
            _ => error,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Strip => "strip",
            Self::Mission => "mission",
            Self::Block => "block",
        }
    }

    const fn table(self) -> &'static str {
        match self {
            Self::Strip => "[control]",
            Self::Mission => "[[vh]]",
            Self::Block => "[block]",
        }
    }

    const fn shipped(self) -> &'static str {
        match self {
            Self::Strip => "strip.toml",
            Self::Mission => "mission.toml",
            Self::Block => "block/ixm-50.toml",
        }
    }

    /// Returns the command of this kind, and the scenario of the kind that was wanted.
    fn help(self, wanted: Self) -> String {
        let runs = match self {
            Self::Strip => "`host-sim strip --scenario`, also called `flight`, simulates it",
            Self::Mission => "`host-sim mission --scenario` flies it",
            Self::Block => "`host-sim block --scenario` flies and adjusts it",
        };
        format!(
            "{runs}; host-sim/scenarios/{} is the scenario of a {}",
            wanted.shipped(),
            wanted.name()
        )
    }
}
