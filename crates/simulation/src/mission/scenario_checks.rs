//! Checks of a scenario: sources, line, stage, exposure and settings.

use fmc_camera::flight::camera::{Camera, FrameError};
use fmc_camera::flight::controller::{ControllerError, Start};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::geometry::range::Quantity;
use fmc_camera_file::number::single;
use fmc_camera_file::toml_text::TomlText;
use fmc_camera_file::{CameraFile, InputError};

use super::fault::line::Carried;
use super::file::{MissionFile, ReceiverFormat, VhSourceName};
use super::wire_load::{WireLoad, bytes_per_s};

/// Checks that there is a source of V/H, and each once.
pub(super) fn check_sources(written: &MissionFile, text: &TomlText) -> Result<(), InputError> {
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

/// Checks that the traffic of the line is known, that there is a receiver if one is to send
/// sentences, and that each wire carries its messages.
pub(super) fn check_line(written: &MissionFile, text: &TomlText) -> Result<(), InputError> {
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
    let load = WireLoad::of(written);
    for (key, baud, sent, senders) in [
        (
            "baud",
            written.line.baud,
            load.receiver,
            "sentences of the receiver at rate_hz of its sources",
        ),
        (
            "autopilot_baud",
            written.line.autopilot_baud,
            load.autopilot,
            "messages of the autopilot at attitude.reported_hz and rate_hz of the altimeter",
        ),
    ] {
        let carried = bytes_per_s(baud);
        if sent > carried {
            return Err(text.invalid(
                &["line", key],
                &format!(
                    "carries {carried:.0} bytes per second; the {senders} are {sent:.0} bytes per second"
                ),
            ));
        }
    }
    Ok(())
}

pub(super) fn check_mechanics(written: &MissionFile, text: &TomlText) -> Result<(), InputError> {
    match written.mechanics.checked() {
        Ok(_) => Ok(()),
        Err(fault) => Err(text.invalid(&["mechanics"], &format!("cannot be built: {fault}"))),
    }
}

/// Checks that the camera asks no more speed of a stepper than it has.
pub(super) fn check_stepper(
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

/// Checks that the camera can take the exposure.
pub(super) fn check_exposure(
    written: &MissionFile,
    camera: &CameraFile,
    checked: &Camera,
    text: &TomlText,
) -> Result<(), InputError> {
    let vh_per_s = written.vh_per_s();
    let [least, most] = camera.limits.vh_per_s;
    if !(least..=most).contains(&vh_per_s) {
        return Err(text.invalid(
            &["flight", "speed_m_s"],
            &format!(
                "over {} m of height is V/H = {vh_per_s:.4} 1/s; the camera file allows {least} to {most} 1/s ({})",
                written.flight.height_m - written.terrain.height_m,
                camera.limits.origin(Quantity::VhPerS, &written.camera.display())
            ),
        ));
    }
    let [least, most] = camera.limits.exposure_s;
    if !(least..=most).contains(&written.flight.exposure_s) {
        return Err(text.invalid(
            &["flight", "exposure_s"],
            &format!(
                "is out of range: the camera file allows {least} to {most} s ({})",
                camera
                    .limits
                    .origin(Quantity::ExposureS, &written.camera.display())
            ),
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
pub(super) fn check_settings(
    written: &MissionFile,
    camera: Camera,
    settings: &FlightSettings,
    text: &TomlText,
) -> Result<(), InputError> {
    let Err(refused) = PreparedCamera::new(camera, settings, Start::Orderly) else {
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
