//! Allowed ranges of a scenario's numbers.

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;

use super::scenario_file::{ScenarioFile, Sigma};
use crate::range::{
    EXPOSURE, FLYING_HEIGHT, RELIEF, Range, Ranged as _, SPEED, TERRAIN_HEIGHT, WAVELENGTH, check,
    check_clearance, range,
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
    check!(text:
        flight.height_m FLYING_HEIGHT,
        flight.speed_m_s SPEED,
        flight.exposure_s EXPOSURE,
        flight.heading_deg HEADING,
        flight.frames FRAMES,
        flight.base_m BASE,
        terrain.height_m TERRAIN_HEIGHT,
        terrain.relief_m RELIEF,
        terrain.wavelength_m WAVELENGTH,
        truth.focus_shift_um FOCUS_SHIFT,
        correction.focus_shift_um FOCUS_SHIFT,
        image.sigma_um IMAGE_SIGMA,
        control.sigma_m CONTROL_SIGMA,
        check.points_per_side CHECK_POINTS,
        flight.start_m PLACE,
        flight.attitude_spread_deg ATTITUDE_SPREAD,
        pos.position_bias_m POSITION_BIAS,
        pos.attitude_bias_deg ATTITUDE_BIAS,
    );
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
    check_clearance(text, flight.height_m, terrain.height_m, terrain.relief_m)
}
