//! Allowed ranges of the numbers of a block's scenario.

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;

use super::scenario_file::ScenarioFile;
use crate::range::{
    EXPOSURE, FLYING_HEIGHT, RELIEF, Range, Ranged as _, SPEED, TERRAIN_HEIGHT, WAVELENGTH, check,
    check_clearance, range,
};

const STRIPS: Range = range(1.0, 20.0, "strips");
const CROSS_STRIPS: Range = range(0.0, 20.0, "strips");
const FRAMES: Range = range(2.0, 100.0, "frames");
const FORWARD_OVERLAP: Range = range(51.0, 95.0, "%");
const SIDE_OVERLAP: Range = range(5.0, 95.0, "%");
const POINTS: Range = range(12.0, 1000.0, "points");
const WIND: Range = range(-100.0, 100.0, "m/s");
const ATTITUDE_SPREAD: Range = range(0.0, 5.0, "°");
const FOCUS_SPREAD: Range = range(0.0, 20.0, "µm");
const IMAGE_SIGMA: Range = range(0.01, 100.0, "µm");
const POSITION_SIGMA: Range = range(0.001, 10.0, "m");
const ATTITUDE_SIGMA: Range = range(1e-4, 1.0, "°");
const RECORD_SIGMA: Range = range(0.0, 100.0, "µm");
const CONTROL_POINTS: Range = range(0.0, 50.0, "points");
const CONTROL_SIGMA: Range = range(0.001, 10.0, "m");
const WRONG_BY: Range = range(-500.0, 500.0, "µm");
const CHECK_POINT_LIMIT: Range = range(0.0001, 100.0, "m");

/// Refuses the first number of the scenario that is out of its range.
pub(super) fn check_numbers(scenario: &ScenarioFile, text: &TomlText) -> Result<(), InputError> {
    let ScenarioFile {
        block,
        flight,
        terrain,
        sigma,
        control,
        limits,
        ..
    } = scenario;
    check!(text:
        block.strips STRIPS,
        block.frames FRAMES,
        block.cross_strips CROSS_STRIPS,
        block.forward_overlap_percent FORWARD_OVERLAP,
        block.side_overlap_percent SIDE_OVERLAP,
        block.points_per_frame POINTS,
        flight.height_m FLYING_HEIGHT,
        flight.speed_m_s SPEED,
        flight.wind_m_s WIND,
        flight.exposure_s EXPOSURE,
        flight.attitude_spread_deg ATTITUDE_SPREAD,
        flight.focus_spread_um FOCUS_SPREAD,
        terrain.height_m TERRAIN_HEIGHT,
        terrain.relief_m RELIEF,
        terrain.wavelength_m WAVELENGTH,
        sigma.image_um IMAGE_SIGMA,
        sigma.position_m POSITION_SIGMA,
        sigma.attitude_deg ATTITUDE_SIGMA,
        sigma.record_um RECORD_SIGMA,
        control.points CONTROL_POINTS,
        control.sigma_m CONTROL_SIGMA,
        limits.records_along_m CHECK_POINT_LIMIT,
    );
    if let Some(wrong_record) = &scenario.wrong_record {
        check!(text: wrong_record.by_um WRONG_BY);
    }
    check_clearance(text, flight.height_m, terrain.height_m, terrain.relief_m)
}
