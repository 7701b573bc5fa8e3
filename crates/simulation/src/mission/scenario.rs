//! Validated scenario of a mission, with its camera and its faults.

use std::path::Path;

use fmc_camera::flight::camera::{Camera, FrameError};
use fmc_camera::flight::controller::{Controller, ControllerError, Start};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::geometry::range::Quantity;
use fmc_camera_file::flight_settings::FlightSettingsFile;
use fmc_camera_file::number::single;
use fmc_camera_file::toml_text::TomlText;
use fmc_camera_file::{CameraFile, InputError};

use super::fault::Injection;
use super::fault::line::Carried;
use super::file::{MissionFile, ReceiverFormat, VhSourceName};
use super::file_range;
use super::hardware;
use super::planned_fault::{self, PlannedFault};
use super::settings::flight_settings;

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
            CameraFile::parse("cameras/mission.toml", NOMINAL_CAMERA)
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
        let bytes = std::fs::read(path).map_err(|error| InputError::reading(path, &error))?;
        let text = String::from_utf8(bytes).map_err(|_| {
            InputError::invalid(format!("{}: not a text file (UTF-8)", path.display()))
        })?;
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
            let path = folder.join(camera);
            if path.is_file() {
                Ok(CameraFile::read(&path)?)
            } else {
                let written = TomlText::new(file, text);
                Err(written.invalid(
                    &["camera"],
                    &format!("names a camera file, {}, that is not there", path.display()),
                ))
            }
        })
    }

    /// Parses and validates a scenario whose camera file need not be on the disk.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse_of_texts(
        file: &str,
        text: &str,
        camera_of: impl FnOnce(&Path) -> Result<(CameraFile, Camera), InputError>,
    ) -> Result<Self, InputError> {
        Self::parse_with(file, text, None, None, camera_of)
    }

    fn parse_with(
        file: &str,
        text: &str,
        exposures: Option<u32>,
        settings: Option<FlightSettingsFile>,
        camera_of: impl FnOnce(&Path) -> Result<(CameraFile, Camera), InputError>,
    ) -> Result<Self, InputError> {
        let text = TomlText::new(file, text);
        let mut written: MissionFile = text.deserialize()?;
        if let Some(exposures) = exposures {
            written.flight.exposures = i64::from(exposures);
        }
        if written.name.trim().is_empty() || written.name.contains(char::is_control) {
            return Err(text.invalid(&["name"], "is empty or holds a control character"));
        }
        file_range::check_numbers(&written, &text)?;
        check_sources(&written, &text)?;
        check_line(&written, &text)?;
        check_mechanics(&written, &text)?;
        let (camera, checked) = camera_of(&written.camera)?;
        let given = settings_of(&written, settings, &text)?;
        let settings = match &given {
            Some(file) => Some(hardware::agree(&mut written, file, &text)?),
            None => None,
        };
        check_stepper(&written, &camera, &text)?;
        let interval_s = interval_s(&written, &camera, &text)?;
        if let (Some(file), Some(settings)) = (&given, &settings) {
            hardware::check_interval(interval_s, settings, file, &text)?;
        }
        check_exposure(&written, &camera, &checked, &text)?;
        let flown = settings.unwrap_or_else(|| flight_settings(&written, interval_s));
        check_settings(&written, &camera, &flown, &text)?;
        let faults = planned_fault::planned(&written, interval_s, &text)?;
        Ok(Self {
            file: file.to_owned(),
            written,
            camera,
            checked,
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
        vh_per_s(&self.written)
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

fn vh_per_s(written: &MissionFile) -> f64 {
    written.flight.speed_m_s / (written.flight.height_m - written.terrain.height_m)
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

fn check_sources(written: &MissionFile, text: &TomlText) -> Result<(), InputError> {
    if written.vh.is_empty() {
        return Err(text.invalid(&["vh"], "is empty; the camera needs a source of V/H"));
    }
    for (index, sensor) in written.vh.iter().enumerate() {
        if written
            .vh
            .iter()
            .take(index)
            .any(|earlier| earlier.source == sensor.source)
        {
            return Err(text.invalid(
                &["vh", &index.to_string(), "source"],
                "is a source that an earlier [[vh]] has already",
            ));
        }
    }
    Ok(())
}

/// Checks that the traffic of the line is known, and that there is a receiver if one is to send
/// sentences.
fn check_line(written: &MissionFile, text: &TomlText) -> Result<(), InputError> {
    for name in written.line.carries.iter().flatten() {
        if Carried::named(name).is_none() {
            let sources = VhSourceName::ALL.map(VhSourceName::name);
            return Err(text.invalid(
                &["line", "carries"],
                &format!(
                    "holds \"{name}\"; there are {}, and of single sources {}",
                    Carried::NAMES.join(", "),
                    sources.join(", ")
                ),
            ));
        }
    }
    let has_receiver = written.vh.iter().any(|table| table.source.has_receiver());
    if written.line.receiver == ReceiverFormat::Nmea && !has_receiver {
        return Err(text.invalid(
            &["line", "receiver"],
            "speaks of a receiver, which only the sources altimeter and terrain have",
        ));
    }
    Ok(())
}

fn check_mechanics(written: &MissionFile, text: &TomlText) -> Result<(), InputError> {
    match written.mechanics.checked() {
        Ok(_) => Ok(()),
        Err(fault) => Err(text.invalid(&["mechanics"], &format!("cannot be built: {fault}"))),
    }
}

/// Checks that the camera asks no more speed of a stepper than it has.
fn check_stepper(
    written: &MissionFile,
    camera: &CameraFile,
    text: &TomlText,
) -> Result<(), InputError> {
    let Some(stepper) = &written.mechanics.stepper else {
        return Ok(());
    };
    let fastest_mm_s = stepper.max_step_rate_hz / stepper.steps_per_mm;
    let allowed_mm_s = camera.fmc.max_speed_mm_s;
    if allowed_mm_s > 0.0 && allowed_mm_s <= fastest_mm_s {
        return Ok(());
    }
    let allowed = if allowed_mm_s > 0.0 {
        format!("max_speed_mm_s = {allowed_mm_s}")
    } else {
        "no max_speed_mm_s".to_owned()
    };
    Err(text.invalid(
        &["mechanics", "stepper"],
        &format!("makes at most {fastest_mm_s} mm/s; the camera file has {allowed}"),
    ))
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
            let covered_s = along_mm / camera.principal_distance_mm / vh_per_s(written);
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

/// Checks that the camera can take the exposure.
fn check_exposure(
    written: &MissionFile,
    camera: &CameraFile,
    checked: &Camera,
    text: &TomlText,
) -> Result<(), InputError> {
    let vh_per_s = vh_per_s(written);
    let [least, most] = camera.limits.vh_per_s;
    if !(least..=most).contains(&vh_per_s) {
        return Err(text.invalid(
            &["flight", "speed_m_s"],
            &format!(
                "over {} m of height is V/H = {vh_per_s:.4} 1/s; the camera file allows {least} to {most} 1/s",
                written.flight.height_m - written.terrain.height_m
            ),
        ));
    }
    let [least, most] = camera.limits.exposure_s;
    if !(least..=most).contains(&written.flight.exposure_s) {
        return Err(text.invalid(
            &["flight", "exposure_s"],
            &format!("is out of range: the camera file allows {least} to {most} s"),
        ));
    }
    let mut exposure = Exposure::new(single(vh_per_s), single(written.flight.exposure_s));
    if let Some(direction) = written.flight.direction {
        exposure.direction = direction.direction();
    }
    match checked.plan(&exposure) {
        Ok(_) => Ok(()),
        Err(error @ FrameError::Stroke(_)) => Err(text.invalid(
            &["flight", "exposure_s"],
            &format!("cannot be compensated: {error}"),
        )),
        Err(error) => Err(text.invalid(&["camera"], &format!("refuses the exposure: {error}"))),
    }
}

/// Checks that the camera accepts its settings and has enough time between triggers.
fn check_settings(
    written: &MissionFile,
    camera: &CameraFile,
    settings: &FlightSettings,
    text: &TomlText,
) -> Result<(), InputError> {
    let Err(refused) = Controller::new(&camera.parameters(), 0, settings, Start::Orderly) else {
        return Ok(());
    };
    let (path, fault): (&[&str], String) = match refused {
        ControllerError::Travel(FrameError::Time {
            needed_s,
            available_s,
        }) => {
            let key = if written.flight.interval_s.is_some() {
                "interval_s"
            } else {
                "forward_overlap_percent"
            };
            return Err(text.invalid(
                &["flight", key],
                &format!(
                    "triggers every {:.1} ms; run-up, exposure, stop and fly-back take {:.1} ms at the largest V/H of the camera file, so that triggers would overlap",
                    1e3 * available_s,
                    1e3 * needed_s
                ),
            ));
        }
        ControllerError::Travel(error) => (
            &["camera"],
            format!("cannot be flown at the largest V/H of its limits: {error}"),
        ),
        ControllerError::Calibration(error) => (&["camera"], error.to_string()),
        ControllerError::Settings(error) => (setting_path(error.quantity), error.to_string()),
    };
    Err(text.invalid(path, &format!("is refused by the camera: {fault}")))
}

/// Returns the path in the scenario of a setting of the camera.
const fn setting_path(setting: Quantity) -> &'static [&'static str] {
    match setting {
        Quantity::ExposureS => &["flight", "exposure_s"],
        Quantity::SmearBudgetPx => &["limits", "smear_px"],
        Quantity::ShutterLatencyS => &["shutter", "latency_ms"],
        Quantity::TriggerIntervalS => &["flight", "interval_s"],
        Quantity::EncoderStepUm => &["mechanics", "encoder_step_um"],
        Quantity::ReadingAgeS => &["mechanics", "encoder_latency_s"],
        Quantity::DutyDelayS => &["mechanics", "duty_latency_s"],
        Quantity::VhPerS
        | Quantity::GroundSpeedMS
        | Quantity::HeightAboveGroundM
        | Quantity::AltitudeM
        | Quantity::TerrainHeightM
        | Quantity::SourcePeriodS
        | Quantity::SourceValidityS
        | Quantity::SourceSlew
        | Quantity::SourceSigma
        | Quantity::SourceFrozenS
        | Quantity::DisagreementPercent => &["vh"],
        _ => &["mechanics"],
    }
}
