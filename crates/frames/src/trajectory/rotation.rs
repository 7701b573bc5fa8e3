//! Angles of a body, and its rotation.

use std::f64::consts::PI;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::sample::Attitude;

/// Returns Rz(yaw)·Rx(pitch)·Ry(roll).
pub(super) fn ground_from_body(attitude: &Attitude) -> UnitQuaternion<f64> {
    let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    about(Vector3::z_axis(), attitude.yaw_rad)
        * about(Vector3::x_axis(), attitude.pitch_rad)
        * about(Vector3::y_axis(), attitude.roll_rad)
}

/// Returns the angles of a rotation, yaw from -π to π.
pub(super) fn attitude(ground_from_body: &UnitQuaternion<f64>) -> Attitude {
    angles(&ground_from_body.to_rotation_matrix().into_inner())
}

/// Returns the angles of a rotation matrix.
pub(super) fn angles(matrix: &Matrix3<f64>) -> Attitude {
    let [right, forward, up] = [0, 1, 2].map(|column| matrix.column(column).into_owned());
    Attitude {
        pitch_rad: forward.z.clamp(-1.0, 1.0).asin(),
        roll_rad: (-right.z).atan2(up.z),
        yaw_rad: (-forward.x).atan2(forward.y),
    }
}

impl Attitude {
    /// Returns Rz(yaw)·Rx(pitch)·Ry(roll) row by row.
    #[must_use]
    pub fn ground_from_body(&self) -> [[f64; 3]; 3] {
        let matrix = ground_from_body(self).to_rotation_matrix().into_inner();
        // nalgebra hands on columns.
        matrix.transpose().into()
    }

    /// Returns pitch, roll and yaw from those of another attitude, each from -π to π.
    pub(super) fn angles_from(&self, other: &Self) -> [f64; 3] {
        [
            self.pitch_rad - other.pitch_rad,
            self.roll_rad - other.roll_rad,
            self.yaw_rad - other.yaw_rad,
        ]
        .map(|angle| (angle + PI).rem_euclid(2.0 * PI) - PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_come_back_and_turn_as_they_are_named() {
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..1000 {
            let mut angle = |most: f64| (random.f64() * 2.0 - 1.0) * most;
            let given = Attitude {
                pitch_rad: angle(1.5),
                roll_rad: angle(3.1),
                yaw_rad: angle(3.1),
            };
            let found = attitude(&ground_from_body(&given));
            let off = found.angles_from(&given);
            assert!(off.iter().all(|angle| angle.abs() < 1e-13), "{off:?}");
        }
        // Nose up, right side down, nose to the left (north to west).
        let turned = |attitude: Attitude, axis: Vector3<f64>| ground_from_body(&attitude) * axis;
        let (none, quarter) = (Attitude::default(), PI / 2.0);
        let pitch = Attitude {
            pitch_rad: 0.1,
            ..none
        };
        let roll = Attitude {
            roll_rad: 0.1,
            ..none
        };
        let yaw = Attitude {
            yaw_rad: quarter,
            ..none
        };
        assert!(turned(pitch, Vector3::y()).z > 0.0);
        assert!(turned(roll, Vector3::x()).z < 0.0);
        assert!((turned(yaw, Vector3::y()) + Vector3::x()).norm() < 1e-15);
    }
}
