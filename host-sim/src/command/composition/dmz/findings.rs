//! Findings on the way, and rigs that are calibrated for them.

use fmc_composition::rig::Heights;
use fmc_composition::rig::calibration::{RigCalibration, RigOptions, calibrate};
use fmc_composition::rig::control::Measurements;
use fmc_composition::scene::Scene;
use fmc_report::composition::page::Section;
use serde::Serialize;

use crate::failure::Failure;

/// Largest root mean square of a place, and of a step at a seam, px.
pub(super) const LARGEST_PX: f64 = 0.25;
pub(super) const LARGEST_STEP_PX: f64 = 0.2;
/// σ of measured image points, px.
const SIGMA_PX: f64 = 0.25;

/// A number with its limit.
#[derive(Debug, Serialize)]
pub(super) struct Check {
    pub(super) what: String,
    pub(super) found: f64,
    pub(super) limit: String,
    pub(super) passed: bool,
}

/// Findings along the way.
#[derive(Debug, Default)]
pub(super) struct Findings {
    pub(super) checks: Vec<Check>,
    pub(super) sections: Vec<Section>,
    pub(super) lines: Vec<String>,
}

impl Findings {
    /// Table of the numbers and their limits.
    pub(super) fn table(&self) -> Section {
        let rows = self.checks.iter().map(|check| {
            let verdict = if check.passed { "passed" } else { "FAILED" };
            vec![
                check.what.clone(),
                format!("{:.3}", check.found),
                check.limit.clone(),
                verdict.to_owned(),
            ]
        });
        Section {
            heading: "Numbers and their limits".to_owned(),
            columns: ["what", "found", "limit", ""].map(str::to_owned).to_vec(),
            rows: rows.collect(),
            ..Section::default()
        }
    }
}

/// Calibrates the rig of a scene from some of its exposures.
pub(super) fn calibrated(
    scene: &Scene,
    exposures: &[usize],
    heights: Heights,
) -> Result<RigCalibration, Failure> {
    let mut data = Measurements {
        control_file: "control.csv".to_owned(),
        ..Measurements::default()
    };
    for exposure in exposures {
        data.control.extend(scene.control(*exposure));
        data.ties.extend(scene.ties(*exposure));
    }
    let options = RigOptions {
        degree: 3,
        heights,
        sigma_px: SIGMA_PX,
    };
    Ok(calibrate(&scene.rig, &data, &options)?)
}
