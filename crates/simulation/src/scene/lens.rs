//! Lens: the mapping between ideal and measured image points.

use fmc_reference::lens::Lens;

use super::field_table::FieldTable;

/// Residual at which an inversion ends, mm.
const CONVERGED_MM: f64 = 1e-13;
/// Largest number of steps of an inversion.
const MOST_STEPS: u8 = 40;

/// A mapping from ideal to measured image points, both from the principal point, mm.
#[derive(Debug, Clone, PartialEq)]
pub enum LensMapping {
    /// Polynomial of the camera file, a function of the measured point.
    Polynomial(Lens),
    /// Table over the ideal point, as ray tracing yields it.
    FieldTable(FieldTable),
}

impl LensMapping {
    /// A lens without distortion.
    pub const NONE: Self = Self::Polynomial(Lens {
        k: [0.0; 4],
        p: [0.0; 2],
        b: [0.0; 2],
    });

    /// Returns the measured point of an ideal one; `None` if the lens has no image of it.
    ///
    /// # Model
    /// Polynomial: `measured - D(measured) = ideal` by Newton's method. Table: by interpolation.
    ///
    /// # Accuracy
    /// Residual of the inversion at most 1e-13 mm, or a few units in the last place of the point.
    #[must_use]
    pub fn measured(&self, ideal: [f64; 2]) -> Option<[f64; 2]> {
        match self {
            Self::Polynomial(lens) => invert(lens, ideal),
            Self::FieldTable(table) => {
                let [x, y] = ideal;
                let [dx, dy] = table.displacement(ideal)?;
                Some([x + dx, y + dy])
            }
        }
    }

    /// Returns the ideal point of a measured one; `None` if there is none.
    ///
    /// # Model
    /// Polynomial: `measured - D(measured)`. Table: by fixed-point iteration.
    #[must_use]
    pub fn ideal(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        match self {
            Self::Polynomial(lens) => {
                let [dx, dy] = lens.displacement([x, y]);
                Some([x - dx, y - dy])
            }
            Self::FieldTable(table) => {
                let mut ideal = [x, y];
                for _ in 0..MOST_STEPS {
                    let [dx, dy] = table.displacement(ideal)?;
                    let next = [x - dx, y - dy];
                    let [step_x, step_y] = [next[0] - ideal[0], next[1] - ideal[1]];
                    ideal = next;
                    if step_x.hypot(step_y) <= tolerance(ideal) {
                        return Some(ideal);
                    }
                }
                None
            }
        }
    }
}

/// Returns the tolerance for a point, mm: a few units in its last place, as it is not known better.
fn tolerance([x, y]: [f64; 2]) -> f64 {
    CONVERGED_MM.max(4.0 * f64::EPSILON * x.hypot(y))
}

fn invert(lens: &Lens, ideal: [f64; 2]) -> Option<[f64; 2]> {
    let [ideal_x, ideal_y] = ideal;
    let [mut measured_x, mut measured_y] = ideal;
    for _ in 0..MOST_STEPS {
        let at = [measured_x, measured_y];
        let [dx, dy] = lens.displacement(at);
        let (residual_x, residual_y) = (measured_x - dx - ideal_x, measured_y - dy - ideal_y);
        if residual_x.hypot(residual_y) <= tolerance(at) {
            return Some(at);
        }
        let [xx, yx] = lens.derivative(at, [1.0, 0.0]);
        let [xy, yy] = lens.derivative(at, [0.0, 1.0]);
        let (a, b, c, d) = (1.0 - xx, -xy, -yx, 1.0 - yy);
        let determinant = a * d - b * c;
        // Beyond a fold the polynomial has other roots, which are not images.
        if determinant <= 0.0 || a <= 0.0 || d <= 0.0 || determinant.is_nan() {
            return None;
        }
        measured_x -= (d * residual_x - b * residual_y) / determinant;
        measured_y -= (a * residual_y - c * residual_x) / determinant;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inversion_undoes_the_polynomial_to_the_last_digits() {
        let lens = LensMapping::Polynomial(Lens {
            k: [2e-3, -2e-5, 6e-9, -1.3e-12],
            p: [6e-6, -9e-6],
            b: [4e-4, -3e-4],
        });
        for x in [-40.0, -3.0, 0.0, 25.0, 40.0] {
            for y in [-40.0, 0.0, 0.1, 40.0] {
                let ideal = lens.ideal([x, y]).unwrap();
                let back = lens.measured(ideal).unwrap();
                assert!((back[0] - x).hypot(back[1] - y) < 5e-13);
            }
        }
    }

    #[test]
    fn point_beyond_the_fold_has_no_image() {
        // r - D = r + 1e-4·r³ grows for K1 < 0; for K1 > 0 the ideal radius has a maximum.
        let folding = LensMapping::Polynomial(Lens {
            k: [0.0, 1e-4, 0.0, 0.0],
            p: [0.0; 2],
            b: [0.0; 2],
        });
        assert!(folding.measured([30.0, 0.0]).is_some());
        assert_eq!(folding.measured([60.0, 0.0]), None);
        assert_eq!(folding.measured([f64::NAN, 0.0]), None);
    }
}
