//! Result of a calibration of residual grids.

use std::sync::Arc;

use fmc_camera_file::DistortionTable;
use fmc_camera_file::static_block::StaticCalibration;

use super::fit::GridFit;
use super::polynomial::{COEFFICIENT_NAMES, coefficients};
use super::request::{GridCalibrationRequest, GridRequest};
use super::warnings::warnings;
use crate::calibration::result::CalibrationResult;
use crate::calibration::result::parameter_estimate::ParameterEstimate;
use crate::calibration::result::residual::{ImageResidual, ObservationGroup, TestedResidual};
use crate::calibration::snooping::{FAMILY_ERROR, count, pope, student};

/// Unit σ of a component of the table, mm.
const UNIT_MM: f64 = 1e-3;

/// Redundancy below which the residuals do not tell the noise.
pub(super) const LEAST_REDUNDANCY: usize = 8;

/// Returns the result of every method for a fit.
pub(super) fn result(
    request: &GridCalibrationRequest<'_>,
    question: &GridRequest<'_>,
    found: &GridFit,
) -> CalibrationResult {
    let observations = 2 * request.observations.len();
    let unknowns = unknowns(found).min(observations);
    let redundancy = observations - unknowns;
    let squares: f64 = found.residuals_mm.iter().flatten().map(|v| v * v).sum();
    let sigma0 = if redundancy == 0 {
        1.0
    } else {
        (squares / count(redundancy)).sqrt() / UNIT_MM
    };
    let probability = 1.0 - FAMILY_ERROR / (2.0 * count(observations));
    let freedom = count(redundancy);
    let critical_value = (redundancy >= LEAST_REDUNDANCY)
        .then(|| pope(student(probability, freedom - 1.0), freedom));
    let residuals = image_residuals(request, found, sigma0);
    let lens = &found.lens;
    let [k0, k1, k2, k3, p1, p2, b1, b2] = coefficients(lens);
    let camera = request.camera;
    let mut result = CalibrationResult {
        method: "grid",
        camera: camera.clone(),
        calibrated: StaticCalibration {
            distortion: DistortionTable {
                k0,
                k1,
                k2,
                k3,
                p1,
                p2,
                b1,
                b2,
                ..camera.distortion
            },
            ..StaticCalibration::of(camera)
        },
        inputs: vec![request.input.clone()],
        parameters: parameters(request, question, found),
        cofactors: &found.cofactors * UNIT_MM.powi(2),
        sigma0,
        has_sigma: false,
        groups: vec![ObservationGroup::of_image_points(&residuals)],
        datum: "f and (x0, y0) of the camera file, about which the table is given".to_owned(),
        observations,
        unknowns,
        constraints: 0,
        iterations: 0,
        critical_value,
        warnings: Vec::new(),
        notes: notes(request),
        image_residuals: residuals,
        other_residuals: Vec::new(),
        images: Vec::new(),
        points: Vec::new(),
    };
    result.warnings = warnings(&result, question, found);
    result
}

/// Returns the number of unknowns that the observations determine, rounded.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a sum of shares of observations, at most their number"
)]
fn unknowns(found: &GridFit) -> usize {
    found.effective_unknowns().round() as usize
}

fn parameters(
    request: &GridCalibrationRequest<'_>,
    question: &GridRequest<'_>,
    found: &GridFit,
) -> Vec<ParameterEstimate> {
    let camera = request.camera;
    let [x0, y0] = camera.principal_point_mm;
    let mut parameters = vec![
        ParameterEstimate::held("principal_distance_mm", camera.principal_distance_mm),
        ParameterEstimate::held("x0_mm", x0),
        ParameterEstimate::held("y0_mm", y0),
    ];
    let starts = coefficients(&question.lens);
    let values = coefficients(&found.lens);
    for (((name, start), value), is_estimated) in COEFFICIENT_NAMES
        .into_iter()
        .zip(starts)
        .zip(values)
        .zip(request.is_estimated)
    {
        parameters.push(if is_estimated {
            ParameterEstimate::estimated(name, Some(start), value)
        } else {
            ParameterEstimate::held(name, value)
        });
    }
    parameters
}

/// Returns the residuals of the table; a row stands under its line, in the image of its stage
/// offset.
fn image_residuals(
    request: &GridCalibrationRequest<'_>,
    found: &GridFit,
    sigma0: f64,
) -> Vec<ImageResidual> {
    request
        .observations
        .iter()
        .zip(found.residuals_mm.iter().zip(&found.leverages))
        .map(|(row, (residual, leverage))| {
            let [x, y] = *residual;
            let [hx, hy] = *leverage;
            let tested = |v, h| TestedResidual::new(v, UNIT_MM, f64::max(0.0, 1.0 - h), sigma0);
            ImageResidual {
                line: row.line,
                image: Arc::from(format!("{} mm", row.stage_offset_mm)),
                point: Arc::from(row.line.to_string()),
                measured_mm: row.measured_mm,
                components: [tested(x, hx), tested(y, hy)],
                is_rejected: false,
            }
        })
        .collect()
}

fn notes(request: &GridCalibrationRequest<'_>) -> Vec<String> {
    let camera = request.camera;
    let [x0, y0] = camera.principal_point_mm;
    vec![
        format!(
            "the table is one about f = {} mm and (x0, y0) = ({x0}, {y0}) mm of the camera file, which are kept",
            camera.principal_distance_mm
        ),
        "polynomial and grid belong together: either alone is no distortion, and σ of a coefficient is that beside the grid".to_owned(),
        "an image of a table is a stage offset, a point is a line of the file; no row is rejected".to_owned(),
    ]
}
