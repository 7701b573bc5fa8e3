//! Ray from an image point to its object point: residual of the collinearity equations and its
//! derivatives.

use nalgebra::{Matrix2x3, SMatrix, Vector2, Vector3};

use super::interior::{INTERIOR_ELEMENTS, Interior};
use super::pose::Pose;

/// Residual of an image point, corrected less projected, with its derivatives.
///
/// # Units and frames
/// Sensor frame, mm; per m and rad of the pose (rotation about the ground axes) and the object
/// point, per unit of the elements of the interior orientation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// v, mm.
    pub residual_mm: Vector2<f64>,
    /// By position and rotation of the image.
    pub by_pose: SMatrix<f64, 2, 6>,
    /// By the object point.
    pub by_point: Matrix2x3<f64>,
    /// By the elements of the interior orientation.
    pub by_interior: [Vector2<f64>; INTERIOR_ELEMENTS],
}

/// Returns the residual alone; `None` for a point that is not below the lens.
///
/// # Model
/// `v = x̄ - D(x̄) + f·(u1, u2)/u3`, `u = Rᵀ(P - S)`.
#[must_use]
pub fn residual(
    interior: &Interior,
    pose: &Pose,
    point_m: &Vector3<f64>,
    measured_mm: [f64; 2],
) -> Option<Vector2<f64>> {
    let u = pose.in_camera(point_m);
    (u.z < 0.0)
        .then(|| interior.corrected(measured_mm) + interior.principal_distance_mm * u.xy() / u.z)
}

impl Ray {
    /// Linearises the observation; `None` for a point that is not below the lens.
    ///
    /// # Accuracy
    /// Agrees with central differences to 1e-7 relative
    /// (`derivatives_agree_with_central_differences`).
    #[must_use]
    pub fn new(
        interior: &Interior,
        pose: &Pose,
        point_m: &Vector3<f64>,
        measured_mm: [f64; 2],
    ) -> Option<Self> {
        let camera_from_ground = pose.rotation.matrix().transpose();
        let from_centre = point_m - pose.position_m;
        let u = camera_from_ground * from_centre;
        if u.z >= 0.0 {
            return None;
        }
        let tangent = u.xy() / u.z;
        let f = interior.principal_distance_mm;
        let corrected = interior.corrected_with_derivatives(measured_mm);
        let scale = f / u.z;
        let by_camera = Matrix2x3::new(
            scale,
            0.0,
            -scale * tangent.x,
            0.0,
            scale,
            -scale * tangent.y,
        );
        let by_point = by_camera * camera_from_ground;
        let mut by_pose = SMatrix::<f64, 2, 6>::zeros();
        by_pose.fixed_columns_mut::<3>(0).copy_from(&-by_point);
        // d(exp(-w)·d) = d × w.
        by_pose
            .fixed_columns_mut::<3>(3)
            .copy_from(&(by_point * from_centre.cross_matrix()));
        let mut by_interior = corrected.by_element;
        let [by_distance, ..] = &mut by_interior;
        *by_distance = tangent;
        Some(Self {
            residual_mm: corrected.ideal_mm + f * tangent,
            by_pose,
            by_point,
            by_interior,
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector6;

    use super::*;
    use crate::bundle::interior::InteriorElement;
    use crate::exterior_orientation::ExteriorOrientation;

    #[test]
    fn derivatives_agree_with_central_differences() {
        let interior = Interior {
            principal_distance_mm: 50.0,
            principal_point_mm: [0.12, -0.2],
            k: [0.0, -2e-5, 4e-9, 3e-12],
            p: [2e-6, -5e-6],
            b: [3e-4, -2e-4],
        };
        let pose = Pose::from(ExteriorOrientation {
            position_m: [3.0, -2.0, 6.0],
            attitude: [0.3, -0.2, 2.1],
        });
        let point = Vector3::new(1.0, 0.5, 0.3);
        let measured = [13.0, -7.0];
        let at = |interior: &Interior, pose: &Pose, point: &Vector3<f64>| {
            residual(interior, pose, point, measured).unwrap()
        };
        let ray = Ray::new(&interior, &pose, &point, measured).unwrap();
        assert!((ray.residual_mm - at(&interior, &pose, &point)).norm() < 1e-13);
        let step = 1e-6;
        for element in 0..6 {
            let moved = |sign: f64| {
                let mut change = Vector6::zeros();
                change[element] = sign * step;
                at(&interior, &pose.moved(&change), &point)
            };
            let numeric = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            let column = ray.by_pose.column(element);
            assert!((numeric - column).norm() < 1e-7 * column.norm());
        }
        for axis in 0..3 {
            let moved = |sign: f64| {
                let mut moved = point;
                moved[axis] += sign * step;
                at(&interior, &pose, &moved)
            };
            let numeric = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            let column = ray.by_point.column(axis);
            assert!((numeric - column).norm() < 1e-7 * column.norm());
        }
        for (element, column) in InteriorElement::ALL.into_iter().zip(ray.by_interior) {
            let step = 1e-4 / column.norm();
            let moved = |sign: f64| {
                let mut moved = interior;
                moved.add(element, sign * step);
                at(&moved, &pose, &point)
            };
            let numeric = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            assert!(
                (numeric - column).norm() < 1e-7 * column.norm(),
                "{element:?}"
            );
        }
    }

    #[test]
    fn points_above_the_lens_have_no_image() {
        let interior = Interior {
            principal_distance_mm: 50.0,
            principal_point_mm: [0.0; 2],
            k: [0.0; 4],
            p: [0.0; 2],
            b: [0.0; 2],
        };
        let pose = Pose::from(ExteriorOrientation {
            position_m: [0.0, 0.0, 6.0],
            attitude: [0.0; 3],
        });
        assert_eq!(
            Ray::new(&interior, &pose, &Vector3::new(0.0, 0.0, 7.0), [0.0; 2]),
            None
        );
    }
}
