//! Pose of a vertical image from two object points or three: the similarity in plan.

use nalgebra::{Rotation3, Vector2, Vector3};

use crate::bundle::interior::Interior;
use crate::bundle::pose::Pose;

use super::resection::KnownPoint;

/// Fewest points.
pub const FEWEST: usize = 2;

/// Smallest spread of the image points, as a fraction of the principal distance.
const LEAST_SPREAD: f64 = 1e-3;

/// Returns the pose of an image that looks straight down, from two known points at least.
///
/// # Model
/// `(X, Y) = (X_S, Y_S) + s·Rz(yaw)·(x, y)` by least squares, `Z_S = mean Z + s·f`: pitch and roll
/// are zero, and all points in the mean height. It is a start, whose rays miss the points by the
/// tilt and the relief.
///
/// `None` for points that do not differ.
#[must_use]
pub fn vertical(interior: &Interior, points: &[KnownPoint]) -> Option<Pose> {
    if points.len() < FEWEST {
        return None;
    }
    let count = f64::from(u32::try_from(points.len()).unwrap_or(u32::MAX));
    let images: Vec<Vector2<f64>> = points
        .iter()
        .map(|point| interior.corrected(point.measured_mm))
        .collect();
    let image = images.iter().sum::<Vector2<f64>>() / count;
    let ground = points
        .iter()
        .map(|point| point.ground_m)
        .sum::<Vector3<f64>>()
        / count;
    let (mut along, mut across, mut squares) = (0.0, 0.0, 0.0);
    for (point, place) in points.iter().zip(&images) {
        let (from, to) = (place - image, point.ground_m.xy() - ground.xy());
        along += from.dot(&to);
        across += from.perp(&to);
        squares += from.norm_squared();
    }
    let f = interior.principal_distance_mm;
    let scale = along.hypot(across) / squares;
    if squares < (LEAST_SPREAD * f).powi(2) || !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), across.atan2(along));
    let to_image = scale * (rotation * Vector3::new(image.x, image.y, -f));
    Some(Pose {
        position_m: ground - to_image,
        rotation,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const INTERIOR: Interior = Interior {
        principal_distance_mm: 100.0,
        principal_point_mm: [0.2, -0.1],
        k: [0.0, -1e-6, 0.0, 0.0],
        p: [0.0; 2],
        b: [0.0; 2],
    };

    fn known(measured_mm: [f64; 2], ground_m: [f64; 3]) -> KnownPoint {
        KnownPoint {
            measured_mm,
            ground_m: ground_m.into(),
        }
    }

    #[test]
    fn vertical_image_over_a_plane_is_found_from_two_points() {
        // 10 m per mm, turned by 90°: 1000 m above the points.
        let truth = Pose {
            position_m: Vector3::new(500.0, -200.0, 1030.0),
            rotation: Rotation3::from_axis_angle(&Vector3::z_axis(), 1.5),
        };
        let points = [[20.0, -30.0], [-35.0, 10.0]].map(|measured_mm| {
            let ideal = INTERIOR.corrected(measured_mm);
            let ray = truth.rotation * Vector3::new(ideal.x, ideal.y, -100.0);
            known(measured_mm, (truth.position_m + 10.0 * ray).into())
        });
        let found = vertical(&INTERIOR, &points).unwrap();
        assert!((found.position_m - truth.position_m).norm() < 1e-9);
        assert!((found.rotation.matrix() - truth.rotation.matrix()).norm() < 1e-12);
    }

    #[test]
    fn one_point_and_twice_the_same_are_no_start() {
        let one = known([10.0, 5.0], [100.0, 50.0, 0.0]);
        assert_eq!(vertical(&INTERIOR, &[one]), None);
        assert_eq!(vertical(&INTERIOR, &[one, one]), None);
    }
}
