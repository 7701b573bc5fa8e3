//! Allowed ranges of a mission's numbers.

use super::camera_error::CameraText;
use super::mission_file::MissionFile;
use super::scenario_range::{
    EXPOSURE, FLYING_HEIGHT, RELIEF, Range, SPEED, TERRAIN_HEIGHT, WAVELENGTH, range, whole,
};
use crate::failure::Failure;

const EXPOSURES: Range = range(1.0, 100_000.0, "exposures");
const OVERLAP: Range = range(0.0, 99.0, "%");
const INTERVAL: Range = range(0.02, 1000.0, "s");
const FIRST_TRIGGER: Range = range(0.5, 1000.0, "s");
const CLEARED_AFTER: Range = range(0.01, 1000.0, "s");
const GUST: Range = range(0.0, 20.0, "m/s");
const GUST_CORNER: Range = range(0.001, 2.0, "Hz");
const ANGLE: Range = range(-30.0, 30.0, "°");
const RATE: Range = range(0.0, 60.0, "°/s");
const RATE_CORNER: Range = range(0.01, 20.0, "Hz");
const REPORTED: Range = range(0.0, 200.0, "Hz");
const SENSOR_RATE: Range = range(0.1, 200.0, "Hz");
const SENSOR_SIGMA: Range = range(0.0, 20.0, "%");
const SENSOR_LATENCY: Range = range(0.0, 2000.0, "ms");
const SHUTTER_LATENCY: Range = range(0.0, 100.0, "ms");
const SHUTTER_JITTER: Range = range(0.0, 1000.0, "µs");
const UNIX_S: Range = range(0.0, 2_147_483_647.0, "s since 1970");
const PIXELS: Range = range(0.001, 100.0, "px");

/// Refuses the first number of the mission that is out of its range; faults and mechanics apart.
pub(super) fn check_numbers(mission: &MissionFile, text: &CameraText) -> Result<(), Failure> {
    let MissionFile {
        flight,
        air,
        attitude,
        terrain,
        vh,
        shutter,
        limits,
        ..
    } = mission;
    for (range, value, table, key) in [
        (FLYING_HEIGHT, flight.height_m, "flight", "height_m"),
        (SPEED, flight.speed_m_s, "flight", "speed_m_s"),
        (EXPOSURE, flight.exposure_s, "flight", "exposure_s"),
        (EXPOSURES, whole(flight.exposures), "flight", "exposures"),
        (
            FIRST_TRIGGER,
            flight.first_trigger_s,
            "flight",
            "first_trigger_s",
        ),
        (GUST_CORNER, air.gust_corner_hz, "air", "gust_corner_hz"),
        (ANGLE, attitude.pitch_deg, "attitude", "pitch_deg"),
        (ANGLE, attitude.roll_deg, "attitude", "roll_deg"),
        (ANGLE, attitude.drift_deg, "attitude", "drift_deg"),
        (
            RATE_CORNER,
            attitude.rate_corner_hz,
            "attitude",
            "rate_corner_hz",
        ),
        (REPORTED, attitude.reported_hz, "attitude", "reported_hz"),
        (TERRAIN_HEIGHT, terrain.height_m, "terrain", "height_m"),
        (RELIEF, terrain.relief_m, "terrain", "relief_m"),
        (WAVELENGTH, terrain.wavelength_m, "terrain", "wavelength_m"),
        (SHUTTER_LATENCY, shutter.latency_ms, "shutter", "latency_ms"),
        (SHUTTER_JITTER, shutter.jitter_us, "shutter", "jitter_us"),
        (PIXELS, limits.pp_error_px, "limits", "pp_error_px"),
        (PIXELS, limits.smear_px, "limits", "smear_px"),
    ] {
        range.check(value, text, &[table, key])?;
    }
    for (range, value, key) in [
        (
            OVERLAP,
            flight.forward_overlap_percent,
            "forward_overlap_percent",
        ),
        (INTERVAL, flight.interval_s, "interval_s"),
        (
            CLEARED_AFTER,
            flight.clear_faults_after_s,
            "clear_faults_after_s",
        ),
    ] {
        if let Some(value) = value {
            range.check(value, text, &["flight", key])?;
        }
    }
    GUST.check_each(&air.gust_rms_m_s, text, &["air", "gust_rms_m_s"])?;
    RATE.check_each(
        &attitude.rate_rms_deg_s,
        text,
        &["attitude", "rate_rms_deg_s"],
    )?;
    for (index, sensor) in vh.iter().enumerate() {
        let index = index.to_string();
        for (range, value, key) in [
            (SENSOR_RATE, sensor.rate_hz, "rate_hz"),
            (SENSOR_SIGMA, sensor.sigma_percent, "sigma_percent"),
            (SENSOR_LATENCY, sensor.latency_ms, "latency_ms"),
        ] {
            range.check(value, text, &["vh", index.as_str(), key])?;
        }
    }
    if let Some(gnss) = &mission.gnss {
        UNIX_S.check(
            whole(gnss.first_pulse_unix_s),
            text,
            &["gnss", "first_pulse_unix_s"],
        )?;
    }
    if flight.height_m <= terrain.height_m + terrain.relief_m {
        return Err(text.invalid(
            &["terrain", "height_m"],
            &format!(
                "with relief_m = {} reaches the aircraft at {} m",
                terrain.relief_m, flight.height_m
            ),
        ));
    }
    Ok(())
}
