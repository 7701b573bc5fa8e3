//! Rows of a distortion table in the terms of polynomial and grids.

use fmc_camera::geometry::grid::GridCarrier;

use super::request::GridRequest;
use super::roughness::{Difference, second_differences};
use super::table::TableObservation;

/// Place of a row in the image as the lens makes it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// (x - x0 - c·e)/(1+κ), mm from the principal point.
    pub(super) from_pp_mm: [f64; 2],
    /// (x - c·e)/(1+κ), mm in the frame of the lens's grid.
    pub(super) of_lens_mm: [f64; 2],
    /// Distortion without the enlargement κ·(x - x0 - c·e)/(1+κ), mm.
    pub(super) distortion_mm: [f64; 2],
}

impl Place {
    /// Returns the place of a row.
    pub(super) fn new(request: &GridRequest<'_>, row: &TableObservation) -> Self {
        let [ex, ey] = request.axis;
        let [x, y] = row.measured_mm;
        let [x0, y0] = request.principal_point_mm;
        let [dx, dy] = row.distortion_mm;
        let offset = row.stage_offset_mm;
        let enlargement = request.run_out.enlargement(offset);
        let moved = [x - offset * ex, y - offset * ey];
        let of_lens_mm = moved.map(|value| value / (1.0 + enlargement));
        let [px, py] = moved;
        let from_pp_mm = [px - x0, py - y0].map(|value| value / (1.0 + enlargement));
        let [rx, ry] = from_pp_mm;
        Self {
            from_pp_mm,
            of_lens_mm,
            distortion_mm: [dx - enlargement * rx, dy - enlargement * ry],
        }
    }
}

/// Returns the weights of the coefficients of all grids, row by row.
///
/// # Errors
/// A sentence that names the line of a point outside a grid.
pub(super) fn weights(
    request: &GridRequest<'_>,
    places: &[Place],
) -> Result<Vec<Vec<(usize, f64)>>, String> {
    let mut rows = Vec::new();
    for (place, row) in places.iter().zip(request.observations) {
        let mut weights = Vec::new();
        let mut first = 0;
        for (carrier, lattice) in &request.grids {
            let at = match carrier {
                GridCarrier::Lens => place.of_lens_mm,
                GridCarrier::Sensor => row.measured_mm,
            };
            let Some(found) = lattice.weights(at) else {
                let [x, y] = row.measured_mm;
                return Err(format!(
                    "line {}: the point ({x}, {y}) mm at the stage offset {} mm lies outside the \
                     grid, which reaches half the stroke beyond the sensor",
                    row.line, row.stage_offset_mm
                ));
            };
            weights.extend(found.map(|(node, weight)| (first + node, weight)));
            first += lattice.nodes();
        }
        rows.push(weights);
    }
    Ok(rows)
}

/// Returns the second differences of the coefficients of all grids.
pub(super) fn penalties(request: &GridRequest<'_>) -> Vec<Difference> {
    let mut penalties = Vec::new();
    let mut first = 0;
    for (_, lattice) in &request.grids {
        for difference in second_differences(lattice) {
            let moved = difference.into_iter();
            penalties.push(moved.map(|(node, factor)| (first + node, factor)).collect());
        }
        first += lattice.nodes();
    }
    penalties
}
