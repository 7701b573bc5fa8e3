//! Attitude of the camera over time.

use nalgebra::{Rotation3, Vector3};

use super::turbulence::Turbulence;

/// Attitude of the camera over time.
///
/// # Model
/// Camera axes: right, forward (the FMC axis), up. At `reference_s` the rotation
/// `R = Rz(yaw)·Rx(pitch)·Ry(roll)` takes them to the ground frame. From then on the camera turns
/// by the rotation vector `ω·(t - reference) + ∫ turbulence dt` in its own axes, which is exact for
/// constant rates and leaves out the products of the turbulence's small angles.
///
/// # Units and frames
/// Right-handed: yaw counter-clockwise from the ground frame's y, pitch nose up, roll right side
/// down; rates about right, forward and up.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Attitude {
    /// Yaw at the reference time, °.
    pub yaw_deg: f64,
    /// Pitch at the reference time, °.
    pub pitch_deg: f64,
    /// Roll at the reference time, °.
    pub roll_deg: f64,
    /// The reference time, s.
    pub reference_s: f64,
    /// Constant rates about right, forward and up, °/s.
    pub rates_deg_s: [f64; 3],
    /// Rates that turbulence adds, °/s.
    pub turbulence: [Turbulence; 3],
}

impl Attitude {
    /// Creates the attitude of a camera that looks straight down, forward along the ground frame's
    /// y.
    #[must_use]
    pub fn level() -> Self {
        Self::default()
    }

    /// Returns the rotation from camera axes to the ground frame at a time.
    #[must_use]
    pub fn ground_from_camera(&self, time_s: f64) -> Rotation3<f64> {
        let about = |axis, degrees: f64| Rotation3::from_axis_angle(&axis, degrees.to_radians());
        let reference = about(Vector3::z_axis(), self.yaw_deg)
            * about(Vector3::x_axis(), self.pitch_deg)
            * about(Vector3::y_axis(), self.roll_deg);
        let elapsed_s = time_s - self.reference_s;
        let mut turn_deg = Vector3::from(self.rates_deg_s) * elapsed_s;
        for (turn, turbulence) in turn_deg.iter_mut().zip(&self.turbulence) {
            *turn += turbulence.integral(time_s) - turbulence.integral(self.reference_s);
        }
        reference * Rotation3::from_scaled_axis(turn_deg.map(f64::to_radians))
    }

    /// Highest frequency of the attitude, Hz.
    pub(super) fn highest_hz(&self) -> f64 {
        self.turbulence
            .iter()
            .map(Turbulence::highest_hz)
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOWN: Vector3<f64> = Vector3::new(0.0, 0.0, -1.0);

    #[test]
    fn pitch_looks_forward_roll_to_the_left_and_yaw_turns_left() {
        let look = |attitude: Attitude| attitude.ground_from_camera(0.0) * DOWN;
        let pitched = look(Attitude {
            pitch_deg: 10.0,
            ..Attitude::default()
        });
        assert!((pitched.y - 10.0_f64.to_radians().sin()).abs() < 1e-12);
        let rolled = look(Attitude {
            roll_deg: 10.0,
            ..Attitude::default()
        });
        assert!((rolled.x + 10.0_f64.to_radians().sin()).abs() < 1e-12);
        let yawed = Attitude {
            yaw_deg: 10.0,
            ..Attitude::default()
        };
        let nose = yawed.ground_from_camera(0.0) * Vector3::y();
        assert!((nose.x + 10.0_f64.to_radians().sin()).abs() < 1e-12);
    }

    #[test]
    fn rates_turn_about_the_cameras_own_axes() {
        let attitude = Attitude {
            yaw_deg: 90.0,
            reference_s: 2.0,
            rates_deg_s: [3.0, 0.0, 0.0],
            ..Attitude::default()
        };
        // The nose points along the ground's -x: a second later the optical axis is tilted by 3° in
        // that direction.
        let look = attitude.ground_from_camera(3.0) * DOWN;
        assert!((look.x + 3.0_f64.to_radians().sin()).abs() < 1e-12);
    }
}
