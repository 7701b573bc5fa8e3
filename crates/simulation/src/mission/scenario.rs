//! Validated scenario of a mission, with its camera and its faults.

use std::path::Path;

use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera_file::flight_settings::FlightSettingsFile;
use fmc_camera_file::toml_text::TomlText;
use fmc_camera_file::{CameraFile, GridFiles, InputError};

use super::fault::Injection;
use super::fault::line::Carried;
use super::file::MissionFile;
use super::file_range;
use super::hardware;
use super::planned_fault::{self, PlannedFault};
use super::scenario_checks as checks;
use super::settings::flight_settings;
use crate::scenario_kind::ScenarioKind;
use crate::scenario_text;

/// The nominal mission, which is part of the program.
const NOMINAL: &str = include_str!("../../../../host-sim/scenarios/mission.toml");
const NOMINAL_CAMERA: &str = include_str!("../../../../host-sim/scenarios/cameras/mission.toml");

/// A validated mission.
#[derive(Debug, Clone)]
pub struct MissionScenario {
    /// File name that messages use.
    pub file: String,
    /// The scenario as written; `flight.exposures` is the number that is flown.
    pub written: MissionFile,
    /// Camera file.
    pub camera: CameraFile,
    /// Validated camera of the camera file.
    pub checked: Camera,
    /// Its residual grids.
    pub grids: GridFiles,
    /// Settings of the camera; `None` for those that follow from the scenario's hardware.
    pub settings: Option<FlightSettings>,
    /// Interval between triggers, s.
    pub interval_s: f64,
    /// Faults with their expected outcomes.
    pub faults: Vec<PlannedFault>,
}

impl MissionScenario {
    /// Returns the nominal mission, which is part of the program, with its own or another number of
    /// exposures.
    ///
    /// # Errors
    /// [`InputError`] if it cannot be flown with so many exposures.
    pub fn nominal(exposures: Option<u32>) -> Result<Self, InputError> {
        Self::nominal_with(exposures, None)
    }

    /// Returns the nominal mission of a camera with these settings.
    ///
    /// # Errors
    /// [`InputError`] if it cannot be flown so, or if settings and scenario contradict each other.
    pub fn nominal_with(
        exposures: Option<u32>,
        settings: Option<FlightSettingsFile>,
    ) -> Result<Self, InputError> {
        Self::parse_with("mission.toml", NOMINAL, exposures, settings, |_| {
            let (file, camera) = CameraFile::parse("cameras/mission.toml", NOMINAL_CAMERA)?;
            Ok((file, camera, GridFiles::default()))
        })
    }

    /// Reads and validates a scenario and the camera file it names.
    ///
    /// # Errors
    /// [`InputError`] naming file, line, field, value and allowed range.
    pub fn read(path: &Path, exposures: Option<u32>) -> Result<Self, InputError> {
        Self::read_with(path, exposures, None)
    }

    /// Reads and validates a scenario whose camera has these settings, in place of those that
    /// follow from the scenario's hardware.
    ///
    /// # Errors
    /// As [`Self::read`], and if settings and scenario contradict each other.
    pub fn read_with(
        path: &Path,
        exposures: Option<u32>,
        settings: Option<FlightSettingsFile>,
    ) -> Result<Self, InputError> {
        let text = scenario_text::read(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(
            &path.display().to_string(),
            &text,
            folder,
            exposures,
            settings,
        )
    }

    /// Parses and validates a scenario. `file` is the name that messages use for the text, `folder`
    /// the one in which a relative camera file is looked for; `exposures` replaces the number in
    /// the scenario, `settings` its table of that name.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(
        file: &str,
        text: &str,
        folder: &Path,
        exposures: Option<u32>,
        settings: Option<FlightSettingsFile>,
    ) -> Result<Self, InputError> {
        Self::parse_with(file, text, exposures, settings, |camera| {
            let path = scenario_text::camera_path(&TomlText::new(file, text), folder, camera)?;
            CameraFile::read_with_grids(&path)
        })
    }

    /// Parses and validates a scenario whose camera file need not be on the disk and has
    /// no residual grids.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse_of_texts(
        file: &str,
        text: &str,
        camera_of: impl FnOnce(&Path) -> Result<(CameraFile, Camera), InputError>,
    ) -> Result<Self, InputError> {
        Self::parse_with(file, text, None, None, |path| {
            let (camera_file, camera) = camera_of(path)?;
            Ok((camera_file, camera, GridFiles::default()))
        })
    }

    fn parse_with(
        file: &str,
        text: &str,
        exposures: Option<u32>,
        settings: Option<FlightSettingsFile>,
        camera_of: impl FnOnce(&Path) -> Result<(CameraFile, Camera, GridFiles), InputError>,
    ) -> Result<Self, InputError> {
        let text = TomlText::new(file, text);
        let mut written: MissionFile = text
            .deserialize()
            .map_err(|error| ScenarioKind::Mission.expected(file, &text, error))?;
        if let Some(exposures) = exposures {
            written.flight.exposures = i64::from(exposures);
        }
        if written.name.trim().is_empty() || written.name.contains(char::is_control) {
            return Err(text.invalid(&["name"], "is empty or holds a control character"));
        }
        file_range::check_numbers(&written, &text)?;
        checks::check_sources(&written, &text)?;
        checks::check_line(&written, &text)?;
        checks::check_mechanics(&written, &text)?;
        let (mut camera, mut checked, grids) = camera_of(&written.camera)?;
        let given = settings_of(&written, settings, &text)?;
        let settings = match &given {
            Some(file) => Some(hardware::agree(&mut written, file, &text)?),
            None => None,
        };
        checks::check_stepper(&written, &camera, &text)?;
        let interval_s = interval_s(&written, &camera, &text)?;
        if let (Some(file), Some(settings)) = (&given, &settings) {
            hardware::check_interval(interval_s, settings, file, &text)?;
        }
        checks::check_exposure(&written, &camera, &checked, &text)?;
        let flown = settings.unwrap_or_else(|| flight_settings(&written, interval_s));
        if camera.limits.is_vh_default() {
            // The mission's own V/H must be flown, whatever the mechanism says to it.
            let most = f64::from(camera.flown(&flown).limits.vh_per_s[1]).max(written.vh_per_s());
            camera.limits.vh_per_s[1] = most;
            checked = Camera::new(camera.parameters())
                .map_err(|error| text.invalid(&["camera"], &error.to_string()))?;
        }
        checks::check_settings(&written, checked.clone(), &flown, &text)?;
        let faults = planned_fault::planned(&written, interval_s, &text)?;
        Ok(Self {
            file: file.to_owned(),
            written,
            camera,
            checked,
            grids,
            settings,
            interval_s,
            faults,
        })
    }

    /// Returns the settings of the camera.
    #[must_use]
    pub fn flight_settings(&self) -> FlightSettings {
        self.settings
            .unwrap_or_else(|| flight_settings(&self.written, self.interval_s))
    }

    /// Returns the scenario's own seed.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.written
            .seed
            .and_then(|seed| u64::try_from(seed).ok())
            .unwrap_or(1)
    }

    /// Creates the error of a field: file, field and fault.
    #[must_use]
    pub fn fault(&self, field: &str, fault: impl std::fmt::Display) -> InputError {
        InputError::invalid(format!("{}: {field}: {fault}", self.file))
    }

    /// Returns the injections without their expected outcomes.
    #[must_use]
    pub fn injections(&self) -> Vec<Injection> {
        self.faults.iter().map(|fault| fault.injection).collect()
    }

    /// η: ground speed over the height above the mean terrain, 1/s.
    #[must_use]
    pub fn vh_per_s(&self) -> f64 {
        self.written.vh_per_s()
    }

    /// Returns the traffic of the serial line.
    #[must_use]
    pub fn carried(&self) -> Carried {
        match &self.written.line.carries {
            Some(names) => Carried::of_names(names.iter().map(String::as_str)),
            None => Carried::everything(),
        }
    }

    /// Number of exposures.
    #[must_use]
    pub fn exposures(&self) -> u32 {
        u32::try_from(self.written.flight.exposures).unwrap_or(0)
    }

    /// Returns the times of the regular triggers, s.
    pub fn triggers_s(&self) -> impl Iterator<Item = f64> {
        let (first, interval) = (self.written.flight.first_trigger_s, self.interval_s);
        (0..self.exposures()).map(move |frame| first + f64::from(frame) * interval)
    }
}

/// Returns the settings that the command or the scenario gives; not both may.
fn settings_of(
    written: &MissionFile,
    given: Option<FlightSettingsFile>,
    text: &TomlText,
) -> Result<Option<FlightSettingsFile>, InputError> {
    match (given, &written.settings) {
        (Some(given), Some(_)) => Err(text.invalid_table(
            "settings",
            &format!(
                "the scenario has settings of its own, beside {}",
                given.name
            ),
        )),
        (given, None) => Ok(given),
        (None, Some(table)) => FlightSettingsFile::of_table("[settings]".to_owned(), table.clone())
            .map(Some)
            .map_err(|what| text.invalid_table("settings", &what)),
    }
}

/// Returns the interval between triggers: as written, or from the overlap of the images along the
/// flight.
fn interval_s(
    written: &MissionFile,
    camera: &CameraFile,
    text: &TomlText,
) -> Result<f64, InputError> {
    match (
        written.flight.interval_s,
        written.flight.forward_overlap_percent,
    ) {
        (Some(interval_s), None) => Ok(interval_s),
        (None, Some(overlap)) => {
            let [half_x, half_y] = camera.half_format_mm();
            let [ex, _] = camera.fmc.axis.unit();
            let along_mm = 2.0 * if ex.abs() > 0.5 { half_x } else { half_y };
            let covered_s = along_mm / camera.principal_distance_mm / written.vh_per_s();
            Ok(covered_s * (1.0 - overlap / 100.0))
        }
        (Some(_), Some(_)) => Err(text.invalid(
            &["flight", "interval_s"],
            "contradicts forward_overlap_percent: give one of them",
        )),
        (None, None) => Err(text.invalid(
            &["flight", "exposures"],
            "needs interval_s (0.02 to 1000 s) or forward_overlap_percent (0 to 99 %)",
        )),
    }
}
