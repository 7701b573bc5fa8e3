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
}

impl ScenarioKind {
    /// Returns the error of a text that is read as this kind and is of the other: `error`, if it is
    /// not.
    ///
    /// A mission has `[[vh]]`, a strip `[control]`; no other kind has either.
    pub(crate) fn expected(self, file: &str, text: &TomlText<'_>, error: InputError) -> InputError {
        let tables = ["vh", "control"].map(|table| text.has(&[table]));
        match (self, tables) {
            (Self::Strip, [true, false]) => InputError::invalid(format!(
                "{file}: is the scenario of a mission, which has [[vh]]; a strip has [control]"
            ))
            .with_help("`host-sim mission --scenario` flies it; host-sim/scenarios/strip.toml is the scenario of a strip"),
            (Self::Mission, [false, true]) => InputError::invalid(format!(
                "{file}: is the scenario of a strip, which has [control]; a mission has [[vh]]"
            ))
            .with_help("`host-sim strip --scenario`, also called `flight`, simulates it; host-sim/scenarios/mission.toml is the scenario of a mission"),
            _ => error,
        }
    }
}
