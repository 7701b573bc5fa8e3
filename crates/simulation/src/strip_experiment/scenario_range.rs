//! Allowed ranges of a scenario's numbers.

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;

use super::scenario_file::{ScenarioFile, Sigma};
use crate::range::{
    EXPOSURE, FLYING_HEIGHT, RELIEF, Range, SPEED, TERRAIN_HEIGHT, WAVELENGTH, range, whole,
};

/// Coordinate in the ground frame.
pub(super) const PLACE: Range = range(-1e6, 1e6, "m");
const HEADING: Range = range(-360.0, 360.0, "°");
const FRAMES: Range = range(1.0, 200.0, "frames");
const BASE: Range = range(0.0, 20_000.0, "m");
const ATTITUDE_SPREAD: Range = range(0.0, 10.0, "°");
const FOCUS_SHIFT: Range = range(-500.0, 500.0, "µm");
const IMAGE_SIGMA: Range = range(0.01, 100.0, "µm");
const POSITION_SIGMA: Range = range(0.001, 1000.0, "m");
const ATTITUDE_SIGMA: Range = range(1e-4, 10.0, "°");
const POSITION_BIAS: Range = range(-1000.0, 1000.0, "m");
const ATTITUDE_BIAS: Range = range(-10.0, 10.0, "°");
const CONTROL_SIGMA: Range = range(0.001, 10.0, "m");
const CHECK_POINTS: Range = range(2.0, 50.0, "points");

/// Refuses the first number of the scenario that is out of its range; control points are checked
/// elsewhere.
pub(super) fn check_numbers(scenario: &ScenarioFile, text: &TomlText) -> Result<(), InputError> {
    let ScenarioFile {
        flight,
        terrain,
        truth,
        correction,
        image,
        pos,
        control,
        check,
        ..
    } = scenario;
    let known_um = correction.focus_shift_um.unwrap_or(0.0);
    for (range, value, table, key) in [
        (FLYING_HEIGHT, flight.height_m, "flight", "height_m"),
        (SPEED, flight.speed_m_s, "flight", "speed_m_s"),
        (EXPOSURE, flight.exposure_s, "flight", "exposure_s"),
        (HEADING, flight.heading_deg, "flight", "heading_deg"),
        (FRAMES, whole(flight.frames), "flight", "frames"),
        (BASE, flight.base_m, "flight", "base_m"),
        (TERRAIN_HEIGHT, terrain.height_m, "terrain", "height_m"),
        (RELIEF, terrain.relief_m, "terrain", "relief_m"),
        (WAVELENGTH, terrain.wavelength_m, "terrain", "wavelength_m"),
        (FOCUS_SHIFT, truth.focus_shift_um, "truth", "focus_shift_um"),
        (FOCUS_SHIFT, known_um, "correction", "focus_shift_um"),
        (IMAGE_SIGMA, image.sigma_um, "image", "sigma_um"),
        (CONTROL_SIGMA, control.sigma_m, "control", "sigma_m"),
        (
            CHECK_POINTS,
            whole(check.points_per_side),
            "check",
            "points_per_side",
        ),
    ] {
        range.check(value, text, &[table, key])?;
    }
    PLACE.check_each(&flight.start_m, text, &["flight", "start_m"])?;
    let spread = ["flight", "attitude_spread_deg"];
    ATTITUDE_SPREAD.check_each(&flight.attitude_spread_deg, text, &spread)?;
    POSITION_BIAS.check_each(&pos.position_bias_m, text, &["pos", "position_bias_m"])?;
    ATTITUDE_BIAS.check_each(&pos.attitude_bias_deg, text, &["pos", "attitude_bias_deg"])?;
    for (range, sigma, key) in [
        (POSITION_SIGMA, &pos.position_sigma_m, "position_sigma_m"),
        (
            ATTITUDE_SIGMA,
            &pos.attitude_sigma_deg,
            "attitude_sigma_deg",
        ),
    ] {
        if let Sigma::Each(sigmas) = sigma {
            range.check_each(sigmas, text, &["pos", key])?;
        }
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
