//! Additional parameters: unknowns of self-calibration in which corrected image points are linear,
//! beside the interior orientation.

use nalgebra::Vector2;

use crate::correction::COEFFICIENTS;

/// Distortion of one image point by each additional parameter, mm per unit.
pub type AdditionalColumns = [[f64; 2]; COEFFICIENTS];

/// Returns an image point less the distortion by additional parameters, sensor frame, mm.
///
/// # Model
/// `x - Σ aⱼ·cⱼ`: the part `D·X_ad` of the self-calibrating bundle
/// `V = A·X_ext + B·X_points + C·X_int + D·X_ad - L`, with cⱼ of [`AdditionalColumns`].
#[must_use]
pub fn corrected(point_mm: [f64; 2], columns: &AdditionalColumns, values: &[f64]) -> [f64; 2] {
    let mut corrected = Vector2::from(point_mm);
    for (column, value) in columns.iter().zip(values) {
        corrected -= *value * Vector2::from(*column);
    }
    corrected.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_move_a_point_against_their_distortion() {
        let mut columns = AdditionalColumns::default();
        columns[0] = [2.0, -1.0];
        columns[3] = [0.5, 4.0];
        let values = [0.1, 7.0, 7.0, 0.01, 7.0];
        let [x, y] = corrected([10.0, -5.0], &columns, &values);
        assert!((x - (10.0 - 0.2 - 0.005)).abs() < 1e-15);
        assert!((y - (-5.0 + 0.1 - 0.04)).abs() < 1e-15);
    }
}
