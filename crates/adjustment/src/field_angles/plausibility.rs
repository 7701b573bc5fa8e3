//! Wrong units and directions of the columns, told by their pattern.

use fmc_camera_file::InputError;
use nalgebra::{Matrix2, Matrix3, Rotation3, Vector2, Vector3};

use super::request::{FieldAnglesRequest, FieldDirection};
use crate::bundle::interior::Interior;

/// f of the observations over f of the camera file, beyond which a unit is wrong.
const LIKELY: std::ops::Range<f64> = 0.5..2.0;

/// Width of the directions across their longest extent, below which they lie on a line.
const LEAST_WIDTH: f64 = 1e-4;

/// Largest rotation of the mount, degrees.
pub const LARGEST_MOUNT_DEG: f64 = 45.0;

/// Tolerance of the factor of a wrong unit.
const SAME_FACTOR: f64 = 0.2;

/// Checks units and directions of angles and points, by the linear map of tangents to points.
///
/// # Errors
/// [`InputError`] that names column, value and allowed range.
pub(super) fn check(request: &FieldAnglesRequest<'_>) -> Result<(), InputError> {
    check_zero(request)?;
    let file = &request.input.file;
    let map = map(request)?;
    let [[xx, yx], [xy, yy]] = map.data.0;
    let refused = |text: String, help: &str| {
        Err(InputError::invalid(format!("{file}: {text}")).with_help(help.to_owned()))
    };
    if xy.abs() + yx.abs() > xx.abs() + yy.abs() {
        return refused(
            "x_mm follows elevation_deg and y_mm follows azimuth_deg".to_owned(),
            "columns are exchanged, or the camera lies on its side: azimuth turns towards +x of the sensor frame, elevation towards +y",
        );
    }
    let nominal = request.camera.principal_distance_mm;
    for (f, angle, place) in [(xx, "azimuth_deg", "x_mm"), (yy, "elevation_deg", "y_mm")] {
        let ratio = f.abs() / nominal;
        if LIKELY.contains(&ratio) {
            continue;
        }
        let is_near = |factor: f64| (ratio / factor - 1.0).abs() < SAME_FACTOR;
        let help = if is_near(180.0 / std::f64::consts::PI) {
            format!("{angle} looks like radians")
        } else if is_near(1e3) {
            format!("{place} looks like µm")
        } else if is_near(1e-3) {
            format!("{place} looks like m")
        } else if is_near(1e3 / request.camera.sensor.pixel_um) {
            format!("{place} looks like pixels")
        } else {
            format!(
                "{angle} is in degrees, {place} in mm from the centre of the sensor, and principal_distance_mm of the camera file the nominal one"
            )
        };
        return refused(
            format!(
                "{place} over the tangent of {angle} is {f:.4} mm; allowed: {} to {} mm, half and twice the principal distance of the camera file",
                LIKELY.start * nominal,
                LIKELY.end * nominal
            ),
            &help,
        );
    }
    let fault = match (xx < 0.0, yy < 0.0) {
        (false, false) => return Ok(()),
        (true, true) => {
            "x_mm falls with azimuth_deg and y_mm with elevation_deg: the image is upside down, or both angles are reversed"
        }
        (true, false) => "x_mm falls with azimuth_deg: one of them is reversed",
        (false, true) => "y_mm falls with elevation_deg: one of them is reversed",
    };
    refused(
        fault.to_owned(),
        "x counts to the right and y upwards in the sensor frame, in an upright positive image; azimuth turns towards +x, elevation towards +y",
    )
}

/// Checks that the angles count from somewhere near the optical axis.
fn check_zero(request: &FieldAnglesRequest<'_>) -> Result<(), InputError> {
    let directions = request.observations.iter().map(FieldDirection::direction);
    let sum: Vector3<f64> = directions.sum();
    let angle_deg = sum.angle(&-Vector3::z()).to_degrees();
    if angle_deg <= LARGEST_MOUNT_DEG {
        return Ok(());
    }
    Err(InputError::invalid(format!(
        "{}: the mean of azimuth_deg, elevation_deg lies {angle_deg:.1}° from the zero of the turntable; allowed: 0 to {LARGEST_MOUNT_DEG}",
        request.input.file
    ))
    .with_help("count the angles from the optical axis"))
}

/// Returns the linear map of tangents to measured points, by least squares.
fn map(request: &FieldAnglesRequest<'_>) -> Result<Matrix2<f64>, InputError> {
    let pairs: Vec<(Vector2<f64>, Vector2<f64>)> = request
        .observations
        .iter()
        .map(|one| {
            let direction = one.direction();
            let tangent = -direction.xy() / direction.z;
            (tangent, Vector2::from(one.measured_mm))
        })
        .collect();
    let count = crate::calibration::snooping::count(pairs.len());
    let [mut tangent, mut point] = [Vector2::zeros(); 2];
    for (one, other) in &pairs {
        tangent += one / count;
        point += other / count;
    }
    let [mut both, mut squares] = [Matrix2::zeros(); 2];
    for (one, other) in &pairs {
        let one = one - tangent;
        both += (other - point) * one.transpose();
        squares += one * one.transpose();
    }
    let values = squares.symmetric_eigenvalues();
    let inverse = squares
        .try_inverse()
        .filter(|_| values.min() > LEAST_WIDTH.powi(2) * values.max());
    inverse.map(|inverse| both * inverse).ok_or_else(|| {
        InputError::invalid(format!(
            "{}: all directions lie on a line, which does not determine an area camera",
            request.input.file
        ))
        .with_help("both azimuth_deg and elevation_deg vary; a line camera has angle_deg,l_mm")
    })
}

/// Returns the rotation that takes the directions nearest to the rays of the camera (Wahba's
/// problem, by singular values).
///
/// # Errors
/// [`InputError`] for a rotation of more than [`LARGEST_MOUNT_DEG`].
pub(super) fn mount(
    request: &FieldAnglesRequest<'_>,
    interior: &Interior,
) -> Result<Rotation3<f64>, InputError> {
    // The offset of the stage is no more than a degree, and its unit is not yet checked.
    let ray = |one: &FieldDirection| {
        let ideal = interior.corrected(one.measured_mm);
        Vector3::new(ideal.x, ideal.y, -interior.principal_distance_mm).normalize()
    };
    let sum: Matrix3<f64> = request
        .observations
        .iter()
        .map(|one| ray(one) * one.direction().transpose())
        .sum();
    let svd = sum.svd(true, true);
    let rotation = match (svd.u, svd.v_t) {
        (Some(u), Some(vt)) => {
            let sign = (u * vt).determinant().signum();
            u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * vt
        }
        _ => Matrix3::identity(),
    };
    let rotation = Rotation3::from_matrix_unchecked(rotation);
    let angle_deg = rotation.angle().to_degrees();
    if angle_deg > LARGEST_MOUNT_DEG {
        return Err(InputError::invalid(format!(
            "{}: the camera is turned by {angle_deg:.1}° against the zero of the turntable; allowed: 0 to {LARGEST_MOUNT_DEG}",
            request.input.file
        ))
        .with_help("count the angles from the optical axis"));
    }
    Ok(rotation)
}

/// Checks scale and direction of the stage.
///
/// # Errors
/// [`InputError`] that names the pattern.
pub(super) fn check_stage(
    request: &FieldAnglesRequest<'_>,
    scale: f64,
    angle_rad: f64,
) -> Result<(), InputError> {
    let refused = |text: String, help: &str| {
        Err(
            InputError::invalid(format!("{}: {text}", request.input.file))
                .with_help(help.to_owned()),
        )
    };
    if !LIKELY.contains(&scale) {
        let is_near = |factor: f64| (scale / factor - 1.0).abs() < SAME_FACTOR;
        let help = if is_near(1e-3) {
            "stage_offset_mm looks like µm"
        } else if is_near(1e3) {
            "stage_offset_mm looks like m"
        } else {
            "stage_offset_mm is the place of the detector along fmc.axis, from its calibrated place, in mm"
        };
        return refused(
            format!(
                "the principal point moves by {scale:.6} mm per mm of stage_offset_mm; allowed: {} to {}",
                LIKELY.start, LIKELY.end
            ),
            help,
        );
    }
    let angle_deg = angle_rad.to_degrees();
    if angle_deg.abs() > LARGEST_MOUNT_DEG {
        let help = if angle_deg.abs() > 180.0 - LARGEST_MOUNT_DEG {
            "stage_offset_mm counts against fmc.axis of the camera file; reverse one of them"
        } else {
            "fmc.axis of the camera file is the wrong one"
        };
        return refused(
            format!(
                "the principal point moves at {angle_deg:.1}° to fmc.axis; allowed: -{LARGEST_MOUNT_DEG} to {LARGEST_MOUNT_DEG}"
            ),
            help,
        );
    }
    Ok(())
}
