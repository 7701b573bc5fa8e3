//! Two-dimensional direct linear transformation: distortion tables from a plane target.

pub mod distortion_table;
mod homography;
pub mod interpolation;
mod outcome;
pub mod request;

use fmc_camera_file::InputError;
use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::dlt3d::COEFFICIENT_NAMES;
use super::dlt3d::pinhole::{Improper, Pinhole};
use super::failure::{CalibrationFailure, failure};
use super::gross_errors::search;
use super::least_squares::adjust;
use distortion_table::{Dlt2d, Gauge};
use homography::{EIGHT, Homographies, Imaged, LEAST_HEIGHT, Pair, collinear, through};
use request::Dlt2dRequest;

/// Determines distortion table and camera file of one focus setting.
///
/// # Model
/// S3 and `docs/calibration.md`: the table is measured - ideal, ideal by the homography through
/// four corners, or by least squares of all targets. The camera file keeps f and (x0, y0); its
/// polynomial is adjusted together with a homography of its own, beside its residual grids, which
/// are held. The table is of the whole distortion, grids included.
///
/// # Errors
/// [`CalibrationFailure`] naming targets on a line, collinear corners, a mirror image, or unknowns
/// that the targets do not separate.
pub fn dlt2d(request: &Dlt2dRequest<'_>) -> Result<Dlt2d, CalibrationFailure> {
    let file = &request.input.file;
    let (plane, pairs) = pairs(request)?;
    let corners = request
        .corners
        .map(|names| corners(request, names, &pairs))
        .transpose()?;
    let lens = Pinhole::lens(request.camera, request.is_estimated);
    let place = |index: usize| {
        let target = request.targets.get(index);
        target.map_or_else(String::new, |target| {
            format!("target {} (line {})", target.target, target.line)
        })
    };
    let name = |index: usize| {
        let coefficients = COEFFICIENT_NAMES.into_iter().zip(request.is_estimated);
        let mut estimated = coefficients.filter_map(|(name, is)| is.then_some(name));
        let found = index.checked_sub(EIGHT).and_then(|at| estimated.nth(at));
        found.map_or_else(|| "the homography".to_owned(), str::to_owned)
    };
    let failed = |error| failure(file, &error, name, place);
    let linear = linear(&pairs)
        .ok_or_else(|| InputError::invalid(format!("{file}: the targets give no homography")))?;
    if linear.determinant() < 0.0 {
        return Err(InputError::invalid(format!(
            "{file}: the image is a mirror image of the plane"
        ))
        .with_help("y_mm counts upwards and col_px, row_px to the right and downwards; one axis of image or plane is reversed")
        .into());
    }
    let held = request.camera.distortion.measured_minus_ideal();
    let model = Imaged {
        homography: linear,
        lens,
        held: [held.k0, held.b1, held.b2],
        grids: request.grids,
        pairs: &pairs,
        is_estimated: request.is_estimated,
    };
    let searched = search(&model, request.keeps_all).map_err(failed)?;
    let table = if let Some(corners) = corners {
        through(corners).ok_or_else(|| {
            InputError::invalid(format!("{file}: --corners: they give no homography"))
        })?
    } else {
        let bare = Imaged {
            lens: Pinhole {
                radial: [0.0; 3],
                decentring: [0.0; 2],
                ..lens
            },
            held: [0.0; 3],
            grids: &ResidualSplines::NONE,
            is_estimated: [false; 5],
            ..model.clone()
        };
        let adjusted = adjust(&bare, &searched.accepted).map_err(failed)?;
        adjusted.model.homography
    };
    let homographies = Homographies {
        searched,
        table,
        plane,
    };
    let gauge = gauge(request, &homographies)?;
    Ok(outcome::outcome(request, &homographies, gauge))
}

/// Returns the targets in coordinates of mean zero and unit spread, with the transformation.
fn pairs(request: &Dlt2dRequest<'_>) -> Result<(Matrix3<f64>, Vec<Pair>), InputError> {
    let count = super::snooping::count(request.targets.len().max(1));
    let (mut mean, mut squares) = ([0.0; 2], [0.0; 3]);
    for target in request.targets {
        let [x, y] = target.plane_m;
        mean = [mean[0] + x / count, mean[1] + y / count];
    }
    for target in request.targets {
        let [x, y] = [target.plane_m[0] - mean[0], target.plane_m[1] - mean[1]];
        squares = [
            squares[0] + x * x / count,
            squares[1] + y * y / count,
            squares[2] + x * y / count,
        ];
    }
    let [xx, yy, xy] = squares;
    // Eigenvalues of the covariance.
    let half = f64::hypot(0.5 * (xx - yy), xy);
    let [most, least] = [0.5 * (xx + yy) + half, 0.5 * (xx + yy) - half];
    if least.max(0.0).sqrt() <= LEAST_HEIGHT * most.sqrt() {
        return Err(InputError::invalid(format!(
            "{}: all targets lie on a line of the plane",
            request.input.file
        )));
    }
    let scale = (0.5 * (xx + yy)).sqrt().recip();
    let plane = Matrix3::new(
        scale,
        0.0,
        -scale * mean[0],
        0.0,
        scale,
        -scale * mean[1],
        0.0,
        0.0,
        1.0,
    );
    let pairs = request.targets.iter().map(|target| Pair {
        measured_mm: target.measured_mm,
        sigma_mm: target.sigma_mm,
        plane: [
            scale * (target.plane_m[0] - mean[0]),
            scale * (target.plane_m[1] - mean[1]),
        ],
    });
    Ok((plane, pairs.collect()))
}

fn corners(
    request: &Dlt2dRequest<'_>,
    names: &[String; 4],
    pairs: &[Pair],
) -> Result<[Pair; 4], InputError> {
    let file = &request.input.file;
    let mut found = Vec::with_capacity(4);
    for (index, name) in names.iter().enumerate() {
        if names.iter().take(index).any(|other| other == name) {
            return Err(InputError::invalid(format!(
                "--corners: {name} is named twice"
            )));
        }
        let pair = request
            .targets
            .iter()
            .zip(pairs)
            .find(|(target, _)| *target.target == **name)
            .map(|(_, pair)| *pair)
            .ok_or_else(|| {
                InputError::invalid(format!("--corners: {file} has no target {name}"))
            })?;
        found.push(pair);
    }
    let corners: [Pair; 4] = found
        .try_into()
        .map_err(|_| InputError::invalid("--corners: four targets are needed".to_owned()))?;
    let places = [
        corners.map(|pair| pair.plane),
        corners.map(|pair| pair.measured_mm),
    ];
    if let Some(triple) = places.into_iter().find_map(collinear) {
        let three: Vec<String> = triple
            .iter()
            .filter_map(|index| names.get(*index).cloned())
            .collect();
        return Err(InputError::invalid(format!(
            "--corners: {} lie on a line",
            super::failure::listed(&three)
        ))
        .with_help("name four targets near the corners of the image"));
    }
    Ok(corners)
}

/// Returns the homography of the algebraic least squares.
fn linear(pairs: &[Pair]) -> Option<Matrix3<f64>> {
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    for pair in pairs {
        let [x, y] = pair.plane;
        let [u, v] = pair.measured_mm;
        rows.extend([x, y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y]);
        rows.extend([0.0, 0.0, 0.0, x, y, 1.0, -v * x, -v * y]);
        right.extend([u, v]);
    }
    let design = DMatrix::from_row_slice(right.len(), EIGHT, &rows);
    let solution = design
        .svd(true, true)
        .solve(&DVector::from_vec(right), 1e-12)
        .ok()?;
    let mut nine: Vec<f64> = solution.as_slice().to_vec();
    nine.push(1.0);
    let homography = Matrix3::from_row_slice(&nine);
    // Targets behind the camera would have a negative scale.
    let is_proper = pairs.iter().all(|pair| {
        let [x, y] = pair.plane;
        (homography * Vector3::new(x, y, 1.0)).z > 0.0
    });
    is_proper.then_some(homography)
}

/// Returns the interior orientation of the table.
///
/// # Model
/// With H and T the homographies of camera and table, that between their images is G = T·H⁻¹: a
/// pinhole image of a pinhole image, G·K = K'·R'.
fn gauge(
    request: &Dlt2dRequest<'_>,
    homographies: &Homographies<'_>,
) -> Result<Gauge, CalibrationFailure> {
    let improper = |_| {
        CalibrationFailure::from(InputError::invalid(format!(
            "{}: the table belongs to no camera",
            request.input.file
        )))
    };
    let of_camera = homographies.searched.adjusted.model.homography;
    let inverse = of_camera
        .try_inverse()
        .ok_or(Improper::Degenerate)
        .map_err(improper)?;
    let f = request.camera.principal_distance_mm;
    let [x0, y0] = request.camera.principal_point_mm;
    let camera = Matrix3::new(-f, 0.0, x0, 0.0, -f, y0, 0.0, 0.0, 1.0);
    let pinhole = Pinhole::decompose(
        &(homographies.table * inverse * camera),
        Vector3::zeros(),
        &-Vector3::z(),
    )
    .map_err(improper)?;
    let cosine = pinhole.camera_from_ground.row(2).transpose().z;
    Ok(Gauge {
        principal_distance_mm: pinhole.principal_distance_mm,
        principal_point_mm: pinhole.principal_point_mm,
        affinity: pinhole.affinity,
        axis_deg: cosine.clamp(-1.0, 1.0).acos().to_degrees(),
    })
}
