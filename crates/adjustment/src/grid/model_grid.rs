//! Residual grid of a lens whose distortion is a formula.

use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::{CameraFile, InputError};
use fmc_reference::lens::Lens;

use super::calibrated_grid::CalibratedGrid;
use super::calibration::lattice;
use super::fit::fit;
use super::lattice::Lattice;
use super::polynomial::COEFFICIENTS;
use super::request::GridRequest;
use super::run_out::RunOut;
use super::table::TableObservation;

/// Difference from the formula at which a grid is fine enough, mm: half of the 5 nm that an import
/// may leave, the rest for the single precision of a camera.
pub const GOOD_ENOUGH_MM: f64 = 2.5e-6;

/// Cells along the longer side of the sensor in the first grid that is tried.
const FIRST_CELLS: f64 = 6.0;

/// Ratio of the pitches of a grid and of the one before it.
const FINER: f64 = 0.75;

/// Rows of the table in the distance of two nodes.
const ROWS_PER_NODE: f64 = 3.0;

/// Points along each side of the sensor at which a grid is compared with the formula.
const COMPARED: u32 = 97;

/// Residual grid of a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelGrid {
    /// Grid of the lens.
    pub grid: CalibratedGrid,
    /// Largest difference of camera file and formula over the sensor, along x or y, mm.
    pub largest_mm: f64,
}

/// Finds the grid of the lens that takes what the polynomial of a camera file leaves of a formula,
/// as coarse as [`GOOD_ENOUGH_MM`] allows; the finest that a camera holds where none does.
///
/// # Model
/// `G = D - polynomial` over the sensor, enlarged by half the stroke where `distortion` has an
/// answer there. `distortion` returns measured - ideal at points of the sensor frame, mm, or `None`
/// where the formula folds.
///
/// # Errors
/// [`InputError`] for a formula that folds within the sensor, and for a grid that no camera
/// accepts.
pub fn model_grid(
    camera: &CameraFile,
    distortion: impl Fn(&[[f64; 2]]) -> Option<Vec<[f64; 2]>>,
) -> Result<ModelGrid, InputError> {
    let half = camera.half_format_mm();
    let compared = points(half, [COMPARED; 2]);
    let folds = || InputError::invalid("the formula folds within the sensor".to_owned());
    let formula = distortion(&compared).ok_or_else(folds)?;
    let lens = Lens::of(camera);
    let longer = half.iter().copied().fold(0.0, f64::max);
    let mut pitch_mm = 2.0 * longer / FIRST_CELLS;
    let mut best: Option<ModelGrid> = None;
    loop {
        let nodes = match (lattice(camera, GridCarrier::Lens, pitch_mm), &best) {
            (Ok(nodes), _) => nodes,
            (Err(error), None) => return Err(error),
            // Finer than a camera holds.
            (Err(_), Some(_)) => break,
        };
        let grid = fitted(camera, lens, nodes, &distortion).ok_or_else(folds)??;
        let differences = compared.iter().zip(&formula).flat_map(|(point, [dx, dy])| {
            let [x0, y0] = camera.principal_point_mm;
            let [x, y] = *point;
            let [px, py] = lens.displacement([x - x0, y - y0]);
            let [gx, gy] = grid.spline.displacement(*point);
            [dx - px - gx, dy - py - gy]
        });
        let largest_mm = differences.fold(0.0, |largest: f64, one| largest.max(one.abs()));
        if best
            .as_ref()
            .is_none_or(|best| largest_mm < best.largest_mm)
        {
            best = Some(ModelGrid { grid, largest_mm });
        }
        if largest_mm <= GOOD_ENOUGH_MM {
            break;
        }
        pitch_mm *= FINER;
    }
    best.ok_or_else(folds)
}

/// Fits a grid to the formula at even points; `None` where it folds within the sensor.
fn fitted(
    camera: &CameraFile,
    lens: Lens,
    nodes: Lattice,
    distortion: &impl Fn(&[[f64; 2]]) -> Option<Vec<[f64; 2]>>,
) -> Option<Result<CalibratedGrid, InputError>> {
    let half = camera.half_format_mm();
    let [ex, ey] = camera.fmc.axis.unit();
    let reach = 0.5 * camera.fmc.stroke_mm;
    let [half_x, half_y] = half;
    let enlarged = [half_x + reach * ex.abs(), half_y + reach * ey.abs()];
    let table = |half: [f64; 2]| {
        let rows = half.map(|half| rows(2.0 * half / nodes.pitch_mm()));
        let places = points(half, rows);
        let values = distortion(&places)?;
        let rows = places.into_iter().zip(values);
        Some(
            rows.map(|(measured_mm, distortion_mm)| TableObservation {
                line: 0,
                measured_mm,
                distortion_mm,
                stage_offset_mm: 0.0,
            })
            .collect::<Vec<_>>(),
        )
    };
    let observations = table(enlarged).or_else(|| table(half))?;
    let request = GridRequest {
        file: camera.name.clone(),
        observations: &observations,
        principal_point_mm: camera.principal_point_mm,
        axis: [ex, ey],
        lens,
        is_estimated: [false; COEFFICIENTS],
        run_out: RunOut::of(camera),
        grids: vec![(GridCarrier::Lens, nodes)],
    };
    let fitted = fit(&request).and_then(|found| {
        let none = || InputError::invalid("no grid was fitted".to_owned());
        CalibratedGrid::new(found.grids.first().ok_or_else(none)?)
    });
    Some(fitted)
}

/// Returns the number of rows along a side of so many cells.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number between 1 and 3 times the nodes of a grid"
)]
fn rows(cells: f64) -> u32 {
    (ROWS_PER_NODE * cells).ceil() as u32 + 1
}

/// Returns even points over a rectangle about the middle of the sensor, edges included, mm.
fn points([half_x, half_y]: [f64; 2], [columns, rows]: [u32; 2]) -> Vec<[f64; 2]> {
    let side = |half: f64, index: u32, number: u32| {
        let last = f64::from(number.saturating_sub(1).max(1));
        half * (2.0 * f64::from(index) / last - 1.0)
    };
    (0..rows)
        .flat_map(|row| {
            (0..columns).map(move |column| [side(half_x, column, columns), side(half_y, row, rows)])
        })
        .collect()
}
