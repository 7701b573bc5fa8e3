//! Interior orientation and distortion with the derivatives that self-calibration needs.

use fmc_camera_file::CameraFile;
use fmc_reference::lens::Lens;
use nalgebra::{Matrix2, Vector2};

/// Number of elements of the interior orientation that can be estimated.
pub const INTERIOR_ELEMENTS: usize = 10;

/// An element of the interior orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum InteriorElement {
    /// f, mm.
    PrincipalDistance,
    /// x0, mm.
    X0,
    /// y0, mm.
    Y0,
    /// K1, mm⁻².
    K1,
    /// K2, mm⁻⁴.
    K2,
    /// K3, mm⁻⁶.
    K3,
    /// P1, mm⁻¹.
    P1,
    /// P2, mm⁻¹.
    P2,
    /// B1.
    B1,
    /// B2.
    B2,
}

impl InteriorElement {
    /// All elements, in the order of tables.
    pub const ALL: [Self; INTERIOR_ELEMENTS] = [
        Self::PrincipalDistance,
        Self::X0,
        Self::Y0,
        Self::K1,
        Self::K2,
        Self::K3,
        Self::P1,
        Self::P2,
        Self::B1,
        Self::B2,
    ];

    /// Symbol, as on the command line.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::PrincipalDistance => "f",
            Self::X0 => "x0",
            Self::Y0 => "y0",
            Self::K1 => "k1",
            Self::K2 => "k2",
            Self::K3 => "k3",
            Self::P1 => "p1",
            Self::P2 => "p2",
            Self::B1 => "b1",
            Self::B2 => "b2",
        }
    }

    /// Name with unit, as in a summary.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PrincipalDistance => "principal_distance_mm",
            Self::X0 => "x0_mm",
            Self::Y0 => "y0_mm",
            _ => self.symbol(),
        }
    }

    /// Returns the element with a symbol.
    #[must_use]
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|element| element.symbol() == symbol)
    }
}

/// Interior orientation that all images share.
///
/// # Model
/// `ideal = x̄ - D(x̄)`, `x̄ = measured - (x0, y0)`, with D of `docs/conventions.md` section 3: a
/// function of the measured point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interior {
    /// f, mm.
    pub principal_distance_mm: f64,
    /// (x0, y0), mm.
    pub principal_point_mm: [f64; 2],
    /// K0 to K3, mm⁰ to mm⁻⁶.
    pub k: [f64; 4],
    /// P1, P2, mm⁻¹.
    pub p: [f64; 2],
    /// B1, B2.
    pub b: [f64; 2],
}

/// Point from the principal point after correction, and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrectedDerivatives {
    /// Ideal point from the principal point, mm.
    pub ideal_mm: Vector2<f64>,
    /// Derivatives by the elements, in the order of [`InteriorElement::ALL`]; zero for f.
    pub by_element: [Vector2<f64>; INTERIOR_ELEMENTS],
}

impl Interior {
    /// Takes over the interior orientation of a camera file.
    #[must_use]
    pub fn of(camera: &CameraFile) -> Self {
        let lens = Lens::of(camera);
        Self {
            principal_distance_mm: camera.principal_distance_mm,
            principal_point_mm: camera.principal_point_mm,
            k: lens.k,
            p: lens.p,
            b: lens.b,
        }
    }

    /// Value of an element.
    #[must_use]
    pub const fn value(&self, element: InteriorElement) -> f64 {
        let [x0, y0] = self.principal_point_mm;
        let [_, k1, k2, k3] = self.k;
        let ([p1, p2], [b1, b2]) = (self.p, self.b);
        match element {
            InteriorElement::PrincipalDistance => self.principal_distance_mm,
            InteriorElement::X0 => x0,
            InteriorElement::Y0 => y0,
            InteriorElement::K1 => k1,
            InteriorElement::K2 => k2,
            InteriorElement::K3 => k3,
            InteriorElement::P1 => p1,
            InteriorElement::P2 => p2,
            InteriorElement::B1 => b1,
            InteriorElement::B2 => b2,
        }
    }

    /// Changes an element by a step.
    pub const fn add(&mut self, element: InteriorElement, step: f64) {
        let Self {
            principal_distance_mm,
            principal_point_mm: [x0, y0],
            k: [_, k1, k2, k3],
            p: [p1, p2],
            b: [b1, b2],
        } = self;
        let value = match element {
            InteriorElement::PrincipalDistance => principal_distance_mm,
            InteriorElement::X0 => x0,
            InteriorElement::Y0 => y0,
            InteriorElement::K1 => k1,
            InteriorElement::K2 => k2,
            InteriorElement::K3 => k3,
            InteriorElement::P1 => p1,
            InteriorElement::P2 => p2,
            InteriorElement::B1 => b1,
            InteriorElement::B2 => b2,
        };
        *value += step;
    }

    /// Distortion at a point from the principal point, mm.
    #[must_use]
    pub fn distortion(&self, from_pp_mm: [f64; 2]) -> Vector2<f64> {
        let Self { k, p, b, .. } = *self;
        Lens { k, p, b }.displacement(from_pp_mm).into()
    }

    /// Returns the ideal point from the principal point, mm.
    #[must_use]
    pub fn corrected(&self, [x, y]: [f64; 2]) -> Vector2<f64> {
        let [x0, y0] = self.principal_point_mm;
        let about = [x - x0, y - y0];
        Vector2::from(about) - self.distortion(about)
    }

    /// Returns the ideal point with its derivatives.
    ///
    /// # Accuracy
    /// Agrees with central differences to 1e-8 relative
    /// (`derivatives_agree_with_central_differences`).
    #[must_use]
    pub fn corrected_with_derivatives(&self, [x, y]: [f64; 2]) -> CorrectedDerivatives {
        let [x0, y0] = self.principal_point_mm;
        let (x, y) = (x - x0, y - y0);
        let ([k0, k1, k2, k3], [p1, p2], [b1, b2]) = (self.k, self.p, self.b);
        let r2 = x * x + y * y;
        let radial = k0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        // Derivative of the radial factor by r².
        let slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
        let across = 2.0 * x * y * slope + 2.0 * (p1 * y + p2 * x);
        let by_point = Matrix2::new(
            radial + 2.0 * x * x * slope + 6.0 * p1 * x + 2.0 * p2 * y + b1,
            across + b2,
            across,
            radial + 2.0 * y * y * slope + 6.0 * p2 * y + 2.0 * p1 * x,
        ) - Matrix2::identity();
        let point = Vector2::new(x, y);
        CorrectedDerivatives {
            ideal_mm: point - self.distortion([x, y]),
            by_element: [
                Vector2::zeros(),
                by_point.column(0).into_owned(),
                by_point.column(1).into_owned(),
                -r2 * point,
                -r2 * r2 * point,
                -r2 * r2 * r2 * point,
                -Vector2::new(r2 + 2.0 * x * x, 2.0 * x * y),
                -Vector2::new(2.0 * x * y, r2 + 2.0 * y * y),
                Vector2::new(-x, 0.0),
                Vector2::new(-y, 0.0),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_central_differences() {
        let interior = Interior {
            principal_distance_mm: 50.0,
            principal_point_mm: [0.12, -0.2],
            k: [1e-4, -2e-5, 4e-9, 3e-12],
            p: [2e-6, -5e-6],
            b: [3e-4, -2e-4],
        };
        for point in [[20.0, 13.0], [-24.0, 3.0], [1.0, -17.0]] {
            let analytic = interior.corrected_with_derivatives(point);
            assert!((analytic.ideal_mm - interior.corrected(point)).norm() < 1e-14);
            for (element, column) in InteriorElement::ALL.into_iter().zip(analytic.by_element) {
                // Only the derivative by the principal point is not linear.
                let step = if column.norm() > 0.0 {
                    1e-4 / column.norm()
                } else {
                    1.0
                };
                let at = |sign: f64| {
                    let mut moved = interior;
                    moved.add(element, sign * step);
                    moved.corrected(point)
                };
                let numeric = (at(1.0) - at(-1.0)) / (2.0 * step);
                assert!(
                    (numeric - column).norm() <= 1e-8 * column.norm(),
                    "{element:?}"
                );
            }
        }
    }

    #[test]
    fn symbols_are_read_back() {
        for element in InteriorElement::ALL {
            assert_eq!(
                InteriorElement::from_symbol(element.symbol()),
                Some(element)
            );
        }
        assert_eq!(InteriorElement::from_symbol("k0"), None);
    }
}
