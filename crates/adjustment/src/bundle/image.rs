//! An image of the network, and its position and attitude observed on board.

use nalgebra::{Matrix3, Rotation3, SMatrix, Vector3};

use super::parameters::{Parameter, SharedValues};
use super::pose::{Pose, rotation_vector};
use super::stage::StageSetting;

/// Position and attitude observed on board; without σ an element is not observed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObservedPose {
    /// Observed values.
    pub pose: Pose,
    /// σ of the position, m, and of pitch, roll and yaw, rad.
    pub sigmas: [Option<f64>; 6],
    /// Velocity over ground, m/s.
    pub velocity_m_s: Option<Vector3<f64>>,
    /// Number of the strip, which a shift of the positions belongs to.
    pub strip: Option<usize>,
}

/// An image.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkImage {
    /// Name.
    pub name: String,
    /// Initial position and attitude.
    pub pose: Pose,
    /// Observation on board.
    pub observed: Option<ObservedPose>,
    /// Stage at the exposure, if there is a record of it.
    pub stage: Option<StageSetting>,
}

/// Residuals of a position and attitude observed on board, with their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseResiduals {
    /// Position with time offset, lever arm and shift, less the projection centre, m; pitch, roll
    /// and yaw with the boresight, less those of the image, rad.
    pub residuals: [f64; 6],
    /// By position and rotation of the image.
    pub by_pose: SMatrix<f64, 6, 6>,
    /// By shared unknowns.
    pub by_parameter: Vec<(Parameter, [f64; 6])>,
}

impl ObservedPose {
    /// Linearises the observation; `None` at a pitch of 90°, if the attitude is observed.
    #[must_use]
    pub fn residuals(&self, pose: &Pose, parameters: &SharedValues) -> Option<PoseResiduals> {
        let rotation = pose.rotation.matrix();
        let arm = rotation * parameters.lever_arm_m;
        let velocity = self.velocity_m_s.unwrap_or_default();
        let shift = self
            .strip
            .and_then(|strip| parameters.shifts_m.get(strip).copied())
            .unwrap_or_default();
        let position = self.pose.position_m + velocity * parameters.time_offset_s + arm + shift
            - pose.position_m;
        let mut by_pose = SMatrix::<f64, 6, 6>::zeros();
        by_pose
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&-Matrix3::identity());
        by_pose
            .fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&-arm.cross_matrix());
        let mut by_parameter = Vec::new();
        let upper = |vector: Vector3<f64>| [vector.x, vector.y, vector.z, 0.0, 0.0, 0.0];
        if self.velocity_m_s.is_some() {
            by_parameter.push((Parameter::TimeOffset, upper(velocity)));
        }
        for (axis, column) in rotation.column_iter().enumerate() {
            by_parameter.push((Parameter::LeverArm(axis), upper(column.into_owned())));
        }
        if let Some(strip) = self.strip {
            for (axis, unit) in Matrix3::<f64>::identity().column_iter().enumerate() {
                by_parameter.push((Parameter::Shift { strip, axis }, upper(unit.into_owned())));
            }
        }
        let mut angles = Vector3::zeros();
        if self.observes_attitude() {
            let by_rotation = pose.angles_by_rotation()?;
            let expected = self.pose.rotation * parameters.boresight.inverse();
            angles = by_rotation * turn(&expected, &pose.rotation);
            by_pose
                .fixed_view_mut::<3, 3>(3, 3)
                .copy_from(&-by_rotation);
            let by_boresight = -(by_rotation * expected.matrix());
            for (axis, column) in by_boresight.column_iter().enumerate() {
                let column = [0.0, 0.0, 0.0, column.x, column.y, column.z];
                by_parameter.push((Parameter::Boresight(axis), column));
            }
        }
        Some(PoseResiduals {
            residuals: [
                position.x, position.y, position.z, angles.x, angles.y, angles.z,
            ],
            by_pose,
            by_parameter,
        })
    }

    /// Returns true if an angle has a σ.
    #[must_use]
    pub fn observes_attitude(&self) -> bool {
        self.sigmas.iter().skip(3).any(Option::is_some)
    }
}

/// Returns the rotation vector, ground axes, that turns `from` into `to`.
fn turn(to: &Rotation3<f64>, from: &Rotation3<f64>) -> Vector3<f64> {
    rotation_vector(&(to * from.inverse()))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector6;

    use super::*;
    use crate::bundle::interior::Interior;
    use crate::exterior_orientation::ExteriorOrientation;

    #[test]
    fn derivatives_agree_with_central_differences() {
        let orientation = |attitude| {
            Pose::from(ExteriorOrientation {
                position_m: [3.0, -2.0, 6.0],
                attitude,
            })
        };
        let observed = ObservedPose {
            pose: orientation([0.101, -0.052, 2.1]),
            sigmas: [Some(0.03); 6],
            velocity_m_s: Some(Vector3::new(60.0, 20.0, -1.0)),
            strip: Some(1),
        };
        let pose = orientation([0.1, -0.05, 2.1003]);
        let interior = Interior {
            principal_distance_mm: 50.0,
            principal_point_mm: [0.0; 2],
            k: [0.0; 4],
            p: [0.0; 2],
            b: [0.0; 2],
        };
        let mut parameters = SharedValues::new(interior, 2);
        parameters.lever_arm_m = Vector3::new(0.3, -0.8, 1.2);
        parameters.time_offset_s = 0.003;
        parameters.boresight = Rotation3::from_scaled_axis(Vector3::new(0.001, -0.002, 0.0003));
        let analytic = observed.residuals(&pose, &parameters).unwrap();
        let at = |pose: &Pose, parameters: &SharedValues| {
            Vector6::from(observed.residuals(pose, parameters).unwrap().residuals)
        };
        let step = 1e-6;
        for element in 0..6 {
            let moved = |sign: f64| {
                let mut change = Vector6::zeros();
                change[element] = sign * step;
                at(&pose.moved(&change), &parameters)
            };
            let numeric = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            // The logarithm of the rotation is linear up to the residual, 2 mrad.
            assert!((numeric - analytic.by_pose.column(element)).norm() < 2e-3);
        }
        assert_eq!(analytic.by_parameter.len(), 10);
        for (parameter, column) in analytic.by_parameter {
            let moved = |sign: f64| {
                let mut moved = parameters.clone();
                moved.add(parameter, sign * step);
                at(&pose, &moved)
            };
            let numeric = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            assert!(
                (numeric - Vector6::from(column)).norm() < 2e-3,
                "{parameter:?}"
            );
        }
    }
}
