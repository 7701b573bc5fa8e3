//! Precise-angle method for a line of the sensor: places on the line against angles of a turntable.

pub mod budget;
mod exact;
pub mod line_group;
mod line_result;
pub mod methods;
pub mod request;

use std::collections::BTreeMap;
use std::sync::Arc;

use fmc_camera_file::InputError;

use super::failure::{CalibrationFailure, failure};
use super::gross_errors::search;
use super::least_squares::adjust;
use super::result::CalibrationResult;
use exact::{LineCamera, NAMES};
use line_group::{LineGroup, line_group};
use methods::{DistancePoint, Ray, both, distance_alone};
use request::{AngleObservation, AnglesRequest, line_angles, rays, weighted};

/// Largest angle, degrees.
pub const LARGEST_ANGLE_DEG: f64 = 89.0;

/// f of the observations over f of the camera file, beyond which a unit or a direction is wrong.
const LIKELY: std::ops::Range<f64> = 0.5..2.0;

/// A calibration by precise angles.
#[derive(Debug, Clone)]
pub struct Angles {
    /// The exact model, which goes into the camera file.
    pub result: CalibrationResult,
    /// All observations.
    pub all: LineGroup,
    /// Each band.
    pub bands: Vec<LineGroup>,
}

/// Determines principal distance, principal point and radial distortion along a line.
///
/// # Model
/// Li et al. (1)-(6) as printed, the direct fit and the exact model of `docs/calibration.md`.
///
/// # Errors
/// [`CalibrationFailure`] for angles beyond ±89°, fewer observations than unknowns, angles that do
/// not separate them, and observations of another unit or direction than the camera file's.
pub fn angles(request: &AnglesRequest<'_>) -> Result<Angles, CalibrationFailure> {
    check(request)?;
    let all: Vec<&AngleObservation> = request.observations.iter().collect();
    let rays = rays(&all);
    let start = start(request, &rays)?;
    let file = &request.input.file;
    let name = |index: usize| (*NAMES.get(index).unwrap_or(&"an unknown")).to_owned();
    let place = |index: usize| {
        let line = request.observations.get(index).map_or(0, |one| one.line);
        format!("the angle of line {line}")
    };
    let failed = |error| failure(file, &error, name, place);
    let first = line_angles(request, &all, start.f_mm, |_| 0.0);
    let model = LineCamera {
        unknowns: [start.f_mm, start.p_mm, 0.0, 0.0, 0.0],
        angles: &first,
    };
    let found = adjust(&model, &vec![true; first.len()])
        .map_err(failed)?
        .model;
    let weighted = weighted(request, &all, &found);
    let model = LineCamera {
        angles: &weighted,
        ..found
    };
    let searched = search(&model, request.keeps_all).map_err(failed)?;
    let accepted: Vec<&AngleObservation> = all
        .iter()
        .zip(&searched.accepted)
        .filter_map(|(one, accepted)| accepted.then_some(*one))
        .collect();
    let group = |band: Option<Arc<str>>, observations: &[&AngleObservation]| {
        line_group(request, band, observations).map_err(failed)
    };
    let mut by_band: BTreeMap<Arc<str>, Vec<&AngleObservation>> = BTreeMap::new();
    for one in &accepted {
        if let Some(band) = &one.band {
            by_band.entry(band.clone()).or_default().push(one);
        }
    }
    let mut bands = Vec::new();
    for (band, observations) in by_band {
        bands.push(group(Some(band), &observations)?);
    }
    let all = group(None, &accepted)?;
    let result = line_result::result(request, &searched, &bands);
    Ok(Angles { result, all, bands })
}

fn check(request: &AnglesRequest<'_>) -> Result<(), InputError> {
    let file = &request.input.file;
    for one in request.observations {
        if one.angle_deg.abs() > LARGEST_ANGLE_DEG {
            return Err(InputError::invalid(format!(
                "{file}, line {}: angle_deg = {}: allowed: -{LARGEST_ANGLE_DEG} to {LARGEST_ANGLE_DEG}",
                one.line, one.angle_deg
            )));
        }
    }
    Ok(())
}

/// Returns f and p from which the exact model starts, after a look at units and directions.
fn start(request: &AnglesRequest<'_>, rays: &[Ray]) -> Result<DistancePoint, InputError> {
    let file = &request.input.file;
    let nominal = request.camera.principal_distance_mm;
    let refused = |text: String| InputError::invalid(format!("{file}: {text}"));
    if rays.len() < NAMES.len() {
        return Err(refused(format!(
            "{} observations do not suffice for {} unknowns",
            rays.len(),
            NAMES.len()
        )));
    }
    let f = distance_alone(rays).ok_or_else(|| refused("all angles are zero".to_owned()))?;
    let ratio = f / nominal;
    if LIKELY.contains(&ratio) {
        return Ok(both(rays).unwrap_or(DistancePoint { f_mm: f, p_mm: 0.0 }));
    }
    let is_near = |factor: f64| (ratio.abs() / factor - 1.0).abs() < 0.2;
    let help = if is_near(1.0) {
        "angle_deg and l_mm count in opposite directions; reverse one of them"
    } else if is_near(180.0 / std::f64::consts::PI) {
        "angle_deg looks like radians"
    } else if is_near(60.0) {
        "angle_deg looks like minutes of arc taken for degrees the other way; give degrees"
    } else if is_near(1e3 / request.camera.sensor.pixel_um) {
        "l_mm looks like pixels"
    } else if is_near(1e3) {
        "l_mm looks like µm"
    } else {
        "angle_deg is in degrees, l_mm in mm from the centre of the sensor, and principal_distance_mm of the camera file the nominal one"
    };
    Err(refused(format!(
        "l_mm over the tangent of angle_deg is {f:.4} mm, and the camera file has a principal distance of {nominal} mm"
    ))
    .with_help(help))
}
