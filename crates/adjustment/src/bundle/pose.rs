//! Position and attitude of an image, whatever its attitude.

use nalgebra::{Matrix3, Rotation3, Vector3, Vector6};

use crate::exterior_orientation::ExteriorOrientation;

/// Cosine of the pitch below which roll and yaw cannot be told apart.
const LEAST_COSINE: f64 = 1e-6;

/// Sine of a rotation below which the angle is the sine, or half a turn less it.
const LEAST_SINE: f64 = 1e-8;

/// Projection centre and rotation of an image.
///
/// # Model
/// Steps of the attitude are rotation vectors w about the ground axes, `R → exp(w)·R`: they have no
/// singular attitude, unlike pitch, roll and yaw, and a rotation of the ground is the same w for
/// all images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Projection centre, ground frame, m.
    pub position_m: Vector3<f64>,
    /// `ground_from_camera`.
    pub rotation: Rotation3<f64>,
}

impl From<ExteriorOrientation> for Pose {
    fn from(orientation: ExteriorOrientation) -> Self {
        Self {
            position_m: orientation.position(),
            rotation: Rotation3::from_matrix_unchecked(orientation.ground_from_camera()),
        }
    }
}

impl Pose {
    /// Returns position and attitude in pitch, roll and yaw.
    #[must_use]
    pub fn orientation(&self) -> ExteriorOrientation {
        let r = self.rotation.matrix();
        let pitch = r.m32.atan2(r.m31.hypot(r.m33));
        // At a pitch of 90° the roll is set to zero.
        let (roll, yaw) = if r.m31.hypot(r.m33) < LEAST_COSINE {
            (0.0, r.m21.atan2(r.m11))
        } else {
            ((-r.m31).atan2(r.m33), (-r.m12).atan2(r.m22))
        };
        ExteriorOrientation {
            position_m: self.position_m.into(),
            attitude: [pitch, roll, yaw],
        }
    }

    /// Derivatives of pitch, roll and yaw by the rotation vector; `None` at a pitch of 90°.
    #[must_use]
    pub fn angles_by_rotation(&self) -> Option<Matrix3<f64>> {
        let [pitch, _, yaw] = self.orientation().attitude;
        let (sin_yaw, cos_yaw) = yaw.sin_cos();
        let (sin_pitch, cos_pitch) = pitch.sin_cos();
        if cos_pitch < LEAST_COSINE {
            return None;
        }
        // Axes of pitch, roll and yaw in the ground frame: w = Σ axis·dangle.
        Matrix3::from_columns(&[
            Vector3::new(cos_yaw, sin_yaw, 0.0),
            Vector3::new(-sin_yaw * cos_pitch, cos_yaw * cos_pitch, sin_pitch),
            Vector3::z(),
        ])
        .try_inverse()
    }

    /// Moves the position by the first three and turns the attitude by the last three elements.
    #[must_use]
    pub fn moved(&self, step: &Vector6<f64>) -> Self {
        let turn = Rotation3::from_scaled_axis(step.fixed_rows::<3>(3).into_owned());
        let mut rotation = turn * self.rotation;
        rotation.renormalize();
        Self {
            position_m: self.position_m + step.fixed_rows::<3>(0),
            rotation,
        }
    }

    /// Returns a ground point in camera axes, m.
    #[must_use]
    pub fn in_camera(&self, ground_m: &Vector3<f64>) -> Vector3<f64> {
        self.rotation
            .inverse_transform_vector(&(ground_m - self.position_m))
    }
}

/// Returns the vector w of a rotation exp(w), of less than half a turn.
///
/// # Accuracy
/// That of the matrix also for small rotations, of which the trace alone has lost half of the
/// digits (`small_rotation_keeps_its_digits`).
#[must_use]
pub fn rotation_vector(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let r = rotation.matrix();
    let twice_sine = Vector3::new(r.m32 - r.m23, r.m13 - r.m31, r.m21 - r.m12);
    let sine = 0.5 * twice_sine.norm();
    let angle = sine.atan2(0.5 * (r.trace() - 1.0));
    if sine > LEAST_SINE {
        twice_sine * (0.5 * angle / sine)
    } else if r.trace() > 1.0 {
        0.5 * twice_sine
    } else {
        // Half a turn: its axis is in the symmetric part.
        rotation.scaled_axis()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_rotation_keeps_its_digits() {
        let axis = Vector3::new(0.48_f64, -0.6, 0.64);
        for angle in [0.0_f64, 1e-12, 5e-5, 0.3, 1.6, 3.0] {
            let back = rotation_vector(&Rotation3::from_scaled_axis(axis * angle));
            assert!((back - axis * angle).norm() < 2e-15, "{angle}");
        }
        let half = Rotation3::from_scaled_axis(std::f64::consts::PI * Vector3::x());
        assert!((rotation_vector(&half).norm() - std::f64::consts::PI).abs() < 1e-9);
    }

    #[test]
    fn angles_are_those_of_the_exterior_orientation() {
        for attitude in [[0.3, -1.2, 2.5], [-1.1, 0.4, -3.0], [0.0, 3.0, 0.1]] {
            let orientation = ExteriorOrientation {
                position_m: [1.0, 2.0, 3.0],
                attitude,
            };
            let pose = Pose::from(orientation);
            let back = pose.orientation().attitude;
            let difference = nalgebra::Vector3::from(back) - nalgebra::Vector3::from(attitude);
            assert!(difference.norm() < 1e-14);
            let analytic = pose.angles_by_rotation().unwrap();
            for axis in 0..3 {
                let at = |sign: f64| {
                    let mut step = Vector6::zeros();
                    step[3 + axis] = sign * 1e-6;
                    nalgebra::Vector3::from(pose.moved(&step).orientation().attitude)
                };
                let numeric = (at(1.0) - at(-1.0)) / 2e-6;
                assert!((numeric - analytic.column(axis)).norm() < 1e-8);
            }
        }
    }

    #[test]
    fn attitude_at_a_pitch_of_90_degrees_is_kept() {
        let upright = ExteriorOrientation {
            position_m: [0.0; 3],
            attitude: [std::f64::consts::FRAC_PI_2, 0.3, 0.4],
        };
        let pose = Pose::from(upright);
        assert_eq!(pose.angles_by_rotation(), None);
        let back = Pose::from(pose.orientation());
        assert!((back.rotation.matrix() - pose.rotation.matrix()).norm() < 1e-12);
    }
}
