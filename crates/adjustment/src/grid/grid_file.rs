//! File of a residual grid, as a camera reads it.

use fmc_camera::SensorPoint;
use fmc_camera::geometry::grid::{GridError, GridHeader};

use super::fit::FittedGrid;

/// Largest coefficient in units of the scale.
const LARGEST: f64 = 32767.0;

/// Least unit of the coefficients, mm.
const LEAST_SCALE_MM: f64 = 1e-10;

/// Returns the file of a grid, its coefficients rounded to 16 bits of the smallest scale.
///
/// # Errors
/// [`GridError`] for a grid that no camera accepts.
pub fn bytes(grid: &FittedGrid) -> Result<Vec<u8>, GridError> {
    let largest_mm = grid
        .coefficients_mm
        .iter()
        .flatten()
        .fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let [first_x, first_y] = grid.lattice.first_mm();
    let [columns, rows] = grid.lattice.sides();
    // Rounded up, so that the largest coefficient is within 16 bits.
    let scale_mm = single((largest_mm / LARGEST).max(LEAST_SCALE_MM)).next_up();
    let header = GridHeader {
        carrier: grid.carrier,
        columns,
        rows,
        first_node: SensorPoint::new(single(first_x), single(first_y)),
        pitch_mm: single(grid.lattice.pitch_mm()),
        scale_mm,
    };
    header.check()?;
    let mut bytes = header.to_bytes().to_vec();
    for value in grid.coefficients_mm.iter().flatten() {
        bytes.extend(rounded(value / f64::from(scale_mm)).to_le_bytes());
    }
    bytes.extend(GridHeader::checksum(&bytes).to_le_bytes());
    Ok(bytes)
}

#[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest")]
const fn single(value: f64) -> f32 {
    value as f32
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "within 16 bits, or the nearest that is"
)]
fn rounded(value: f64) -> i16 {
    value.round() as i16
}
