//! Exterior orientation of an image, as other programs write it.

use fmc_frames::trajectory::{
    Attitude, GeographicPlace, ImageOrientation, OrientationSigma, Place,
};
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

/// Place and attitude of the camera of an image, at the centroid of its exposure.
///
/// The camera's axes are those of the sensor frame: x to the right, y up in the upright positive
/// image, z away from the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImagePose {
    /// Place of the reference point of the trajectory; the angles are against its axes, which are
    /// east, north and up in a geographic place.
    pub place: Place,
    /// Rotation from the camera to the axes of the place.
    pub ground_from_camera: UnitQuaternion<f64>,
    /// σ of place and angles, where the trajectory has σ.
    pub sigma: Option<PoseSigma>,
}

/// σ of a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseSigma {
    /// Along the axes of the place, m.
    pub position_m: [f64; 3],
    /// Of ω, φ and κ, rad.
    pub angles_rad: [f64; 3],
}

impl ImagePose {
    /// Returns the pose of the camera of a body with that orientation.
    ///
    /// # Model
    /// The camera looks down, and its FMC axis, `axis` in the sensor frame, is the body's axis
    /// forward: the principal point moves with the flight. Neither lever arm nor boresight is
    /// applied.
    #[must_use]
    pub fn of(orientation: &ImageOrientation, axis: [f64; 2]) -> Self {
        let sigma = orientation.sigma();
        Self {
            place: orientation.place,
            ground_from_camera: ground_from_camera(&orientation.attitude, axis),
            sigma: sigma.map(|sigma| pose_sigma(&orientation.attitude, &sigma, axis)),
        }
    }

    /// Returns ω, φ and κ of `ground_from_camera = Rx(ω)·Ry(φ)·Rz(κ)`, rad.
    #[must_use]
    pub fn omega_phi_kappa_rad(&self) -> [f64; 3] {
        omega_phi_kappa(&self.ground_from_camera)
    }

    /// Returns x, y and z, m; `None` for a geographic place.
    #[must_use]
    pub const fn position_m(&self) -> Option<[f64; 3]> {
        match self.place {
            Place::Cartesian(position_m) => Some(position_m),
            Place::Geographic(_) => None,
        }
    }

    /// Returns latitude, longitude and height; `None` for a Cartesian place.
    #[must_use]
    pub const fn geographic(&self) -> Option<GeographicPlace> {
        match self.place {
            Place::Geographic(place) => Some(place),
            Place::Cartesian(_) => None,
        }
    }

    /// Returns COLMAP's quaternion w, x, y, z and translation: `camera = R·world + t`, with the
    /// camera's y down and z towards the ground. `None` for a geographic place.
    #[must_use]
    pub fn colmap(&self) -> Option<([f64; 4], [f64; 3])> {
        let position = Vector3::from(self.position_m()?);
        // Half a turn about x takes y up to y down.
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 1.0, 0.0, 0.0));
        let rotation = turn * self.ground_from_camera.inverse();
        let translation = -(rotation * position);
        let [x, y, z, w] = rotation.coords.into();
        // Both signs are the same rotation.
        let sign = if w < 0.0 { -1.0 } else { 1.0 };
        Some((
            [w, x, y, z].map(|part| part * sign + 0.0),
            translation.into(),
        ))
    }
}

fn ground_from_camera(
    attitude: &Attitude,
    [forward_x, forward_y]: [f64; 2],
) -> UnitQuaternion<f64> {
    let [first, second, third] = attitude.ground_from_body();
    let ground_from_body = Matrix3::from_rows(&[first.into(), second.into(), third.into()]);
    let ground_from_body = Rotation3::from_matrix_unchecked(ground_from_body);
    // The angle by which the camera stands turned in the body, anticlockwise from above.
    let turn = forward_x.atan2(forward_y);
    let body_from_camera = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
    UnitQuaternion::from_rotation_matrix(&ground_from_body) * body_from_camera
}

fn omega_phi_kappa(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let matrix = rotation.to_rotation_matrix();
    let [x, y, z] = [0, 1, 2].map(|column| matrix.matrix().column(column).into_owned());
    [
        (-z.y).atan2(z.z),
        z.x.clamp(-1.0, 1.0).asin(),
        (-y.x).atan2(x.x),
    ]
}

/// Returns σ of ω, φ and κ: what σ of each angle of the body makes of them.
fn pose_sigma(attitude: &Attitude, sigma: &OrientationSigma, axis: [f64; 2]) -> PoseSigma {
    let angles = |attitude: &Attitude| omega_phi_kappa(&ground_from_camera(attitude, axis));
    let given = angles(attitude);
    let [pitch, roll, yaw] = sigma.angles_rad;
    let changed = [
        Attitude {
            pitch_rad: attitude.pitch_rad + pitch,
            ..*attitude
        },
        Attitude {
            roll_rad: attitude.roll_rad + roll,
            ..*attitude
        },
        Attitude {
            yaw_rad: attitude.yaw_rad + yaw,
            ..*attitude
        },
    ];
    let mut angles_rad = [0.0_f64; 3];
    for changed in changed {
        for ((sum, after), before) in angles_rad.iter_mut().zip(angles(&changed)).zip(given) {
            // The shorter way round.
            let change = (after - before).sin().atan2((after - before).cos());
            *sum = sum.hypot(change);
        }
    }
    PoseSigma {
        position_m: sigma.position_m,
        angles_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: [f64; 2] = [0.0, 1.0];

    fn orientation(pitch_deg: f64, roll_deg: f64, heading_deg: f64) -> ImageOrientation {
        let none = OrientationSigma::default();
        ImageOrientation {
            place: Place::Cartesian([100.0, 200.0, 700.0]),
            attitude: Attitude {
                pitch_rad: pitch_deg.to_radians(),
                roll_rad: roll_deg.to_radians(),
                yaw_rad: -heading_deg.to_radians(),
            },
            velocity_m_s: [0.0; 3],
            trajectory_sigma: Some(OrientationSigma {
                position_m: [0.03, 0.04, 0.05],
                angles_rad: [1e-5, 2e-5, 4e-5],
            }),
            time_sigma: none,
            interpolation_sigma: none,
        }
    }

    /// Returns the image of a ground point: x right, y up in the image, divided by z.
    fn seen(pose: &ImagePose, ground: [f64; 3]) -> [f64; 2] {
        let [c, g] = [pose.position_m().unwrap(), ground].map(Vector3::from);
        let camera = pose.ground_from_camera.inverse() * (g - c);
        [-camera.x / camera.z, -camera.y / camera.z]
    }

    #[test]
    fn camera_sees_what_lies_ahead_along_its_fmc_axis_and_what_lies_right_beside_it() {
        for (axis, right) in [
            (UP, [1.0, 0.0]),
            ([1.0, 0.0], [0.0, -1.0]),
            ([0.0, -1.0], [-1.0, 0.0]),
            ([-1.0, 0.0], [0.0, 1.0]),
        ] {
            // To the east: ahead is east, right is south.
            let pose = ImagePose::of(&orientation(0.0, 0.0, 90.0), axis);
            for (ground, expected) in [([170.0, 200.0, 0.0], axis), ([100.0, 130.0, 0.0], right)] {
                let found = seen(&pose, ground);
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!((found - 0.1 * expected).abs() < 1e-12, "{axis:?} {found}");
                }
            }
        }
    }

    #[test]
    fn angles_and_quaternion_are_the_same_rotation() {
        for (pitch, roll, heading) in [(2.0, -1.5, 30.0), (-4.0, 3.0, 200.0), (0.0, 0.0, 0.0)] {
            let pose = ImagePose::of(&orientation(pitch, roll, heading), UP);
            let [omega, phi, kappa] = pose.omega_phi_kappa_rad();
            let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
            let again = about(Vector3::x_axis(), omega)
                * about(Vector3::y_axis(), phi)
                * about(Vector3::z_axis(), kappa);
            assert!(again.angle_to(&pose.ground_from_camera) < 1e-7);
            let ([w, x, y, z], translation) = pose.colmap().unwrap();
            let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            let ground = [130.0, 260.0, 20.0];
            let camera = rotation * Vector3::from(ground) + Vector3::from(translation);
            let [right, up] = seen(&pose, ground);
            assert!(camera.z > 0.0);
            assert!((camera.x / camera.z - right).abs() < 1e-12);
            assert!((camera.y / camera.z + up).abs() < 1e-12);
        }
    }

    #[test]
    fn sigma_turns_with_the_heading() {
        // To the north pitch is about x and roll about y; to the east the other way round.
        let of = |heading| {
            let pose = ImagePose::of(&orientation(0.0, 0.0, heading), UP);
            pose.sigma.unwrap().angles_rad
        };
        for (found, expected) in [
            (of(0.0), [1e-5, 2e-5, 4e-5]),
            (of(90.0), [2e-5, 1e-5, 4e-5]),
        ] {
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
            }
        }
    }
}
