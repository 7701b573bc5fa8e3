//! Formula of the programs that correct measured points, as this project does.

use fmc_reference::lens::Lens;

use crate::calibrated::Calibrated;

/// A camera that gives the ideal point as a function of the measured one.
///
/// # Model
/// With (x̄, ȳ) the measured point from the centre of distortion, and D the polynomial of
/// [`Lens`], measured - ideal, of which the radial part is `R(r²)`:
///
/// ```text
/// ideal = measured - (x̄, ȳ) (1 - (1 - R - K4 r⁸)/(1 + d1 r² + d2 r⁴ + d3 r⁶))
///                  - (decentring, affinity)
/// ```
///
/// # Units and frames
/// mm in the sensor frame, y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Principal distance, mm.
    pub principal_distance_mm: f64,
    /// Principal point, mm.
    pub principal_point_mm: [f64; 2],
    /// Polynomial, measured - ideal.
    pub lens: Lens,
    /// K4, mm⁻⁸.
    pub k4: f64,
    /// Coefficients of r², r⁴, r⁶ in the denominator.
    pub divisor: [f64; 3],
    /// Centre of distortion from the principal point, mm.
    pub offset_mm: [f64; 2],
}

impl Correction {
    /// Returns the formula of the camera itself.
    #[must_use]
    pub const fn of(camera: &Calibrated) -> Self {
        Self {
            principal_distance_mm: camera.principal_distance_mm,
            principal_point_mm: camera.principal_point_mm,
            lens: camera.lens,
            k4: 0.0,
            divisor: [0.0; 3],
            offset_mm: [0.0; 2],
        }
    }

    /// Returns `true` if the formula is the polynomial of a camera file, about the principal point.
    #[must_use]
    pub fn is_polynomial(&self) -> bool {
        let zero = |numbers: &[f64]| numbers.iter().all(|number| number.abs() <= 0.0);
        zero(&self.divisor) && zero(&self.offset_mm) && zero(&[self.k4])
    }

    /// Returns the corrected point about the principal point, mm.
    #[must_use]
    pub fn ideal_from_measured(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [x0, y0] = self.principal_point_mm;
        let [offset_x, offset_y] = self.offset_mm;
        let [x, y] = [x - x0 - offset_x, y - y0 - offset_y];
        let [dx, dy] = self.lens.displacement([x, y]);
        let [d1, d2, d3] = self.divisor;
        let r2 = x * x + y * y;
        let divisor = r2 * (d1 + r2 * (d2 + r2 * d3));
        // Added by K4 and the denominator to the radial part; 0 without them.
        let [k0, k1, k2, k3] = self.lens.k;
        let k4 = self.k4 * r2.powi(4);
        let radial = k0 + r2 * (k1 + r2 * (k2 + r2 * k3)) + k4;
        let more = k4 + (1.0 - radial) * divisor / (1.0 + divisor);
        [offset_x + x - dx - x * more, offset_y + y - dy - y * more]
    }

    /// Returns the ray of a measured point, z = 1, y down.
    #[must_use]
    pub fn ray_from_measured(&self, point_mm: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.ideal_from_measured(point_mm);
        [
            x / self.principal_distance_mm,
            -y / self.principal_distance_mm,
        ]
    }

    /// Returns `true` if all numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.principal_point_mm
            .iter()
            .chain(&self.lens.k)
            .chain(&self.lens.p)
            .chain(&self.lens.b)
            .chain(&self.divisor)
            .chain(&self.offset_mm)
            .chain([&self.principal_distance_mm, &self.k4])
            .all(|number| number.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn denominator_divides_the_radial_part_alone() {
        let correction = Correction {
            principal_distance_mm: 50.0,
            principal_point_mm: [0.5, -0.25],
            lens: Lens {
                k: [0.0, -1e-5, 0.0, 0.0],
                p: [1e-6, 0.0],
                b: [0.0, 0.0],
            },
            k4: 0.0,
            divisor: [1e-4, 0.0, 0.0],
            offset_mm: [0.0, 0.0],
        };
        let [x, y] = correction.ideal_from_measured([20.5, 9.75]);
        let factor = (1.0 + 1e-5 * 500.0) / 1.05;
        let decentring = [1e-6 * (500.0 + 800.0), 1e-6 * 2.0 * 200.0];
        assert!((x - (20.0 * factor - decentring[0])).abs() < 1e-13);
        assert!((y - (10.0 * factor - decentring[1])).abs() < 1e-13);
    }
}
