//! Precise-angle method for an area camera and its stage: image points against the two angles of a
//! turntable, at several offsets of the stage.

mod model;
mod outcome;
mod plausibility;
mod request;

use fmc_camera_file::InputError;
use nalgebra::{Matrix2, Rotation3, Vector3};

use crate::bundle::interior::Interior;
use crate::calibration::failure::{CalibrationFailure, failure};
use crate::calibration::gross_errors::search;
use crate::calibration::least_squares::{AdjustmentError, adjust};
use model::{FieldCamera, MOUNT, RUN_OUT_TERMS, WeightedDirection};
pub use plausibility::LARGEST_MOUNT_DEG;
pub use request::{
    CalibratedStage, FieldAngles, FieldAnglesRequest, FieldDirection, LARGEST_ANGLE_DEG,
    LEAST_STAGE_RANGE_MM, Mount,
};

/// Share of the range of the stage offsets by which two of them differ.
const DISTINCT: f64 = 0.01;

/// σ0 above which another order of the turntable's axes is tried.
const DOUBTFUL_SIGMA0: f64 = 10.0;

/// Factor by which the other order must fit better to be named.
const LEAST_IMPROVEMENT: f64 = 8.0;

/// Determines interior orientation, distortion and stage of an area camera.
///
/// # Model
/// `docs/calibration.md`: PP = (x0, y0) + (1+s)·c·e(α), Δz = z1·c + z2·c² on top of the other terms
/// of the camera file, f(1+κ) and (1+κ)·D(r/(1+κ)) with κ = Δz/L. Residual grids are held and add
/// to D, that of the lens at the place to which the stage of the moment brings it.
///
/// # Accuracy
/// Noise-free observations give the camera back to 1e-9 mm
/// (`camera_and_stage_are_found_without_noise`); σ holds the share of errors that it should
/// (`one_sigma_holds_its_share_of_errors`).
///
/// # Errors
/// [`CalibrationFailure`] for angles beyond ±89°, offsets that do not vary, fewer observations than
/// unknowns, unknowns that they do not separate, and columns of another unit or direction.
pub fn field_angles(request: &FieldAnglesRequest<'_>) -> Result<FieldAngles, CalibrationFailure> {
    check(request)?;
    let stage = request.has_stage.then(|| stage(request)).transpose()?;
    let run_out_unknowns = stage.map_or(0, |stage| if stage.offsets > 2 { 2 } else { 1 });
    let stage_unknowns = stage.map_or(0, |_| 2 + run_out_unknowns);
    let unknowns = request.estimated.len() + stage_unknowns + MOUNT;
    let components = 2 * request.observations.len();
    let failed = |error| {
        let name = |index| outcome::unknown_name(request, stage_unknowns, index);
        let place = |index: usize| {
            let line = request.observations.get(index).map_or(0, |one| one.line);
            format!("the direction of line {line}")
        };
        failure(&request.input.file, &error, name, place)
    };
    if components < unknowns {
        return Err(failed(AdjustmentError::TooFew {
            components,
            unknowns,
        }));
    }
    plausibility::check(request)?;
    let start = start(request, run_out_unknowns)?;
    let plain = weighted(request, &start);
    let mut model = FieldCamera {
        directions: &plain,
        ..start
    };
    model = adjust(&model, &vec![true; plain.len()])
        .map_err(failed)?
        .model;
    let final_weights = weighted(request, &model);
    let model = FieldCamera {
        directions: &final_weights,
        ..model
    };
    let searched = search(&model, request.keeps_all).map_err(failed)?;
    let found = outcome::outcome(request, &searched, stage);
    if stage.is_some() {
        let value = |name: &str| found.result.parameter(name).map_or(0.0, |one| one.value);
        let scale = 1.0 + value("stage_scale");
        plausibility::check_stage(request, scale, value("stage_axis_angle_rad"))?;
    }
    check_order(request, &searched.adjusted.model, searched.adjusted.sigma0)?;
    Ok(found)
}

fn check(request: &FieldAnglesRequest<'_>) -> Result<(), InputError> {
    let file = &request.input.file;
    for one in request.observations {
        for (column, value) in [
            ("azimuth_deg", one.azimuth_deg),
            ("elevation_deg", one.elevation_deg),
        ] {
            if value.is_nan() || value.abs() > LARGEST_ANGLE_DEG {
                return Err(InputError::invalid(format!(
                    "{file}, line {}: {column} = {value}: allowed: -{LARGEST_ANGLE_DEG} to {LARGEST_ANGLE_DEG}",
                    one.line
                )));
            }
        }
    }
    Ok(())
}

/// Counts the offsets of the stage.
fn stage(request: &FieldAnglesRequest<'_>) -> Result<CalibratedStage, InputError> {
    let offsets = request.observations.iter().map(|one| one.stage_offset_mm);
    let mut offsets: Vec<f64> = offsets.collect();
    offsets.sort_by(f64::total_cmp);
    let least = offsets.first().copied().unwrap_or(0.0);
    let most = offsets.last().copied().unwrap_or(0.0);
    let range = most - least;
    if range < LEAST_STAGE_RANGE_MM {
        return Err(InputError::invalid(format!(
            "{}: stage_offset_mm is between {least} and {most} in all lines: the column tells nothing about the stage; allowed: offsets that differ by {LEAST_STAGE_RANGE_MM} mm or more",
            request.input.file
        ))
        .with_help("measure at two offsets or more, or leave the column out"));
    }
    let pairs = offsets.iter().zip(offsets.iter().skip(1));
    let steps = pairs.filter(|(a, b)| **b - **a > DISTINCT * range);
    Ok(CalibratedStage {
        offsets: 1 + steps.count(),
        range_mm: [least, most],
    })
}

/// Returns the camera from which the adjustment starts. The stage starts at rest, so that offsets
/// of another unit do no harm before they are named.
fn start<'a>(
    request: &FieldAnglesRequest<'a>,
    run_out_unknowns: usize,
) -> Result<FieldCamera<'a>, InputError> {
    let camera = request.camera;
    let interior = Interior::of(camera);
    let mut run_out = [0.0; RUN_OUT_TERMS];
    for (index, (term, um)) in run_out.iter_mut().zip(&camera.fmc.flatness_um).enumerate() {
        let is_unknown = (1..=run_out_unknowns).contains(&index);
        *term = if is_unknown { 0.0 } else { um / 1e3 };
    }
    Ok(FieldCamera {
        interior,
        travel: if run_out_unknowns > 0 {
            [0.0; 2]
        } else {
            [1.0, 0.0]
        },
        run_out,
        mount: plausibility::mount(request, &interior)?,
        axis: camera.fmc.axis.unit(),
        grids: request.grids,
        exit_pupil_mm: camera.exit_pupil_mm,
        directions: &[],
        elements: request.estimated,
        run_out_unknowns,
    })
}

/// Returns the observations with the σ of their corrected points.
///
/// # Model
/// `σ² = σ_image²·|∂ideal/∂measured|²/2 + σ_angle²·(|∂p/∂A|² + |∂p/∂E|²)/2`, p the collinearity
/// point: the mean over the two axes.
fn weighted(request: &FieldAnglesRequest<'_>, camera: &FieldCamera<'_>) -> Vec<WeightedDirection> {
    let interior = camera.about_principal_point();
    let weigh = |one: &FieldDirection| {
        let direction = one.direction();
        let u = camera.mount * direction;
        let f = interior.principal_distance_mm;
        let tangent = u.xy() / u.z;
        let by_angle = |by: Vector3<f64>| {
            let by = camera.mount * by;
            (f / u.z * (by.xy() - by.z * tangent)).norm_squared()
        };
        let [by_azimuth, by_elevation] = one.by_angles();
        let point = camera.shrunk(one.measured_mm, one.stage_offset_mm);
        let [_, by_x0, by_y0, ..] = interior.corrected_with_derivatives(point).by_element;
        let of_image = 0.5 * Matrix2::from_columns(&[by_x0, by_y0]).norm_squared();
        let of_angles = 0.5 * (by_angle(by_azimuth) + by_angle(by_elevation));
        WeightedDirection {
            direction,
            measured_mm: one.measured_mm,
            stage_offset_mm: one.stage_offset_mm,
            sigma_mm: (one.sigma_mm.powi(2) * of_image
                + request.sigma_angle_rad.powi(2) * of_angles)
                .sqrt(),
        }
    };
    request.observations.iter().map(weigh).collect()
}

/// Checks that the observations do not fit far better with the axes of the turntable in the other
/// order.
fn check_order(
    request: &FieldAnglesRequest<'_>,
    found: &FieldCamera<'_>,
    sigma0: f64,
) -> Result<(), InputError> {
    if sigma0 < DOUBTFUL_SIGMA0 {
        return Ok(());
    }
    let exchanged: Vec<WeightedDirection> = request
        .observations
        .iter()
        .zip(found.directions)
        .map(|(one, weighted)| {
            let [azimuth, elevation] = [one.azimuth_deg, one.elevation_deg].map(f64::to_radians);
            let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), elevation)
                * Rotation3::from_axis_angle(&Vector3::y_axis(), -azimuth);
            WeightedDirection {
                direction: turn * -Vector3::z(),
                ..*weighted
            }
        })
        .collect();
    let model = FieldCamera {
        directions: &exchanged,
        ..found.clone()
    };
    let Ok(other) = adjust(&model, &vec![true; exchanged.len()]) else {
        return Ok(());
    };
    let factor = sigma0 / other.sigma0.max(f64::MIN_POSITIVE);
    if factor < LEAST_IMPROVEMENT {
        return Ok(());
    }
    Err(InputError::invalid(format!(
        "{}: the directions fit {factor:.0} times better with azimuth_deg about an axis that elevation_deg turns",
        request.input.file
    ))
    .with_help(
        "elevation_deg is about an axis that azimuth_deg turns: the direction is (cosE·sinA, sinE, -cosE·cosA)",
    ))
}
