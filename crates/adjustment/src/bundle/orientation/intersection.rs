//! Intersection of rays in an object point.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::bundle::interior::Interior;
use crate::bundle::pose::Pose;

/// Smallest eigenvalue of the mean of (I - ddᵀ), d the unit vectors of the rays: the rays meet
/// under 0.3° in the mean.
const LEAST_ANGLE: f64 = 1e-5;

/// Returns the point nearest to the rays of several images, m; `None` if they are parallel or meet
/// above a lens.
///
/// # Model
/// Least squares of the distances from the rays.
#[must_use]
pub fn intersected(interior: &Interior, rays: &[(Pose, [f64; 2])]) -> Option<Vector3<f64>> {
    let (first, _) = rays.first()?;
    let origin = first.position_m;
    let mut matrix = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for (pose, measured_mm) in rays {
        let ideal = interior.corrected(*measured_mm);
        let ray = Vector3::new(ideal.x, ideal.y, -interior.principal_distance_mm).normalize();
        let ray = pose.rotation * ray;
        let across = Matrix3::identity() - ray * ray.transpose();
        matrix += across;
        right += across * (pose.position_m - origin);
    }
    let count = f64::from(u32::try_from(rays.len()).unwrap_or(u32::MAX));
    let least = SymmetricEigen::new(matrix / count).eigenvalues.min();
    if least < LEAST_ANGLE {
        return None;
    }
    let point = origin + matrix.cholesky()?.solve(&right);
    rays.iter()
        .all(|(pose, _)| pose.in_camera(&point).z < 0.0)
        .then_some(point)
}
