//! Formula of the programs that distort rays: `OpenCV` and those that count like it.

use crate::scalar::Scalar;

/// A camera that gives the measured point as a function of the ideal ray.
///
/// # Model
/// With the ray (X, Y), z = 1, y down, X and Y from the centre of distortion, r² = X² + Y²:
///
/// ```text
/// g  = (1 + k1 r² + k2 r⁴ + k3 r⁶ + k4 r⁸) / (1 + d1 r² + d2 r⁴ + d3 r⁶)
/// x" = X g + 2 p1 XY + p2 (r² + 2X²) + s1 r² + s2 r⁴ + a1 X + a2 Y
/// y" = Y g + p1 (r² + 2Y²) + 2 p2 XY + s3 r² + s4 r⁴
/// u = cx + fx x" + skew y"          v = cy + fy y"
/// ```
///
/// and a tilt of the detector between the last two, as `OpenCV`'s calibration module documents it
/// (k4, k5, k6 there are d1, d2, d3 here).
///
/// # Units and frames
/// Pixels, column to the right, row down, first pixel centre at (0, 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole<T = f64> {
    /// Principal distances fx and fy, px.
    pub focal_px: [T; 2],
    /// Skew: columns per unit of y", px.
    pub skew_px: T,
    /// Principal point cx, cy, px.
    pub centre_px: [T; 2],
    /// Coefficients of r², r⁴, r⁶, r⁸.
    pub radial: [T; 4],
    /// Coefficients of r², r⁴, r⁶ in the denominator.
    pub divisor: [T; 3],
    /// p1, p2; p2 goes with X².
    pub decentring: [T; 2],
    /// Thin prism s1..s4.
    pub prism: [T; 4],
    /// Tilt of the detector τx, τy, rad.
    pub tilt: [T; 2],
    /// Affinity and shear of the ray, a1, a2.
    pub affine: [T; 2],
    /// Ray of the centre of distortion, if it is not the principal point.
    pub offset: [T; 2],
}

impl Pinhole {
    /// Returns a camera without distortion.
    #[must_use]
    pub const fn ideal(focal_px: f64, centre_px: [f64; 2]) -> Self {
        Self {
            focal_px: [focal_px; 2],
            skew_px: 0.0,
            centre_px,
            radial: [0.0; 4],
            divisor: [0.0; 3],
            decentring: [0.0; 2],
            prism: [0.0; 4],
            tilt: [0.0; 2],
            affine: [0.0; 2],
            offset: [0.0; 2],
        }
    }

    /// Returns the measured point of a ray, px.
    #[must_use]
    pub fn pixel_from_ray(&self, ray: [f64; 2]) -> [f64; 2] {
        self.project(ray)
    }

    /// Returns `true` if all numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let mut is_finite = true;
        let _ = self.map(|number| is_finite &= number.is_finite());
        is_finite
    }
}

impl<T: Copy> Pinhole<T> {
    /// Returns the camera with every number converted.
    pub(crate) fn map<U>(&self, mut convert: impl FnMut(T) -> U) -> Pinhole<U> {
        Pinhole {
            focal_px: self.focal_px.map(&mut convert),
            skew_px: convert(self.skew_px),
            centre_px: self.centre_px.map(&mut convert),
            radial: self.radial.map(&mut convert),
            divisor: self.divisor.map(&mut convert),
            decentring: self.decentring.map(&mut convert),
            prism: self.prism.map(&mut convert),
            tilt: self.tilt.map(&mut convert),
            affine: self.affine.map(&mut convert),
            offset: self.offset.map(&mut convert),
        }
    }
}

#[expect(
    private_bounds,
    reason = "only this crate evaluates the formula for anything but f64"
)]
impl<T: Scalar> Pinhole<T> {
    /// Returns the measured point of a ray, px.
    pub(crate) fn project(&self, ray: [T; 2]) -> [T; 2] {
        let [x, y] = self.distorted(ray);
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        [cx + fx * x + self.skew_px * y, cy + fy * y]
    }

    /// Returns x", y".
    pub(crate) fn distorted(&self, [x, y]: [T; 2]) -> [T; 2] {
        let one = T::constant(1.0);
        let two = T::constant(2.0);
        let [offset_x, offset_y] = self.offset;
        let [x, y] = [x - offset_x, y - offset_y];
        let [r2, xy] = [x.squared() + y.squared(), x * y];
        let r4 = r2.squared();
        let g = self.numerator(r2) / self.denominator(r2);
        let [p1, p2] = self.decentring;
        let [s1, s2, s3, s4] = self.prism;
        let [a1, a2] = self.affine;
        let bent_x = x * g
            + two * p1 * xy
            + p2 * (r2 + two * x.squared())
            + s1 * r2
            + s2 * r4
            + a1 * x
            + a2 * y;
        let bent_y = y * g + p1 * (r2 + two * y.squared()) + two * p2 * xy + s3 * r2 + s4 * r4;
        // The product of the two rotations and the projection on the tilted plane, multiplied out.
        let [(sx, cx), (sy, cy)] = self.tilt.map(Scalar::sin_cos);
        let depth = sy * bent_x - cy * sx * bent_y + cx * cy * one;
        [
            offset_x + cx * bent_x / depth,
            offset_y + (cy * bent_y - sx * sy * bent_x) / depth,
        ]
    }

    fn numerator(&self, r2: T) -> T {
        let [k1, k2, k3, k4] = self.radial;
        T::constant(1.0) + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4)))
    }

    /// Returns the denominator of the radial quotient at r².
    pub(crate) fn denominator(&self, r2: T) -> T {
        let [d1, d2, d3] = self.divisor;
        T::constant(1.0) + r2 * (d1 + r2 * (d2 + r2 * d3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `OpenCV`'s matrices, multiplied here and not there.
    fn tilted([x, y]: [f64; 2], [tau_x, tau_y]: [f64; 2]) -> [f64; 2] {
        let ((sx, cx), (sy, cy)) = (tau_x.sin_cos(), tau_y.sin_cos());
        let about_x = [[1.0, 0.0, 0.0], [0.0, cx, sx], [0.0, -sx, cx]];
        let about_y = [[cy, 0.0, -sy], [0.0, 1.0, 0.0], [sy, 0.0, cy]];
        let product = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| {
            let cell = |i: usize, j: usize| (0..3).map(|k| a[i][k] * b[k][j]).sum::<f64>();
            [0, 1, 2].map(|i| [0, 1, 2].map(|j| cell(i, j)))
        };
        let r = product(about_y, about_x);
        let projection = [
            [r[2][2], 0.0, -r[0][2]],
            [0.0, r[2][2], -r[1][2]],
            [0.0, 0.0, 1.0],
        ];
        let along = |row: [f64; 3]| row[0] * x + row[1] * y + row[2];
        let [col, row, depth] = product(projection, r).map(along);
        [col / depth, row / depth]
    }

    #[test]
    fn tilt_is_the_product_of_the_matrices() {
        let mut camera = Pinhole::ideal(1.0, [0.0, 0.0]);
        camera.tilt = [0.02, -0.03];
        let [u, v] = camera.pixel_from_ray([0.4, -0.3]);
        let [x, y] = tilted([0.4, -0.3], camera.tilt);
        assert!((u - x).abs() < 1e-15 && (v - y).abs() < 1e-15);
    }

    #[test]
    fn each_term_is_where_the_formula_has_it() {
        let at = |change: fn(&mut Pinhole)| {
            let mut camera = Pinhole::ideal(100.0, [10.0, 20.0]);
            change(&mut camera);
            camera.pixel_from_ray([0.3, -0.2])
        };
        let (x, y, r2) = (0.3, -0.2, 0.13);
        for (found, [dx, dy]) in [
            (
                at(|c| c.radial[3] = 0.1),
                [x * 0.1 * r2 * r2 * r2 * r2, y * 0.1 * r2 * r2 * r2 * r2],
            ),
            (at(|c| c.divisor[0] = 0.1), [x / 1.013 - x, y / 1.013 - y]),
            (
                at(|c| c.decentring[0] = 0.1),
                [0.2 * x * y, 0.1 * (r2 + 2.0 * y * y)],
            ),
            (
                at(|c| c.decentring[1] = 0.1),
                [0.1 * (r2 + 2.0 * x * x), 0.2 * x * y],
            ),
            (at(|c| c.prism[1] = 0.1), [0.1 * r2 * r2, 0.0]),
            (at(|c| c.prism[2] = 0.1), [0.0, 0.1 * r2]),
            (at(|c| c.affine[1] = 0.1), [0.1 * y, 0.0]),
            (at(|c| c.skew_px = 10.0), [0.1 * y, 0.0]),
            (at(|c| c.offset = [0.5, 0.5]), [0.0, 0.0]),
        ] {
            let [u, v] = found;
            assert!((u - (10.0 + 100.0 * (x + dx))).abs() < 1e-12, "{found:?}");
            assert!((v - (20.0 + 100.0 * (y + dy))).abs() < 1e-12, "{found:?}");
        }
    }
}
