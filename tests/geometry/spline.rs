//! Residual grids for the tests, and their values in double precision.

use fmc_camera::SensorPoint;
use fmc_camera::geometry::grid::{GridCarrier, GridHeader, ResidualGrid};

/// Returns the header of a grid of 53 mm by 40 mm at 2 mm, one node beyond.
pub(crate) fn header() -> GridHeader {
    GridHeader {
        carrier: GridCarrier::Lens,
        columns: 31,
        rows: 25,
        first_node: SensorPoint::new(-30.0, -24.0),
        pitch_mm: 2.0,
        scale_mm: 3e-3 / 32767.0,
    }
}

/// Returns a file with the coefficients of a function of the node.
pub(crate) fn file(header: &GridHeader, coefficient: impl Fn(u16, u16) -> [i16; 2]) -> Vec<u8> {
    let mut bytes = header.to_bytes().to_vec();
    for row in 0..header.rows {
        for column in 0..header.columns {
            for component in coefficient(column, row) {
                bytes.extend(component.to_le_bytes());
            }
        }
    }
    bytes.extend(GridHeader::checksum(&bytes).to_le_bytes());
    bytes
}

#[expect(clippy::cast_possible_truncation, reason = "within 16 bits")]
pub(crate) fn rounded(value: f64) -> i16 {
    value.round() as i16
}

/// Returns coefficients of waves of 20 mm, as long as the whole range of 16 bits.
pub(crate) fn wave(column: u16, row: u16) -> [i16; 2] {
    let [x, y] = [column, row].map(|node| f64::from(node) * 0.2 * std::f64::consts::PI);
    [
        rounded(32767.0 * (x.sin() * y.cos())),
        rounded(32767.0 * (x + 0.5 * y).cos()),
    ]
}

/// Returns coefficients without any order, by a linear congruence.
pub(crate) fn noise(column: u16, row: u16) -> [i16; 2] {
    let seed = u32::from(column) * 7919 + u32::from(row) * 104_729 + 1;
    let first = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let second = first.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    [first, second].map(|word| {
        let [.., low, high] = word.to_le_bytes();
        i16::from_le_bytes([low, high])
    })
}

/// Returns the cubic B-spline centred on 0, by truncated powers (Schoenberg 1946), which the
/// library does not use.
fn basis(t: f64) -> f64 {
    let signs = [1.0, -4.0, 6.0, -4.0, 1.0];
    (0_u8..)
        .zip(signs)
        .map(|(k, sign)| sign * (t + 2.0 - f64::from(k)).max(0.0).powi(3) / 6.0)
        .sum()
}

/// Returns the value at a point in double precision, mm.
pub(crate) fn strict(grid: &ResidualGrid<'_>, [x, y]: [f64; 2]) -> [f64; 2] {
    let header = grid.header();
    let pitch = f64::from(header.pitch_mm);
    let first = header.first_node;
    let mut sum = [0.0; 2];
    for row in 0..header.rows {
        let along = basis((y - f64::from(first.y_mm)) / pitch - f64::from(row));
        if along.abs() < 1e-15 {
            continue;
        }
        for column in 0..header.columns {
            let weight = along * basis((x - f64::from(first.x_mm)) / pitch - f64::from(column));
            let coefficient = grid.coefficient(column, row).unwrap();
            for (sum, coefficient) in sum.iter_mut().zip(coefficient) {
                *sum += weight * f64::from(coefficient) * f64::from(header.scale_mm);
            }
        }
    }
    sum
}
