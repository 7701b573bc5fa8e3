//! Result of the precise-angle method for an area camera.

use std::sync::Arc;

use fmc_camera_file::DistortionTable;
use fmc_camera_file::static_block::StaticCalibration;
use nalgebra::{DMatrix, Matrix3, Vector3};

use super::model::FieldCamera;
use super::request::{CalibratedStage, FieldAngles, FieldAnglesRequest, Mount};
use crate::bundle::interior::InteriorElement;
use crate::bundle::pose::Pose;
use crate::calibration::gross_errors::{Searched, rejection_warning};
use crate::calibration::result::CalibrationResult;
use crate::calibration::result::parameter_estimate::ParameterEstimate;
use crate::calibration::result::residual::{ImageResidual, ObservationGroup};

/// Names of the unknowns of the stage.
const STAGE_NAMES: [&str; 4] = [
    "stage_scale",
    "stage_axis_angle_rad",
    "run_out_mm_per_mm",
    "run_out_mm_per_mm2",
];

/// Names of the unknowns of the mount.
const MOUNT_NAMES: [&str; 3] = ["mount about x", "mount about y", "mount about z"];

/// σ0 above which the model is doubted.
const DOUBTFUL_SIGMA0: f64 = 10.0;

/// Multiple of σ above which scale or angle of the stage is said to differ from the camera file.
const SIGNIFICANT: f64 = 4.0;

/// Returns the name of an unknown, in the order of the adjustment.
pub(super) fn unknown_name(
    request: &FieldAnglesRequest<'_>,
    stage_unknowns: usize,
    index: usize,
) -> String {
    let interior = InteriorElement::ALL.into_iter();
    let interior = interior.filter(|element| request.estimated.contains(element));
    let stage = STAGE_NAMES.into_iter().take(stage_unknowns);
    let names = interior.map(InteriorElement::name).chain(stage);
    names
        .chain(MOUNT_NAMES)
        .nth(index)
        .unwrap_or("an unknown")
        .to_owned()
}

pub(super) fn outcome(
    request: &FieldAnglesRequest<'_>,
    searched: &Searched<FieldCamera<'_>, 2>,
    stage: Option<CalibratedStage>,
) -> FieldAngles {
    let adjusted = &searched.adjusted;
    let model = &adjusted.model;
    let residuals = residuals(request, searched);
    let accepted = residuals.iter().filter(|one| !one.is_rejected).count();
    let mut result = CalibrationResult {
        method: "angles",
        camera: request.camera.clone(),
        calibrated: calibrated(request, model),
        inputs: vec![request.input.clone()],
        parameters: parameters(request, model),
        cofactors: cofactors(model, &adjusted.cofactors),
        sigma0: adjusted.sigma0,
        has_sigma: true,
        groups: vec![ObservationGroup::of_image_points(&residuals)],
        datum: "the angles of the turntable; the rotation of the mount is unknown".to_owned(),
        observations: 2 * accepted,
        unknowns: 2 * accepted - adjusted.redundancy,
        constraints: 0,
        iterations: adjusted.iterations,
        critical_value: searched.critical,
        warnings: Vec::new(),
        notes: vec![
            "principal point and mount are correlated by nearly 1: a direction is known against the turntable, not against the camera".to_owned(),
        ],
        image_residuals: residuals,
        other_residuals: Vec::new(),
        images: Vec::new(),
        points: Vec::new(),
    };
    result.warnings = warnings(&result);
    if stage.is_none() {
        result.notes.push(
            "without stage_offset_mm at two offsets or more the stage is not calibrated: its run-out stays that of the camera file"
                .to_owned(),
        );
    }
    result.notes.extend(axis_check(&result));
    FieldAngles {
        mount: mount(model, &adjusted.cofactors, adjusted.sigma0),
        result,
        stage,
    }
}

fn warnings(result: &CalibrationResult) -> Vec<String> {
    let mut warnings = Vec::new();
    if result.sigma0 > DOUBTFUL_SIGMA0 {
        warnings.push(format!(
            "residuals are {:.0} times their σ: the model does not follow the image, or the σ are too small",
            result.sigma0
        ));
    }
    warnings.extend(rejection_warning(result));
    warnings.extend(result.coverage().warning());
    warnings.extend(result.correlation_warnings());
    warnings
}

/// Says what scale and angle of the stage, which the camera file does not hold, cost at the end of
/// the stroke.
fn axis_check(result: &CalibrationResult) -> Vec<String> {
    let reach_mm = 0.5 * result.camera.fmc.stroke_mm;
    ["stage_scale", "stage_axis_angle_rad"]
        .into_iter()
        .filter_map(|name| {
            let (value, sigma) = (result.parameter(name)?.value, result.sigma(name)?);
            let cost_um = 1e3 * reach_mm * value.abs();
            let what = if name == "stage_scale" {
                "the encoder's scale is to be multiplied by 1 + stage_scale"
            } else {
                "the stage is to be turned, as fmc.axis has whole right angles"
            };
            Some(if value.abs() > SIGNIFICANT * sigma {
                format!("axis check: {name} = {value:+.3e} ± {sigma:.1e} moves the principal point by {cost_um:.3} µm at half the stroke, {reach_mm} mm; the camera file cannot hold it: {what}")
            } else {
                format!("axis check: {name} = {value:+.3e} ± {sigma:.1e} agrees with the camera file")
            })
        })
        .collect()
}

fn parameters(request: &FieldAnglesRequest<'_>, model: &FieldCamera<'_>) -> Vec<ParameterEstimate> {
    let start = crate::bundle::interior::Interior::of(request.camera);
    let mut parameters: Vec<ParameterEstimate> = InteriorElement::ALL
        .into_iter()
        .map(|element| {
            let value = model.interior.value(element);
            if request.estimated.contains(&element) {
                ParameterEstimate::estimated(element.name(), Some(start.value(element)), value)
            } else {
                ParameterEstimate::held(element.name(), value)
            }
        })
        .collect();
    if model.run_out_unknowns > 0 {
        let [along, across] = model.travel;
        let flatness = &request.camera.fmc.flatness_um;
        let of_file = |power: usize| Some(flatness.get(power).copied().unwrap_or(0.0) / 1e3);
        let [_, z1, z2, ..] = model.run_out;
        let found = [
            (along.hypot(across) - 1.0, Some(0.0)),
            (across.atan2(along), Some(0.0)),
            (z1, of_file(1)),
            (z2, of_file(2)),
        ];
        for (index, (name, (value, start))) in STAGE_NAMES.into_iter().zip(found).enumerate() {
            parameters.push(if index < model.stage_unknowns() {
                ParameterEstimate::estimated(name, start, value)
            } else {
                ParameterEstimate::held(name, value)
            });
        }
    }
    parameters
}

/// Returns the cofactor matrix of interior and stage, with scale and angle for the two components
/// of the travel.
fn cofactors(model: &FieldCamera<'_>, of_unknowns: &DMatrix<f64>) -> DMatrix<f64> {
    let first = model.elements.len();
    let kept = first + model.stage_unknowns();
    let [along, across] = model.travel;
    let length = along.hypot(across);
    let carried = DMatrix::from_fn(kept, kept, |row, column| {
        if model.run_out_unknowns > 0 {
            match (row.checked_sub(first), column.checked_sub(first)) {
                (Some(0), Some(0)) => return along / length,
                (Some(0), Some(1)) => return across / length,
                (Some(1), Some(0)) => return -across / length.powi(2),
                (Some(1), Some(1)) => return along / length.powi(2),
                _ => {}
            }
        }
        if row == column { 1.0 } else { 0.0 }
    });
    let of_kept = of_unknowns.view((0, 0), (kept, kept));
    &carried * of_kept * carried.transpose()
}

fn calibrated(request: &FieldAnglesRequest<'_>, model: &FieldCamera<'_>) -> StaticCalibration {
    let interior = &model.interior;
    let ([k0, k1, k2, k3], [p1, p2], [b1, b2]) = (interior.k, interior.p, interior.b);
    let terms = model.run_out.iter().map(|mm| 1e3 * mm);
    let least = request.camera.fmc.flatness_um.len();
    let kept = least.max(1 + model.run_out_unknowns);
    StaticCalibration {
        principal_distance_mm: interior.principal_distance_mm,
        principal_point_mm: interior.principal_point_mm,
        distortion: DistortionTable {
            k0,
            k1,
            k2,
            k3,
            p1,
            p2,
            b1,
            b2,
            ..DistortionTable::default()
        },
        flatness_um: (model.run_out_unknowns > 0).then(|| terms.take(kept).collect()),
    }
}

fn residuals(
    request: &FieldAnglesRequest<'_>,
    searched: &Searched<FieldCamera<'_>, 2>,
) -> Vec<ImageResidual> {
    let tested = searched.tested.iter().zip(&searched.accepted);
    request
        .observations
        .iter()
        .zip(tested)
        .map(|(one, (tested, accepted))| ImageResidual {
            line: one.line,
            image: Arc::from(if request.has_stage {
                one.stage_offset_mm.to_string()
            } else {
                "1".to_owned()
            }),
            point: Arc::from(format!("{}/{}", one.azimuth_deg, one.elevation_deg)),
            measured_mm: one.measured_mm,
            components: *tested,
            is_rejected: !accepted,
        })
        .collect()
}

/// Returns the attitude of the camera on the turntable with σ.
fn mount(model: &FieldCamera<'_>, of_unknowns: &DMatrix<f64>, sigma0: f64) -> Mount {
    let first = model.elements.len() + model.stage_unknowns();
    let cofactors: Matrix3<f64> = of_unknowns.fixed_view::<3, 3>(first, first).into_owned();
    let pose = Pose {
        position_m: Vector3::zeros(),
        rotation: model.mount.inverse(),
    };
    // exp(w) before the mount is exp(-Mᵀw) before its inverse.
    let carried =
        pose.angles_by_rotation().unwrap_or_default() * -model.mount.inverse().into_inner();
    let of_angles = carried * cofactors * carried.transpose();
    let deviations = of_angles
        .diagonal()
        .map(|one| (sigma0 * one.max(0.0).sqrt()).to_degrees());
    Mount {
        attitude_deg: pose.orientation().attitude.map(f64::to_degrees),
        sigma_deg: deviations.into(),
    }
}
