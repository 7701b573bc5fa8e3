//! Pinhole camera with affinity and distortion, and its decomposition from a projection matrix.

use fmc_camera_file::static_block::StaticCalibration;
use fmc_camera_file::{CameraFile, DistortionTable};
use nalgebra::{Matrix3, Matrix3x4, Vector3};

/// Names of the interior unknowns in the order of [`Pinhole::interior`].
pub const INTERIOR_NAMES: [&str; 10] = [
    "principal_distance_mm",
    "x0_mm",
    "y0_mm",
    "b1",
    "b2",
    "k1",
    "k2",
    "k3",
    "p1",
    "p2",
];

/// Number of unknowns of a direct linear transformation: f, x0, y0, B1, B2, position, attitude.
pub const ELEVEN: usize = 11;

/// A camera with its position and attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// f, mm.
    pub principal_distance_mm: f64,
    /// (x0, y0), mm.
    pub principal_point_mm: [f64; 2],
    /// B1, B2.
    pub affinity: [f64; 2],
    /// K1, K2, K3.
    pub radial: [f64; 3],
    /// P1, P2.
    pub decentring: [f64; 2],
    /// S, m.
    pub centre_m: Vector3<f64>,
    /// Rows R1, R2, R3.
    pub camera_from_ground: Matrix3<f64>,
}

/// A fault of a projection matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Improper {
    /// The image is a mirror image.
    Mirrored,
    /// There is no finite camera.
    Degenerate,
}

impl Pinhole {
    /// Decomposes the first three columns of a projection matrix, rows r1, r2, r3; `forward` is a
    /// vector from the centre to a point in front of it.
    ///
    /// # Model
    /// `docs/calibration.md`, with q = r3·r3: x0 = r1·r3/q, y0 = r2·r3/q, A = r1·r1/q - x0²,
    /// B = r2·r2/q - y0², C = r1·r2/q - x0·y0, sinβ = -C/√(AB), fx = √A·cosβ, fy = √B;
    /// f = fy, B1 = 1 - fy/fx, B2 = -tanβ.
    ///
    /// # Errors
    /// [`Improper`] for a mirror image, and a matrix that is no camera's.
    #[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
    pub fn decompose(
        matrix: &Matrix3<f64>,
        centre_m: Vector3<f64>,
        forward: &Vector3<f64>,
    ) -> Result<Self, Improper> {
        let [r1, r2, r3] = [0, 1, 2].map(|row| matrix.row(row).transpose());
        let q = r3.norm_squared();
        let (x0, y0) = (r1.dot(&r3) / q, r2.dot(&r3) / q);
        // A, B and C from the parts of r1 and r2 perpendicular to r3, which a principal point far
        // away does not cancel.
        let (u, v) = (r1 - r3 * x0, r2 - r3 * y0);
        let (a, b, c) = (u.norm_squared() / q, v.norm_squared() / q, u.dot(&v) / q);
        let sine = -c / (a * b).sqrt();
        let cosine = (1.0 - sine * sine).sqrt();
        let tangent = sine / cosine;
        let (fx, fy) = (a.sqrt() * cosine, b.sqrt());
        if !(q > 0.0 && fx > 0.0 && fy > 0.0 && tangent.is_finite()) {
            return Err(Improper::Degenerate);
        }
        let s = if r3.dot(forward) < 0.0 { 1.0 } else { -1.0 } / q.sqrt();
        let third = r3 * s;
        let second = -v * (s / fy);
        let first = -u * (s / fx) + second * tangent;
        let rotation =
            Matrix3::from_rows(&[first.transpose(), second.transpose(), third.transpose()]);
        if rotation.determinant() < 0.0 {
            return Err(Improper::Mirrored);
        }
        Ok(Self {
            principal_distance_mm: fy,
            principal_point_mm: [x0, y0],
            affinity: [1.0 - fy / fx, -tangent],
            radial: [0.0; 3],
            decentring: [0.0; 2],
            centre_m,
            camera_from_ground: orthonormal(&rotation),
        })
    }

    /// Returns the projection matrix, ground metres to corrected coordinates in mm: without radial
    /// and decentring distortion, with affinity.
    #[must_use]
    pub fn projection_matrix(&self) -> Matrix3x4<f64> {
        let [first, second, third] = [0, 1, 2].map(|row| self.camera_from_ground.row(row));
        let [x0, y0] = self.principal_point_mm;
        let [b1, b2] = self.affinity;
        let f = self.principal_distance_mm;
        let r1 = third * x0 - (first + second * b2) * (f / (1.0 - b1));
        let r2 = third * y0 - second * f;
        let left = Matrix3::from_rows(&[r1, r2, third.into_owned()]);
        let last = -left * self.centre_m;
        Matrix3x4::from_columns(&[
            left.column(0).into_owned(),
            left.column(1).into_owned(),
            left.column(2).into_owned(),
            last,
        ])
    }

    /// Returns l1 to l11 of `x + (l1·X + l2·Y + l3·Z + l4)/(l9·X + l10·Y + l11·Z + 1) = 0`, y with
    /// l5 to l8; `None` if the origin of the object frame lies in the principal plane.
    #[must_use]
    #[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
    pub fn eleven(&self) -> Option<[f64; ELEVEN]> {
        let m = self.projection_matrix();
        let [[a, e, i], [b, f, j], [c, g, k], [d, h, last]] = m.data.0;
        let size = m.row(2).norm();
        (last.abs() > 1e-9 * size)
            .then(|| [-a, -b, -c, -d, -e, -f, -g, -h, i, j, k].map(|element| element / last))
    }

    /// Returns pitch, roll, yaw, rad: `ground_from_camera = Rz(yaw)·Rx(pitch)·Ry(roll)`.
    #[must_use]
    pub fn attitude(&self) -> [f64; 3] {
        // Rows of camera_from_ground are columns of ground_from_camera.
        let [[_, x1, _], [_, y1, _], [z0, z1, z2]] = self.camera_from_ground.data.0;
        [z1.clamp(-1.0, 1.0).asin(), (-z0).atan2(z2), (-x1).atan2(y1)]
    }

    /// Values in the order of [`INTERIOR_NAMES`].
    #[must_use]
    pub fn interior(&self) -> [f64; 10] {
        let [x0, y0] = self.principal_point_mm;
        let [b1, b2] = self.affinity;
        let [k1, k2, k3] = self.radial;
        let [p1, p2] = self.decentring;
        [
            self.principal_distance_mm,
            x0,
            y0,
            b1,
            b2,
            k1,
            k2,
            k3,
            p1,
            p2,
        ]
    }

    /// Returns the static calibration, without K0 and run-out.
    #[must_use]
    pub fn calibration(&self) -> StaticCalibration {
        let [k1, k2, k3] = self.radial;
        let [p1, p2] = self.decentring;
        let [b1, b2] = self.affinity;
        StaticCalibration {
            principal_distance_mm: self.principal_distance_mm,
            principal_point_mm: self.principal_point_mm,
            distortion: DistortionTable {
                k1,
                k2,
                k3,
                p1,
                p2,
                b1,
                b2,
                ..DistortionTable::default()
            },
            flatness_um: None,
        }
    }

    /// Radial and decentring distortion at a point relative to the principal point, mm, with its
    /// derivatives by x̄ and ȳ, rows of x and y.
    #[must_use]
    pub fn radial_and_decentring(&self, [x, y]: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        let [k1, k2, k3] = self.radial;
        let [p1, p2] = self.decentring;
        let square = x * x + y * y;
        let g = square * (k1 + square * (k2 + square * k3));
        // 2·dg/d(r²)
        let slope = 2.0 * (k1 + square * (2.0 * k2 + square * 3.0 * k3));
        let value = [
            x * g + p1 * (square + 2.0 * x * x) + 2.0 * p2 * x * y,
            y * g + p2 * (square + 2.0 * y * y) + 2.0 * p1 * x * y,
        ];
        let mixed = x * y * slope + 2.0 * p1 * y + 2.0 * p2 * x;
        let derivatives = [
            [g + x * x * slope + 6.0 * p1 * x + 2.0 * p2 * y, mixed],
            [mixed, g + y * y * slope + 6.0 * p2 * y + 2.0 * p1 * x],
        ];
        (value, derivatives)
    }

    /// Derivatives of the distortion at a point relative to the principal point by K1, K2, K3, P1,
    /// P2, of x and of y.
    #[must_use]
    pub fn by_coefficients([x, y]: [f64; 2]) -> [[f64; 2]; 5] {
        let square = x * x + y * y;
        [
            [x * square, y * square],
            [x * square.powi(2), y * square.powi(2)],
            [x * square.powi(3), y * square.powi(3)],
            [square + 2.0 * x * x, 2.0 * x * y],
            [2.0 * x * y, square + 2.0 * y * y],
        ]
    }

    /// Adds to the coefficient of a place in K1, K2, K3, P1, P2.
    pub(in crate::calibration) fn add(&mut self, index: usize, change: f64) -> Option<()> {
        *match index {
            0..3 => self.radial.get_mut(index)?,
            _ => self.decentring.get_mut(index - 3)?,
        } += change;
        Some(())
    }

    /// Returns the lens of a camera file at the origin; coefficients that are estimated are zero.
    #[must_use]
    pub fn lens(camera: &CameraFile, is_estimated: [bool; 5]) -> Self {
        let held = camera.distortion.measured_minus_ideal();
        let kept = [held.k1, held.k2, held.k3, held.p1, held.p2];
        let mut lens = Self {
            principal_distance_mm: camera.principal_distance_mm,
            principal_point_mm: camera.principal_point_mm,
            affinity: [0.0; 2],
            radial: [0.0; 3],
            decentring: [0.0; 2],
            centre_m: Vector3::zeros(),
            camera_from_ground: Matrix3::identity(),
        };
        for (index, (value, is_estimated)) in kept.into_iter().zip(is_estimated).enumerate() {
            if !is_estimated {
                lens.add(index, value);
            }
        }
        lens
    }

    /// Returns the direction of a ground point in camera axes, m.
    #[must_use]
    pub fn in_camera(&self, ground_m: &Vector3<f64>) -> Vector3<f64> {
        self.camera_from_ground * (ground_m - self.centre_m)
    }
}

fn orthonormal(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = matrix.svd(true, true);
    match (svd.u, svd.v_t) {
        (Some(u), Some(vt)) => u * vt,
        _ => *matrix,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn decomposition_returns_the_camera() {
        let camera = Pinhole {
            principal_distance_mm: 51.3712,
            principal_point_mm: [0.0584, -0.0239],
            affinity: [1.5e-3, -4e-4],
            radial: [0.0; 3],
            decentring: [0.0; 2],
            centre_m: Vector3::new(1.0, -2.0, 6.5),
            camera_from_ground: Rotation3::from_euler_angles(0.3, -0.2, 1.1).into_inner(),
        };
        let m = camera.projection_matrix();
        let left = m.fixed_columns::<3>(0).into_owned();
        let forward = -camera.camera_from_ground.row(2).transpose();
        for scale in [1.0, -3.7] {
            let found = Pinhole::decompose(&(left * scale), camera.centre_m, &forward).unwrap();
            assert!((found.principal_distance_mm - 51.3712).abs() < 1e-12);
            for (a, b) in found.interior().into_iter().zip(camera.interior()) {
                assert!((a - b).abs() < 1e-12, "{a} {b}");
            }
            assert!((found.camera_from_ground - camera.camera_from_ground).amax() < 1e-14);
        }
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
        assert_eq!(
            Pinhole::decompose(&(mirror * left), camera.centre_m, &forward),
            Err(Improper::Mirrored)
        );
    }

    #[test]
    fn attitude_is_that_of_the_exterior_orientation() {
        use crate::exterior_orientation::ExteriorOrientation;
        let orientation = ExteriorOrientation {
            position_m: [0.0; 3],
            attitude: [0.4, -0.7, 2.2],
        };
        let camera = Pinhole {
            principal_distance_mm: 50.0,
            principal_point_mm: [0.0; 2],
            affinity: [0.0; 2],
            radial: [0.0; 3],
            decentring: [0.0; 2],
            centre_m: Vector3::zeros(),
            camera_from_ground: orientation.ground_from_camera().transpose(),
        };
        for (a, b) in camera.attitude().into_iter().zip(orientation.attitude) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
    }
}
