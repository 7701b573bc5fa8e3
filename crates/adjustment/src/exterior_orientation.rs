//! Exterior orientation: position and attitude of the camera.

use nalgebra::{Matrix3, Rotation3, SVector, Vector3};

/// Number of elements of an exterior orientation.
pub const ELEMENTS: usize = 6;

/// Names of the elements, in the order of [`ExteriorOrientation::elements`].
pub const ELEMENT_NAMES: [&str; ELEMENTS] = ["X_S", "Y_S", "Z_S", "pitch", "roll", "yaw"];

/// Projection centre and attitude of one frame, at the centroid of the exposure.
///
/// # Model
/// `ground_from_camera = Rz(yaw)·Rx(pitch)·Ry(roll)`: heading first, then pitch about the axis to
/// the right, then roll about the forward axis; each right-handed.
///
/// # Units and frames
/// Metres and radians. Pitch > 0 tilts the optical axis forward, roll > 0 to the left, yaw > 0
/// turns the nose to the left. All zero: the camera looks straight down with its y axis to the
/// north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExteriorOrientation {
    /// Projection centre in the ground frame, m.
    pub position_m: [f64; 3],
    /// Pitch, roll, yaw, rad.
    pub attitude: [f64; 3],
}

impl ExteriorOrientation {
    /// `X_S`, `Y_S`, `Z_S` in m, then pitch, roll, yaw in rad.
    #[must_use]
    pub fn elements(&self) -> SVector<f64, ELEMENTS> {
        let [x, y, z] = self.position_m;
        let [pitch, roll, yaw] = self.attitude;
        SVector::from([x, y, z, pitch, roll, yaw])
    }

    /// Creates the orientation from its elements, in the order of [`Self::elements`].
    #[must_use]
    pub fn from_elements(elements: &SVector<f64, ELEMENTS>) -> Self {
        let [[x, y, z, pitch, roll, yaw]] = elements.data.0;
        Self {
            position_m: [x, y, z],
            attitude: [pitch, roll, yaw],
        }
    }

    /// Projection centre as a vector, m.
    #[must_use]
    pub fn position(&self) -> Vector3<f64> {
        Vector3::from(self.position_m)
    }

    /// Returns the rotation from camera axes to ground axes.
    #[must_use]
    pub fn ground_from_camera(&self) -> Matrix3<f64> {
        let [pitch, roll, yaw] = self.attitude;
        about_z(yaw) * about_x(pitch) * about_y(roll)
    }

    /// Returns the derivatives of [`Self::ground_from_camera`] with respect to pitch, roll and yaw.
    #[must_use]
    pub fn rotation_derivatives(&self) -> [Matrix3<f64>; 3] {
        let [pitch, roll, yaw] = self.attitude;
        // d/dα of a rotation about an axis is the rotation multiplied from the left by the axis'
        // cross product.
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axis.cross_matrix());
        [
            about_z(yaw) * x * about_x(pitch) * about_y(roll),
            about_z(yaw) * about_x(pitch) * y * about_y(roll),
            z * self.ground_from_camera(),
        ]
    }
}

fn about_x(angle: f64) -> Matrix3<f64> {
    Rotation3::from_axis_angle(&Vector3::x_axis(), angle).into_inner()
}

fn about_y(angle: f64) -> Matrix3<f64> {
    Rotation3::from_axis_angle(&Vector3::y_axis(), angle).into_inner()
}

fn about_z(angle: f64) -> Matrix3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle).into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn optical_axis(attitude: [f64; 3]) -> Vector3<f64> {
        let orientation = ExteriorOrientation {
            position_m: [0.0; 3],
            attitude,
        };
        orientation.ground_from_camera() * -Vector3::z()
    }

    #[test]
    fn signs_are_those_of_the_conventions() {
        let forward = optical_axis([0.1, 0.0, 0.0]);
        assert!(forward.y > 0.09 && forward.x.abs() < 1e-12);
        let left = optical_axis([0.0, 0.1, 0.0]);
        assert!(left.x < -0.09 && left.y.abs() < 1e-12);
        let turned = ExteriorOrientation {
            position_m: [0.0; 3],
            attitude: [0.0, 0.0, 0.1],
        };
        assert!((turned.ground_from_camera() * Vector3::y()).x < -0.09);
    }

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        let orientation = ExteriorOrientation {
            position_m: [1.0, 2.0, 3.0],
            attitude: [0.05, -0.03, 2.1],
        };
        let step = 1e-6;
        for (angle, derivative) in orientation.rotation_derivatives().iter().enumerate() {
            let at = |sign: f64| {
                let mut moved = orientation;
                moved.attitude[angle] += sign * step;
                moved.ground_from_camera()
            };
            let difference = (at(1.0) - at(-1.0)) / (2.0 * step);
            assert!((difference - derivative).norm() < 1e-9);
        }
    }
}
