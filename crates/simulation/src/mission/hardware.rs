//! Hardware of a scenario, and what the camera's settings say of it.

use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::settings::EncoderSide;
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera_file::InputError;
use fmc_camera_file::flight_settings::FlightSettingsFile;
use fmc_camera_file::toml_text::TomlText;

use super::file::{DirectionName, MissionFile};
use crate::mechanics;

/// Largest relative difference between two numbers that are the same.
const SAME: f64 = 1e-6;

/// A number that scenario and settings both state.
struct Stated<'a> {
    scenario: [&'static str; 2],
    value: &'a mut f64,
    settings: &'static [&'static str],
    /// The setting in the scenario's unit.
    set: f64,
}

/// Gives the scenario the hardware that the settings describe, where it does not describe its own.
///
/// # Errors
/// [`InputError`] naming both values where the two contradict each other.
pub(super) fn agree(
    written: &mut MissionFile,
    file: &FlightSettingsFile,
    text: &TomlText,
) -> Result<FlightSettings, InputError> {
    let mut settings = file.settings;
    agree_on_kind(written, &settings, file, text)?;
    // The operator tells the camera its exposure and its direction, where the settings do not.
    if !file.has(&["exposure_s"]) {
        settings.exposure_s = fmc_camera_file::number::single(written.flight.exposure_s);
    }
    let direction = DirectionName::of(settings.direction);
    match written.flight.direction {
        Some(told) if told != direction && file.has(&["direction"]) => {
            return Err(contradicts(
                text,
                &["flight", "direction"],
                &format!("direction = \"{:?}\"", settings.direction),
                file,
            ));
        }
        Some(told) => settings.direction = told.direction(),
        None => written.flight.direction = Some(direction),
    }
    let side = match settings.drive.encoder_side {
        EncoderSide::Screw => mechanics::EncoderSide::Screw,
        EncoderSide::Stage => mechanics::EncoderSide::Stage,
    };
    if text.has(&["mechanics", "encoder_side"]) && written.mechanics.encoder_side != side {
        let what = format!("drive.encoder_side = {:?}", settings.drive.encoder_side);
        return Err(contradicts(
            text,
            &["mechanics", "encoder_side"],
            &what,
            file,
        ));
    }
    written.mechanics.encoder_side = side;
    // A screw may have another play than its setting: it wears.
    if !text.has(&["mechanics", "backlash_um"]) {
        written.mechanics.backlash_um = decimal(settings.drive.play_um);
    }
    agree_on_index(written, &settings, file, text)?;
    let velocity_loop = &settings.drive.velocity_loop;
    let stated = [
        Stated {
            scenario: ["flight", "exposure_s"],
            value: &mut written.flight.exposure_s,
            settings: &["exposure_s"],
            set: decimal(settings.exposure_s),
        },
        Stated {
            scenario: ["shutter", "latency_ms"],
            value: &mut written.shutter.latency_ms,
            settings: &["shutter_latency_s"],
            set: 1000.0 * decimal(settings.shutter_latency_s),
        },
        Stated {
            scenario: ["mechanics", "encoder_step_um"],
            value: &mut written.mechanics.encoder_step_um,
            settings: &["drive", "encoder_step_um"],
            set: decimal(settings.drive.encoder_step_um),
        },
        Stated {
            scenario: ["mechanics", "encoder_latency_s"],
            value: &mut written.mechanics.encoder_latency_s,
            settings: &["drive", "velocity_loop", "reading_age_s"],
            set: decimal(velocity_loop.reading_age_s),
        },
        Stated {
            scenario: ["mechanics", "duty_latency_s"],
            value: &mut written.mechanics.duty_latency_s,
            settings: &["drive", "velocity_loop", "duty_delay_s"],
            set: decimal(velocity_loop.duty_delay_s),
        },
        Stated {
            scenario: ["limits", "smear_px"],
            value: &mut written.limits.smear_px,
            settings: &["smear_budget_px"],
            set: decimal(settings.smear_budget_px),
        },
    ];
    for one in stated {
        let same = (*one.value - one.set).abs() <= SAME * one.set.abs();
        if text.has(&one.scenario) && !same {
            let what = format!("{} = {}", one.settings.join("."), one.set);
            return Err(contradicts(text, &one.scenario, &what, file));
        }
        if !same {
            *one.value = one.set;
        }
    }
    Ok(settings)
}

/// Refuses settings for another kind of drive than the scenario's. How far a command or a step
/// leads, the scenario may have otherwise than the settings: they do not know it better.
fn agree_on_kind(
    written: &MissionFile,
    settings: &FlightSettings,
    file: &FlightSettingsFile,
    text: &TomlText,
) -> Result<(), InputError> {
    let (kind, scenario) = (settings.drive.kind, written.mechanics.drive_kind());
    if kind == scenario {
        return Ok(());
    }
    let what = format!("drive.kind = \"{kind:?}\"");
    let named = |kind| match kind {
        DriveKind::Motor => None,
        DriveKind::PositionCommand => Some("position_stage"),
        DriveKind::Stepper => Some("stepper"),
    };
    if let Some(key) = named(scenario) {
        return Err(contradicts(text, &["mechanics", key], &what, file));
    }
    let key = named(kind).unwrap_or_default();
    let missing = format!("lacks {key}, for {what} of {}", file.name);
    Err(text.invalid(&["mechanics"], &missing))
}

/// Gives the scenario the index mark of the settings, where it does not describe its own.
fn agree_on_index(
    written: &mut MissionFile,
    settings: &FlightSettings,
    file: &FlightSettingsFile,
    text: &TomlText,
) -> Result<(), InputError> {
    let path = ["mechanics", "index_mm"];
    let mechanics = &mut written.mechanics;
    match settings.drive.index_mm.map(decimal) {
        Some(set_mm) => {
            let is_same = (mechanics.index_mm - set_mm).abs() <= SAME * set_mm.abs();
            if text.has(&path) && !is_same {
                let what = format!("drive.index_mm = {set_mm}");
                return Err(contradicts(text, &path, &what, file));
            }
            mechanics.index_mm = set_mm;
        }
        // A mark that the camera is not told of changes nothing.
        None => mechanics.has_index &= text.has(&path),
    }
    Ok(())
}

/// Refuses a trigger interval that is shorter than the settings say.
///
/// # Errors
/// [`InputError`] naming both.
pub(super) fn check_interval(
    interval_s: f64,
    settings: &FlightSettings,
    file: &FlightSettingsFile,
    text: &TomlText,
) -> Result<(), InputError> {
    let shortest_s = decimal(settings.trigger_interval_s);
    if interval_s >= shortest_s * (1.0 - SAME) {
        return Ok(());
    }
    let key = if text.has(&["flight", "interval_s"]) {
        "interval_s"
    } else {
        "forward_overlap_percent"
    };
    let what = format!("trigger_interval_s = {shortest_s}");
    Err(contradicts(text, &["flight", key], &what, file))
}

fn contradicts(
    text: &TomlText,
    path: &[&str],
    setting: &str,
    file: &FlightSettingsFile,
) -> InputError {
    text.invalid(path, &format!("contradicts {setting} of {}", file.name))
}

/// Converts a setting into the number that was written: the decimals of an f32.
fn decimal(setting: f32) -> f64 {
    setting.to_string().parse().unwrap_or(f64::from(setting))
}

impl DirectionName {
    /// Returns the name of a direction.
    pub(super) const fn of(direction: FlightDirection) -> Self {
        match direction {
            FlightDirection::Forward => Self::Forward,
            FlightDirection::Reverse => Self::Reverse,
        }
    }

    /// Returns the direction of a name.
    #[must_use]
    pub const fn direction(self) -> FlightDirection {
        match self {
            Self::Forward => FlightDirection::Forward,
            Self::Reverse => FlightDirection::Reverse,
        }
    }
}
