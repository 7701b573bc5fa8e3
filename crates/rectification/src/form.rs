//! A frame's correction in double precision, continued beyond the sensor.

use fmc_camera::geometry::gridded_correction::GriddedCorrection;

use crate::matrix::{Matrix, inverse, times};
use crate::placed_spline::PlacedSpline;

/// Length of a Newton step, mm, after which the next would be far below rounding: the second
/// derivative of the distortion times its square.
const LAST_STEP_MM: f64 = 1e-5;

/// Largest number of Newton steps to a source.
const MAX_STEPS: usize = 12;

/// The evaluation form of a frame with all its terms and its residual grids, in double precision.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Form {
    centre: [f64; 2],
    k: [f64; 4],
    h: [f64; 2],
    g: [f64; 2],
    b: [f64; 2],
    t: [f64; 2],
    residual: Vec<PlacedSpline>,
}

/// Bounds of the residual grids, anywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ResidualBounds {
    /// Of their derivatives.
    pub(crate) slope: f64,
    /// Of their second derivatives, mm⁻¹.
    pub(crate) curvature: f64,
}

impl Form {
    pub(crate) fn new(correction: &GriddedCorrection<'_>) -> Self {
        let polynomial = correction.polynomial();
        let (form, centre) = (polynomial.form(), polynomial.centre());
        let grids = [correction.lens(), correction.sensor()];
        Self {
            centre: [centre.x_mm, centre.y_mm].map(f64::from),
            k: [form.k0, form.k1, form.k2, form.k3].map(f64::from),
            h: [form.hx, form.hy].map(f64::from),
            g: [form.gx, form.gy].map(f64::from),
            b: [form.b1, form.b2].map(f64::from),
            t: [form.tx, form.ty].map(f64::from),
            residual: grids.into_iter().flatten().map(PlacedSpline::of).collect(),
        }
    }

    /// Returns a point from the centre and the square of its distance.
    pub(crate) fn centred(&self, [x, y]: [f64; 2]) -> ([f64; 2], f64) {
        let (x, y) = (x - self.centre[0], y - self.centre[1]);
        ([x, y], x * x + y * y)
    }

    fn gain(&self, [x, y]: [f64; 2], r2: f64) -> f64 {
        let [k0, k1, k2, k3] = self.k;
        k0 + r2 * (k1 + r2 * (k2 + r2 * k3)) + self.h[0] * x + self.h[1] * y
    }

    /// Returns 2G', the derivative of the radial terms by r² twice, and 4G''.
    fn slopes(&self, r2: f64) -> [f64; 2] {
        let [_, k1, k2, k3] = self.k;
        [
            2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3)),
            4.0 * (2.0 * k2 + r2 * 6.0 * k3),
        ]
    }

    /// Returns the distortion of a measured point by the polynomial, mm.
    fn polynomial(&self, measured: [f64; 2]) -> [f64; 2] {
        let ([x, y], r2) = self.centred(measured);
        let gain = self.gain([x, y], r2);
        [
            x * gain + self.g[0] * r2 + self.b[0] * x + self.b[1] * y + self.t[0],
            y * gain + self.g[1] * r2 + self.t[1],
        ]
    }

    /// Returns the distortion of a measured point, measured - ideal, mm.
    pub(crate) fn distortion(&self, measured: [f64; 2]) -> [f64; 2] {
        let mut sum = self.polynomial(measured);
        for grid in &self.residual {
            let ([dx, dy], _) = grid.at(measured);
            sum = [sum[0] + dx, sum[1] + dy];
        }
        sum
    }

    /// Returns the distortion of a measured point, mm, and its derivatives.
    pub(crate) fn with_jacobian(&self, measured: [f64; 2]) -> ([f64; 2], Matrix) {
        let mut distortion = self.polynomial(measured);
        let mut jacobian = self.polynomial_jacobian(measured);
        for grid in &self.residual {
            let ([dx, dy], of_grid) = grid.at(measured);
            distortion = [distortion[0] + dx, distortion[1] + dy];
            for (sum, of_grid) in jacobian.iter_mut().flatten().zip(of_grid.iter().flatten()) {
                *sum += of_grid;
            }
        }
        (distortion, jacobian)
    }

    /// Returns the bounds of the residual grids together.
    pub(crate) fn residual_bounds(&self) -> ResidualBounds {
        let sum = |of: fn(&PlacedSpline) -> f64| self.residual.iter().map(of).sum();
        ResidualBounds {
            slope: sum(PlacedSpline::slope),
            curvature: sum(PlacedSpline::curvature),
        }
    }

    /// Returns the derivatives of the polynomial at a measured point.
    pub(crate) fn polynomial_jacobian(&self, measured: [f64; 2]) -> Matrix {
        let ([x, y], r2) = self.centred(measured);
        let gain = self.gain([x, y], r2);
        let [slope, _] = self.slopes(r2);
        let by = [slope * x + self.h[0], slope * y + self.h[1]];
        [
            [
                gain + x * by[0] + 2.0 * self.g[0] * x + self.b[0],
                x * by[1] + 2.0 * self.g[0] * y + self.b[1],
            ],
            [
                y * by[0] + 2.0 * self.g[1] * x,
                gain + y * by[1] + 2.0 * self.g[1] * y,
            ],
        ]
    }

    /// Returns the second derivative of the polynomial at a measured point, twice along `u`, mm⁻¹.
    pub(crate) fn second_derivative(&self, measured: [f64; 2], u: [f64; 2]) -> [f64; 2] {
        let ([x, y], r2) = self.centred(measured);
        let [slope, bend] = self.slopes(r2);
        let along = x * u[0] + y * u[1];
        let u2 = u[0] * u[0] + u[1] * u[1];
        // D = X·G + g·R + …: 2u·(∇G·u) + X·(u·∇²G·u) + g·2u².
        let gain_along = slope * along + self.h[0] * u[0] + self.h[1] * u[1];
        let gain_twice = slope * u2 + bend * along * along;
        [
            2.0 * u[0] * gain_along + x * gain_twice + 2.0 * self.g[0] * u2,
            2.0 * u[1] * gain_along + y * gain_twice + 2.0 * self.g[1] * u2,
        ]
    }

    /// Returns the largest second and third derivatives of the polynomial, in any direction, within
    /// a radius of the centre, mm⁻¹ and mm⁻².
    ///
    /// # Model
    /// The k-th derivative of `(X, Y)·Rⁿ` is at most (2n+1)!/(2n+1-k)!·r²ⁿ⁺¹⁻ᵏ, because the norm of
    /// a symmetric multilinear map is reached on the diagonal (Banach 1938).
    pub(crate) fn largest_derivatives(&self, radius: f64) -> [f64; 2] {
        let [_, k1, k2, k3] = self.k.map(f64::abs);
        let r2 = radius * radius;
        let beside: f64 = self.h.iter().chain(&self.g).map(|value| value.abs()).sum();
        [
            radius * (6.0 * k1 + r2 * (20.0 * k2 + r2 * 42.0 * k3)) + 2.0 * beside,
            6.0 * k1 + r2 * (60.0 * k2 + r2 * 210.0 * k3),
        ]
    }

    /// Returns the ideal point of a measured one, mm.
    pub(crate) fn ideal(&self, measured: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = self.distortion(measured);
        [measured[0] - dx, measured[1] - dy]
    }

    /// Returns the way from an ideal point to its measured one, mm, by Newton's method; `None`
    /// where it does not end.
    pub(crate) fn source(&self, ideal: [f64; 2], start: [f64; 2]) -> Option<[f64; 2]> {
        let mut d = start;
        for _ in 0..MAX_STEPS {
            let measured = [ideal[0] + d[0], ideal[1] + d[1]];
            let (distortion, jacobian) = self.with_jacobian(measured);
            let residual = [d[0] - distortion[0], d[1] - distortion[1]];
            let inverse = inverse(jacobian)?;
            let step = times(inverse, residual);
            d = [d[0] - step[0], d[1] - step[1]];
            let length = step[0].abs() + step[1].abs();
            if length <= LAST_STEP_MM {
                return Some(d);
            }
        }
        None
    }
}
