//! Roughness of a lattice of coefficients, by second differences.

use super::lattice::Lattice;

/// A second difference: nodes with their factors.
pub(super) type Difference = Vec<(usize, f64)>;

/// Returns the second differences of a lattice: those along x, along y, and the mixed ones, which
/// count twice in the energy of a bent plate.
pub(super) fn second_differences(lattice: &Lattice) -> Vec<Difference> {
    let [columns, rows] = lattice.sides().map(usize::from);
    let node = |column: usize, row: usize| row * columns + column;
    let mut found = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            if column + 2 < columns {
                found.push(vec![
                    (node(column, row), 1.0),
                    (node(column + 1, row), -2.0),
                    (node(column + 2, row), 1.0),
                ]);
            }
            if row + 2 < rows {
                found.push(vec![
                    (node(column, row), 1.0),
                    (node(column, row + 1), -2.0),
                    (node(column, row + 2), 1.0),
                ]);
            }
            if column + 1 < columns && row + 1 < rows {
                let factor = std::f64::consts::SQRT_2;
                found.push(vec![
                    (node(column, row), factor),
                    (node(column + 1, row), -factor),
                    (node(column, row + 1), -factor),
                    (node(column + 1, row + 1), factor),
                ]);
            }
        }
    }
    found
}
