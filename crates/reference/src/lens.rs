//! Static distortion polynomial in double precision.

use fmc_camera_file::CameraFile;

/// Static distortion, measured - ideal, about the principal point; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// K0..K3, mm⁻²ᵏ.
    pub k: [f64; 4],
    /// P1, P2, mm⁻¹; P1 goes with x̄².
    pub p: [f64; 2],
    /// B1, B2.
    pub b: [f64; 2],
}

impl Lens {
    /// Returns the lens of a camera file.
    #[must_use]
    pub fn of(camera: &CameraFile) -> Self {
        let table = camera.distortion.measured_minus_ideal();
        Self {
            k: [table.k0, table.k1, table.k2, table.k3],
            p: [table.p1, table.p2],
            b: [table.b1, table.b2],
        }
    }

    /// Returns the displacement at a point from the principal point, mm.
    ///
    /// # Model
    /// Yuan et al. 2012, eq. 1, with Brown's decentring and affinity, term by term as written.
    #[must_use]
    pub fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [k0, k1, k2, k3] = self.k;
        let [p1, p2] = self.p;
        let [b1, b2] = self.b;
        let r2 = x * x + y * y;
        let radial = k0 + k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
        [
            x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y + b1 * x + b2 * y,
            y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y,
        ]
    }

    /// Returns the derivative of the displacement along the direction `e`.
    #[must_use]
    pub fn derivative(&self, [x, y]: [f64; 2], [ex, ey]: [f64; 2]) -> [f64; 2] {
        let [k0, k1, k2, k3] = self.k;
        let [p1, p2] = self.p;
        let [b1, b2] = self.b;
        let r2 = x * x + y * y;
        let r2_along = 2.0 * (x * ex + y * ey);
        let radial = k0 + k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
        let radial_along = r2_along * (k1 + 2.0 * k2 * r2 + 3.0 * k3 * r2.powi(2));
        let xy_along = ex * y + x * ey;
        [
            ex * radial
                + x * radial_along
                + p1 * (r2_along + 4.0 * x * ex)
                + 2.0 * p2 * xy_along
                + b1 * ex
                + b2 * ey,
            ey * radial + y * radial_along + p2 * (r2_along + 4.0 * y * ey) + 2.0 * p1 * xy_along,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivative_is_the_limit_of_differences() {
        let lens = Lens {
            k: [1e-3, -2e-5, 5e-9, -1e-12],
            p: [3e-6, -4e-6],
            b: [2e-5, -1e-5],
        };
        let (point, e, step) = ([17.0, -11.0], [0.6, 0.8], 1e-4);
        let at = |s: f64| lens.displacement([point[0] + s * e[0], point[1] + s * e[1]]);
        let (plus, minus) = (at(step), at(-step));
        let derivative = lens.derivative(point, e);
        for axis in 0..2 {
            let difference = (plus[axis] - minus[axis]) / (2.0 * step);
            assert!((difference - derivative[axis]).abs() < 1e-10);
        }
    }
}
