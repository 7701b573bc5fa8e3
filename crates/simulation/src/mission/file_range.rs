//! Allowed ranges of the numbers of a mission.

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;

use super::file::MissionFile;
use crate::range::{
    EXPOSURE, FLYING_HEIGHT, RELIEF, Range, Ranged as _, SPEED, TERRAIN_HEIGHT, WAVELENGTH, check,
    check_clearance, range,
};

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
const BAUD: Range = range(1200.0, 115_200.0, "bits per second");
const SHUTTER_LATENCY: Range = range(0.0, 100.0, "ms");
const SHUTTER_JITTER: Range = range(0.0, 1000.0, "µs");
const STAMP_JITTER: Range = range(0.0, 1000.0, "µs");
const CLOCK_DRIFT: Range = range(-150.0, 150.0, "ppm");
const CLOCK_WANDER: Range = range(0.0, 20.0, "ppm");
const CLOCK_CORNER: Range = range(0.0001, 1.0, "Hz");
const SEED: Range = range(0.0, 2_147_483_647.0, "");
const UNIX_S: Range = range(0.0, 2_147_483_647.0, "s since 1970");
const RUN_OUT: Range = range(-1000.0, 1000.0, "µm");
const TEMPERATURE: Range = range(-100.0, 100.0, "°C");
const TEMPERATURE_RATE: Range = range(-10.0, 10.0, "°C/s");
const TOLD_EVERY: Range = range(0.0, 10_000.0, "s");
const FOCUS_LIMIT: Range = range(0.001, 1000.0, "µm");
const PIXELS: Range = range(0.001, 100.0, "px");

/// Refuses the first number of the mission that is out of its range; faults and mechanics are
/// checked elsewhere.
pub(super) fn check_numbers(mission: &MissionFile, text: &TomlText) -> Result<(), InputError> {
    let MissionFile {
        flight,
        air,
        attitude,
        terrain,
        line,
        clock,
        shutter,
        detector,
        limits,
        ..
    } = mission;
    check!(text:
        flight.height_m FLYING_HEIGHT,
        flight.speed_m_s SPEED,
        flight.exposure_s EXPOSURE,
        flight.exposures EXPOSURES,
        flight.forward_overlap_percent OVERLAP,
        flight.interval_s INTERVAL,
        flight.first_trigger_s FIRST_TRIGGER,
        flight.clear_faults_after_s CLEARED_AFTER,
        air.gust_rms_m_s GUST,
        air.gust_corner_hz GUST_CORNER,
        attitude.pitch_deg ANGLE,
        attitude.roll_deg ANGLE,
        attitude.drift_deg ANGLE,
        attitude.rate_rms_deg_s RATE,
        attitude.rate_corner_hz RATE_CORNER,
        attitude.reported_hz REPORTED,
        terrain.height_m TERRAIN_HEIGHT,
        terrain.relief_m RELIEF,
        terrain.wavelength_m WAVELENGTH,
        line.baud BAUD,
        line.autopilot_baud BAUD,
        shutter.latency_ms SHUTTER_LATENCY,
        shutter.jitter_us SHUTTER_JITTER,
        shutter.stamp_jitter_us STAMP_JITTER,
        clock.drift_ppm CLOCK_DRIFT,
        clock.wander_ppm CLOCK_WANDER,
        clock.wander_corner_hz CLOCK_CORNER,
        detector.run_out_um RUN_OUT,
        limits.pp_error_px PIXELS,
        limits.smear_px PIXELS,
    );
    for (index, sensor) in mission.vh.iter().enumerate() {
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
        check!(text: gnss.first_pulse_unix_s UNIX_S, gnss.pulse_jitter_us STAMP_JITTER);
    }
    if let Some(temperature) = &mission.temperature {
        check!(text:
            temperature.start_c TEMPERATURE,
            temperature.rate_c_per_s TEMPERATURE_RATE,
            temperature.told_every_s TOLD_EVERY,
            temperature.focus_shift_um RUN_OUT,
            temperature.limit_um FOCUS_LIMIT,
        );
    }
    mission.seed.check(SEED, text, &["seed"])?;
    check_clearance(text, flight.height_m, terrain.height_m, terrain.relief_m)
}
