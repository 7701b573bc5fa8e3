//! Difference between two cameras over the sensor.

/// Difference over the points of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Residual {
    /// Largest difference along x or along y, µm.
    pub largest_um: f64,
    /// Root of the mean square over both axes, µm.
    pub rms_um: f64,
    /// Place of the largest, mm in the sensor frame.
    pub at_mm: [f64; 2],
}

impl Residual {
    /// Returns the residual of differences in mm, each with its place; a difference that is not a
    /// number makes it infinite.
    pub(crate) fn of(differences: impl IntoIterator<Item = ([f64; 2], [f64; 2])>) -> Self {
        let mut residual = Self::default();
        let mut count = 0.0_f64;
        let mut squares = 0.0;
        for (place, difference) in differences {
            for component in difference.map(|mm| (1e3 * mm).abs()) {
                let component = if component.is_nan() {
                    f64::INFINITY
                } else {
                    component
                };
                if component > residual.largest_um {
                    residual.largest_um = component;
                    residual.at_mm = place;
                }
                squares += component * component;
                count += 1.0;
            }
        }
        residual.rms_um = (squares / count.max(1.0)).sqrt();
        residual
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_is_of_one_axis_and_rms_of_both() {
        let residual = Residual::of([([1.0, 2.0], [3e-3, -4e-3]), ([5.0, 6.0], [0.0, 0.0])]);
        assert!((residual.largest_um - 4.0).abs() < 1e-12);
        assert!((residual.rms_um - 2.5).abs() < 1e-12);
        assert_eq!(
            residual.at_mm.map(f64::to_bits),
            [1.0, 2.0].map(f64::to_bits)
        );
        let none = Residual::of([([0.0, 0.0], [f64::NAN, 0.0])]);
        assert!(none.largest_um.is_infinite());
    }
}
