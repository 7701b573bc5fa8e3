//! Calibration of polynomial and residual grids from a distortion table.

use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::{CameraFile, InputError};
use fmc_reference::lens::Lens;

use super::calibrated_grid::CalibratedGrid;
use super::design::Place;
use super::fit::{fit, fit_noisy};
use super::lattice::Lattice;
use super::outcome;
use super::plausibility;
use super::request::{GridCalibrationRequest, GridRequest};
use super::run_out::RunOut;
use crate::calibration::result::CalibrationResult;
use crate::calibration::snooping::count;

/// Residuals of a table, per component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableErrors {
    /// Largest absolute value, mm.
    pub largest_mm: f64,
    /// Root of the mean square, mm.
    pub rms_mm: f64,
}

impl TableErrors {
    fn of(residuals_mm: &[[f64; 2]]) -> Self {
        let (mut largest_mm, mut squares) = (0.0_f64, 0.0);
        for value in residuals_mm.iter().flatten() {
            largest_mm = largest_mm.max(value.abs());
            squares += value * value;
        }
        Self {
            largest_mm,
            rms_mm: f64::sqrt(squares / count(2 * residuals_mm.len()).max(1.0)),
        }
    }
}

/// Polynomial and residual grids of a camera.
#[derive(Debug, Clone)]
pub struct GridCalibration {
    /// Result of every method; it holds the polynomial and the residuals that the grids leave.
    pub result: CalibrationResult,
    /// Grids, that of the lens first.
    pub grids: Vec<CalibratedGrid>,
    /// Residuals of the best polynomial without grids, row by row, mm.
    pub left_by_polynomial_mm: Vec<[f64; 2]>,
    /// Size of them.
    pub of_polynomial: TableErrors,
    /// Residuals of the camera: polynomial and grids with coefficients of 16 bits.
    pub of_camera: TableErrors,
    /// Largest σ of the distortion that the camera computes at a row of the table, per component,
    /// multiplied by σ0, mm.
    pub largest_sigma_mm: f64,
}

/// Determines polynomial and grids of a camera from a table.
///
/// # Errors
/// [`InputError`] that names file, line, column, value and allowed range: for rows off the sensor
/// or the stroke, for tables in another unit or of the other sign, for a pitch with more nodes than
/// a camera holds, and for both grids from one stage position.
pub fn grid_calibration(
    request: &GridCalibrationRequest<'_>,
) -> Result<GridCalibration, InputError> {
    plausibility::check(request)?;
    let mut carriers = request.carriers.to_vec();
    carriers.sort_by_key(|carrier| *carrier == GridCarrier::Sensor);
    carriers.dedup();
    let grids = carriers
        .into_iter()
        .map(|carrier| Ok((carrier, lattice(request.camera, carrier, request.pitch_mm)?)))
        .collect::<Result<Vec<_>, InputError>>()?;
    let question = GridRequest {
        file: request.input.file.clone(),
        observations: request.observations,
        principal_point_mm: request.camera.principal_point_mm,
        axis: request.camera.fmc.axis.unit(),
        lens: Lens::of(request.camera),
        is_estimated: request.is_estimated,
        run_out: RunOut::of(request.camera),
        grids,
    };
    let alone = fit(&GridRequest {
        grids: Vec::new(),
        ..question.clone()
    })?;
    let of_polynomial = TableErrors::of(&alone.residuals_mm);
    let found = fit_noisy(&question, of_polynomial.rms_mm)?;
    let grids = found
        .grids
        .iter()
        .map(CalibratedGrid::new)
        .collect::<Result<Vec<_>, _>>()?;
    let of_camera = left_by_camera(&question, &found.lens, &grids);
    let result = outcome::result(request, &question, &found);
    let leverages = found.leverages.iter().flatten();
    let largest = leverages.fold(0.0_f64, |largest, one| largest.max(*one));
    Ok(GridCalibration {
        // σ0 is in µm.
        largest_sigma_mm: 1e-3 * result.sigma0 * largest.sqrt(),
        result,
        grids,
        of_polynomial,
        left_by_polynomial_mm: alone.residuals_mm,
        of_camera: TableErrors::of(&of_camera),
    })
}

/// Returns the nodes of a grid of a camera.
pub(super) fn lattice(
    camera: &CameraFile,
    carrier: GridCarrier,
    pitch_mm: f64,
) -> Result<Lattice, InputError> {
    let reach = match carrier {
        GridCarrier::Lens => 0.5 * camera.fmc.stroke_mm,
        GridCarrier::Sensor => 0.0,
    };
    let [half_x, half_y] = camera.half_format_mm();
    let [ex, ey] = camera.fmc.axis.unit();
    let to = [half_x + reach * ex.abs(), half_y + reach * ey.abs()];
    Lattice::covering(to.map(|side| -side), to, pitch_mm)
}

/// Returns the table less what a camera with these grids computes, mm.
fn left_by_camera(
    question: &GridRequest<'_>,
    lens: &Lens,
    grids: &[CalibratedGrid],
) -> Vec<[f64; 2]> {
    let left = |row| {
        let place = Place::new(question, row);
        let mut left = place.distortion_mm;
        let polynomial = lens.displacement(place.from_pp_mm);
        let of_grids = grids.iter().map(|grid| {
            grid.spline.displacement(match grid.carrier {
                GridCarrier::Lens => place.of_lens_mm,
                GridCarrier::Sensor => row.measured_mm,
            })
        });
        for [dx, dy] in of_grids.chain([polynomial]) {
            let [x, y] = left;
            left = [x - dx, y - dy];
        }
        left
    };
    question.observations.iter().map(left).collect()
}
