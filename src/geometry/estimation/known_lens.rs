//! The static calibration, which an adjustment takes as given.

use super::number::Number;
use super::parameter::PARAMETERS;
use crate::geometry::calibration::Calibration;
use crate::geometry::sensor::FmcAxis;

/// The static calibration from which the corrections of an adjustment are counted.
///
/// K0 to K2 are only starting values: the fitted coefficients replace them. K3, P and B stay, and
/// their displacement is subtracted before the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownLens<T> {
    /// Calibrated principal point (x0, y0), mm.
    pub principal_point_mm: [T; 2],
    /// K0 to K3, mm⁰ to mm⁻⁶.
    pub k: [T; 4],
    /// P1, P2, mm⁻¹.
    pub p: [T; 2],
    /// B1, B2.
    pub b: [T; 2],
    /// Direction in which the principal point moves.
    pub axis: FmcAxis,
    /// ρ, the format radius: from the principal point to the farthest corner, mm.
    pub radius_mm: T,
}

impl KnownLens<f32> {
    /// The lens of a calibration.
    #[must_use]
    pub fn of(calibration: &Calibration) -> Self {
        let parameters = calibration.parameters();
        let pp = parameters.principal_point;
        let lens = &parameters.distortion;
        let reach_x = calibration.sensor().half_width_mm() + pp.x_mm.abs();
        let reach_y = calibration.sensor().half_height_mm() + pp.y_mm.abs();
        Self {
            principal_point_mm: [pp.x_mm, pp.y_mm],
            k: [lens.k0, lens.k1, lens.k2, lens.k3],
            p: [lens.p1, lens.p2],
            b: [lens.b1, lens.b2],
            axis: parameters.axis,
            radius_mm: fmc_camera_kernel::sqrt(reach_x * reach_x + reach_y * reach_y),
        }
    }
}

impl<T: Number> KnownLens<T> {
    /// Returns the static displacement at a point relative to the principal point, mm.
    pub(super) fn displacement(&self, [x, y]: [T; 2]) -> [T; 2] {
        let [k0, k1, k2, k3] = self.k;
        let [p1, p2] = self.p;
        let [b1, b2] = self.b;
        let two = T::of(2.0);
        let r2 = x * x + y * y;
        let radial = k0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let xy = two * (x * y);
        [
            x * radial + p1 * (r2 + two * (x * x)) + p2 * xy + b1 * x + b2 * y,
            y * radial + p2 * (r2 + two * (y * y)) + p1 * xy,
        ]
    }

    /// Returns the values of the parameters from which corrections are counted.
    pub(super) fn starting_values(&self) -> [T; PARAMETERS] {
        let [k0, k1, k2, _] = self.k;
        let [p1, p2] = self.p;
        let decentring = if self.axis.is_x() { p1 } else { p2 };
        [k0, k1, k2, T::ZERO, T::ZERO, decentring]
    }

    /// Returns the divisors that turn corrections in normalised coordinates into powers of mm.
    pub(super) fn scales(&self) -> [T; PARAMETERS] {
        let radius = self.radius_mm;
        let r2 = radius * radius;
        [radius, radius * r2, radius * r2 * r2, r2, r2, r2]
    }
}
