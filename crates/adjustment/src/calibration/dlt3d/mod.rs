//! Direct linear transformation of one image of a three-dimensional test field.

mod adjustment;
mod linear;
pub mod pinhole;

use std::sync::Arc;

use fmc_camera_file::{CameraFile, InputError};
use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::{DMatrix, Vector3};

use adjustment::{COEFFICIENTS, Pair, Resected};
use linear::Configuration;
pub use linear::LEAST_POINTS;
use pinhole::{ELEVEN, INTERIOR_NAMES, Improper, Pinhole};

use super::failure::{CalibrationFailure, failure};
use super::gross_errors::{Searched, rejection_warning, search};
use super::result::network::{ImageStation, ObjectPoint, PointRole};
use super::result::parameter_estimate::ParameterEstimate;
use super::result::residual::{ImageResidual, ObservationGroup};
use super::result::{CalibrationResult, InputFile};

/// Names of the coefficients that can be estimated beside the eleven.
pub const COEFFICIENT_NAMES: [&str; COEFFICIENTS] = ["k1", "k2", "k3", "p1", "p2"];

/// σ of f as a share of f above which the result is called no calibration.
const LARGEST_SHARE: f64 = 1e-3;

/// Unknowns of the exterior orientation, in the order of the adjustment.
const EXTERIOR_NAMES: [&str; 6] = [
    "X_S",
    "Y_S",
    "Z_S",
    "rotation about x",
    "rotation about y",
    "rotation about z",
];

/// A point of the test field in the image.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldPoint {
    /// Line in the file.
    pub line: u64,
    /// Name.
    pub point: Arc<str>,
    /// Measured point in the sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// σ of either coordinate, mm.
    pub sigma_mm: f64,
    /// Object point, m.
    pub object_m: [f64; 3],
}

/// Observations and choices of a direct linear transformation.
#[derive(Debug, Clone)]
pub struct Dlt3dRequest<'a> {
    /// File of the observations.
    pub input: InputFile,
    /// `true` if the file has σ.
    pub has_sigma: bool,
    /// Points.
    pub points: &'a [FieldPoint],
    /// Camera file; its distortion is held where it is not estimated, without K0, B1 and B2.
    pub camera: &'a CameraFile,
    /// Its residual grids, which are held; empty for a camera without.
    pub grids: &'a ResidualSplines,
    /// Coefficients that are estimated, in the order of [`COEFFICIENT_NAMES`].
    pub is_estimated: [bool; COEFFICIENTS],
    /// `true` if no point is rejected as a gross error.
    pub keeps_all: bool,
}

/// A direct linear transformation.
#[derive(Debug, Clone)]
pub struct Dlt3d {
    /// The result.
    pub result: CalibrationResult,
    /// The camera, its position in the object frame.
    pub camera: Pinhole,
    /// l1 to l11; `None` if the origin of the object frame lies in the principal plane.
    pub eleven: Option<[f64; ELEVEN]>,
}

/// Determines interior and exterior orientation from one image of a spatial test field.
///
/// # Model
/// S1, section 4.1, and `docs/calibration.md`: the homogeneous linear solution, then Gauss-Newton
/// for f, x0, y0, B1, B2, position and attitude together with the coefficients asked for. The
/// distortion is that of the measured point about the principal point of the moment; what the
/// residual grids of the camera file add at the measured point is held.
///
/// # Errors
/// [`CalibrationFailure`] naming the configuration of points that has no solution, or the unknowns
/// that the points do not separate.
pub fn dlt3d(request: &Dlt3dRequest<'_>) -> Result<Dlt3d, CalibrationFailure> {
    let file = &request.input.file;
    let count = request.points.len();
    let refused = |text: String| InputError::invalid(format!("{file}: {text}"));
    if count < LEAST_POINTS {
        return Err(refused(format!(
            "{count} points; a direct linear transformation needs at least {LEAST_POINTS}, not all \
             but one of them in a plane"
        ))
        .into());
    }
    let mean = request
        .points
        .iter()
        .map(|point| Vector3::from(point.object_m))
        .sum::<Vector3<f64>>()
        / super::snooping::count(count);
    let pairs: Vec<Pair> = request
        .points
        .iter()
        .map(|point| Pair {
            measured_mm: point.measured_mm,
            by_grids_mm: request.grids.calibrated(point.measured_mm),
            sigma_mm: point.sigma_mm,
            object_m: Vector3::from(point.object_m) - mean,
        })
        .collect();
    let start = start(request, &pairs).map_err(|configuration| {
        refused(described(&configuration, request.points)).with_help(
            "at least 6 points spread in all three directions, at least two of them off every \
             plane that holds the others; a plane target is for dlt2d, or for several images",
        )
    })??;
    let model = Resected {
        camera: start,
        pairs: &pairs,
        is_estimated: request.is_estimated,
    };
    let searched = search(&model, request.keeps_all).map_err(|error| {
        failure(
            file,
            &error,
            |index| name_of(index, request.is_estimated),
            |index| {
                let point = request.points.get(index);
                point.map_or_else(String::new, |point| {
                    format!("point {} (line {})", point.point, point.line)
                })
            },
        )
    })?;
    let mut camera = searched.adjusted.model.camera;
    camera.centre_m += mean;
    let eleven = camera.eleven();
    let result = result(request, &searched, &camera, start);
    Ok(Dlt3d {
        result,
        camera,
        eleven,
    })
}

/// Returns the camera of the linear solution, with the held distortion of the camera file.
fn start(
    request: &Dlt3dRequest<'_>,
    pairs: &[Pair],
) -> Result<Result<Pinhole, InputError>, Configuration> {
    let objects: Vec<Vector3<f64>> = pairs.iter().map(|pair| pair.object_m).collect();
    linear::check_shape(&objects)?;
    let lens = Pinhole::lens(request.camera, request.is_estimated);
    let [x0, y0] = lens.principal_point_mm;
    let corrected: Vec<[f64; 2]> = pairs
        .iter()
        .map(|pair| {
            let ([x, y], [of_grids_x, of_grids_y]) = (pair.measured_mm, pair.by_grids_mm);
            let ([dx, dy], _) = lens.radial_and_decentring([x - x0, y - y0]);
            [x - dx - of_grids_x, y - dy - of_grids_y]
        })
        .collect();
    let matrix = linear::projection(&corrected, &objects)?;
    let left = matrix.fixed_columns::<3>(0).into_owned();
    let centre = left
        .try_inverse()
        .map(|inverse| -(inverse * matrix.column(3)))
        .ok_or(Configuration::Critical)?;
    let camera = Pinhole::decompose(&left, centre, &-centre);
    Ok(camera
        .map(|camera| Pinhole {
            radial: lens.radial,
            decentring: lens.decentring,
            ..camera
        })
        .map_err(|improper| match improper {
            Improper::Mirrored => InputError::invalid(format!(
                "{}: the image is a mirror image of the object points",
                request.input.file
            ))
            .with_help("y_mm counts upwards and col_px, row_px to the right and downwards; one axis of image or object points is reversed"),
            Improper::Degenerate => InputError::invalid(format!(
                "{}: the points give no finite principal distance",
                request.input.file
            )),
        }))
}

fn described(configuration: &Configuration, points: &[FieldPoint]) -> String {
    match configuration {
        Configuration::OnALine => "all points lie on a line".to_owned(),
        Configuration::Coplanar => "all points lie in a plane".to_owned(),
        Configuration::AllButOneCoplanar { index } => {
            let name = points
                .get(*index)
                .map_or_else(String::new, |point| format!(" {}", point.point));
            format!("all points but{name} lie in a plane")
        }
        Configuration::Critical => "points and projection centre lie on a twisted cubic, or all of them on a plane and a line through the projection centre: no image of them determines the camera".to_owned(),
    }
}

fn name_of(index: usize, is_estimated: [bool; COEFFICIENTS]) -> String {
    let coefficients = COEFFICIENT_NAMES
        .into_iter()
        .zip(is_estimated)
        .filter_map(|(name, is_estimated)| is_estimated.then_some(name));
    let interior = INTERIOR_NAMES.into_iter().take(5);
    let names = interior.chain(EXTERIOR_NAMES).chain(coefficients);
    names
        .map(str::to_owned)
        .nth(index)
        .unwrap_or_else(|| format!("unknown {index}"))
}

fn result(
    request: &Dlt3dRequest<'_>,
    searched: &Searched<Resected<'_>, 2>,
    camera: &Pinhole,
    start: Pinhole,
) -> CalibrationResult {
    let adjusted = &searched.adjusted;
    let starts = start.interior();
    let mut rows: Vec<usize> = (0..5).collect();
    let mut parameters = Vec::new();
    let mut next = ELEVEN;
    for (index, ((name, value), start)) in INTERIOR_NAMES
        .into_iter()
        .zip(camera.interior())
        .zip(starts)
        .enumerate()
    {
        let coefficient = index.checked_sub(5);
        let is_estimated = coefficient
            .is_none_or(|index| request.is_estimated.get(index).copied().unwrap_or(false));
        if is_estimated && coefficient.is_some() {
            rows.push(next);
            next += 1;
        }
        parameters.push(if is_estimated {
            ParameterEstimate::estimated(name, Some(start), value)
        } else {
            ParameterEstimate::held(name, value)
        });
    }
    let cofactor = |row: usize, column: usize| {
        let (row, column) = (rows.get(row), rows.get(column));
        let element = row
            .zip(column)
            .and_then(|(row, column)| adjusted.cofactors.get((*row, *column)).copied());
        element.unwrap_or(0.0)
    };
    let cofactors = DMatrix::from_fn(rows.len(), rows.len(), cofactor);
    let residuals: Vec<ImageResidual> = request
        .points
        .iter()
        .zip(&searched.tested)
        .zip(&searched.accepted)
        .map(|((point, tested), accepted)| ImageResidual {
            line: point.line,
            image: Arc::from("1"),
            point: point.point.clone(),
            measured_mm: point.measured_mm,
            components: *tested,
            is_rejected: !accepted,
        })
        .collect();
    let accepted = residuals.iter().filter(|one| !one.is_rejected).count();
    let mut result = CalibrationResult {
        method: "dlt3d",
        camera: request.camera.clone(),
        calibrated: camera.calibration(),
        inputs: vec![request.input.clone()],
        parameters,
        cofactors,
        sigma0: adjusted.sigma0,
        has_sigma: request.has_sigma,
        groups: vec![ObservationGroup::of_image_points(&residuals)],
        datum: "the coordinates of the object points, all held".to_owned(),
        observations: 2 * accepted,
        unknowns: 2 * accepted - adjusted.redundancy,
        constraints: 0,
        iterations: adjusted.iterations,
        critical_value: searched.critical,
        warnings: Vec::new(),
        notes: Vec::new(),
        image_residuals: residuals,
        other_residuals: Vec::new(),
        images: Vec::new(),
        points: points(request.points),
    };
    let (rms, _) = result.residual_size_mm().unwrap_or_default();
    result.images = vec![station(adjusted, camera, accepted, rms)];
    result.warnings = warnings(&result);
    result.notes.push(
        "object points count as free of error: what is wrong with them is in the residuals and in \
         the parameters"
            .to_owned(),
    );
    result
}

fn points(points: &[FieldPoint]) -> Vec<ObjectPoint> {
    let points = points.iter();
    points
        .map(|point| ObjectPoint {
            point: point.point.clone(),
            role: PointRole::Control,
            position_m: point.object_m,
            sigma_m: [0.0; 3],
            given_m: Some(point.object_m),
            rays: 1,
            intersection_deg: None,
            test_value: None,
        })
        .collect()
}

/// Returns position and attitude with their σ; that of pitch, roll and yaw by differences.
fn station(
    adjusted: &super::least_squares::Adjusted<Resected<'_>, 2>,
    camera: &Pinhole,
    points: usize,
    residual_rms_mm: f64,
) -> ImageStation {
    const STEP: f64 = 1e-6;
    let variance = |row: usize, column: usize| {
        let cofactor = adjusted.cofactors.get((row, column)).copied();
        cofactor.unwrap_or(0.0) * adjusted.sigma0.powi(2)
    };
    let turned = |axis: Vector3<f64>| {
        let rotation = nalgebra::Rotation3::new(axis * STEP).into_inner();
        let turned = Pinhole {
            camera_from_ground: rotation * camera.camera_from_ground,
            ..*camera
        };
        turned.attitude()
    };
    let at = camera.attitude();
    let slopes: Vec<[f64; 3]> = [Vector3::x(), Vector3::y(), Vector3::z()]
        .into_iter()
        .map(|axis| {
            let [plus, minus] = [turned(axis), turned(-axis)];
            std::array::from_fn(|angle| {
                let [plus, minus] = [plus, minus].map(|all| all.get(angle).copied());
                let change = plus.unwrap_or(0.0) - minus.unwrap_or(0.0);
                // Across ±180° the difference is a whole turn off.
                let turn = std::f64::consts::TAU;
                (change - turn * (change / turn).round()) / (2.0 * STEP)
            })
        })
        .collect();
    let attitude_sigma = std::array::from_fn(|angle| {
        let slope = |axis: usize| {
            let of_axis: Option<&[f64; 3]> = slopes.get(axis);
            of_axis
                .and_then(|all| all.get(angle))
                .copied()
                .unwrap_or(0.0)
        };
        let mut sum = 0.0;
        for row in 0..3 {
            for column in 0..3 {
                sum += slope(row) * slope(column) * variance(8 + row, 8 + column);
            }
        }
        sum.max(0.0).sqrt().to_degrees()
    });
    ImageStation {
        image: Arc::from("1"),
        position_m: camera.centre_m.into(),
        position_sigma_m: Some(std::array::from_fn(|axis| {
            variance(5 + axis, 5 + axis).max(0.0).sqrt()
        })),
        attitude_deg: at.map(f64::to_degrees),
        attitude_sigma_deg: Some(attitude_sigma),
        points,
        residual_rms_mm,
    }
}

fn warnings(result: &CalibrationResult) -> Vec<String> {
    let mut warnings = Vec::new();
    let f = result.calibrated.principal_distance_mm;
    if let Some(sigma) = result.sigma("principal_distance_mm")
        && sigma > LARGEST_SHARE * f
    {
        warnings.push(format!(
            "σ of the principal distance is {:.2} % of it: {} points of this shape and accuracy are no calibration; more depth, more points or a tilted image would be",
            100.0 * sigma / f,
            result.observations / 2
        ));
    }
    warnings.extend(rejection_warning(result));
    warnings.extend(result.coverage().warning());
    warnings.extend(result.correlation_warnings());
    warnings
}
