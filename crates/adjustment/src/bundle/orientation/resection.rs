//! Pose of one image from object points with known coordinates.

use nalgebra::{Matrix6, Vector3, Vector6};

use crate::bundle::interior::Interior;
use crate::bundle::orientation::three_points;
use crate::bundle::pose::Pose;
use crate::bundle::ray::{Ray, residual};

/// Image point with the coordinates of its object point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownPoint {
    /// Measured point, sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// Object point, m.
    pub ground_m: Vector3<f64>,
}

/// Iterations of the refinement.
const ITERATIONS: usize = 30;

/// Relative fall of the sum of squares that ends the refinement.
const LEAST_FALL: f64 = 1e-9;

/// Most image points that take part in the refinement of a start.
const MOST_POINTS: usize = 60;

/// Pose with the root mean square of its residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resected {
    /// Pose.
    pub pose: Pose,
    /// Root mean square of the residuals' lengths, mm.
    pub rms_mm: f64,
}

/// Returns the pose of an image from at least four known points, without a start.
///
/// # Model
/// Closed solutions of several triangles, each refined on all points; the one with the least
/// residuals.
///
/// `None` with fewer points, or where no solution shows all points below the lens.
#[must_use]
pub fn resected(interior: &Interior, points: &[KnownPoint]) -> Option<Resected> {
    if points.len() < 4 {
        return None;
    }
    let stride = points.len().div_ceil(MOST_POINTS);
    let sample: Vec<KnownPoint> = points.iter().step_by(stride).copied().collect();
    let starts = triangles(&sample).into_iter().flat_map(|triangle| {
        let directions = triangle.map(|point| {
            let ideal = interior.corrected(point.measured_mm);
            Vector3::new(ideal.x, ideal.y, -interior.principal_distance_mm).normalize()
        });
        three_points::poses(directions, triangle.map(|point| point.ground_m))
    });
    let best = starts
        .filter_map(|start| refined(interior, &start, &sample))
        .min_by(|a, b| a.rms_mm.total_cmp(&b.rms_mm))?;
    refined(interior, &best.pose, points).or(Some(best))
}

/// Refines a pose by damped Gauss-Newton iterations; `None` if a point is not below the lens.
#[must_use]
pub fn refined(interior: &Interior, start: &Pose, points: &[KnownPoint]) -> Option<Resected> {
    let mut pose = *start;
    let mut squares = sum_of_squares(interior, &pose, points)?;
    let mut damping = 1e-6;
    for _ in 0..ITERATIONS {
        let mut matrix = Matrix6::zeros();
        let mut right = Vector6::zeros();
        for point in points {
            let ray = Ray::new(interior, &pose, &point.ground_m, point.measured_mm)?;
            matrix += ray.by_pose.tr_mul(&ray.by_pose);
            right -= ray.by_pose.tr_mul(&ray.residual_mm);
        }
        let damped = matrix + damping * Matrix6::from_diagonal(&matrix.diagonal());
        let moved = pose.moved(&damped.cholesky()?.solve(&right));
        match sum_of_squares(interior, &moved, points) {
            Some(less) if less <= squares => {
                let fall = squares - less;
                pose = moved;
                squares = less;
                damping = (0.1 * damping).max(1e-12);
                if fall <= LEAST_FALL * squares {
                    break;
                }
            }
            _ => damping = 10.0 * damping.max(1e-4),
        }
    }
    let count = f64::from(u32::try_from(points.len()).unwrap_or(u32::MAX));
    Some(Resected {
        pose,
        rms_mm: (squares / count).sqrt(),
    })
}

fn sum_of_squares(interior: &Interior, pose: &Pose, points: &[KnownPoint]) -> Option<f64> {
    points
        .iter()
        .map(|point| {
            residual(interior, pose, &point.ground_m, point.measured_mm).map(|v| v.norm_squared())
        })
        .sum()
}

/// Returns triangles of well distributed points: for each of several first corners the farthest
/// point, and the one that makes the largest area with both.
fn triangles(points: &[KnownPoint]) -> Vec<[KnownPoint; 3]> {
    let stride = points.len().div_ceil(6).max(1);
    points
        .iter()
        .step_by(stride)
        .filter_map(|first| {
            let from = |point: &KnownPoint, other: &KnownPoint| {
                let ([x, y], [u, v]) = (point.measured_mm, other.measured_mm);
                [u - x, v - y]
            };
            let far = |point: &&KnownPoint| {
                let [dx, dy] = from(first, point);
                dx.hypot(dy)
            };
            let second = points.iter().max_by(|a, b| far(a).total_cmp(&far(b)))?;
            let area = |point: &&KnownPoint| {
                let ([ax, ay], [bx, by]) = (from(first, second), from(first, point));
                (ax * by - ay * bx).abs()
            };
            let third = points.iter().max_by(|a, b| area(a).total_cmp(&area(b)))?;
            Some([*first, *second, *third])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exterior_orientation::ExteriorOrientation;

    #[test]
    fn pose_is_found_over_a_plane_and_over_relief_without_a_start() {
        let interior = Interior {
            principal_distance_mm: 50.0,
            principal_point_mm: [0.1, -0.1],
            k: [0.0, -1e-5, 0.0, 0.0],
            p: [0.0; 2],
            b: [0.0; 2],
        };
        for (relief, attitude) in [(0.0, [0.4, -0.3, 2.8]), (1.2, [1.4, 0.2, -1.5])] {
            let truth = Pose::from(ExteriorOrientation {
                position_m: [0.5, -0.4, 6.5],
                attitude,
            });
            let ahead = truth.position_m + truth.rotation * Vector3::new(0.0, 0.0, -6.5);
            let points: Vec<KnownPoint> = [
                (-1.0, 1.0),
                (1.0, 1.1),
                (0.9, -1.0),
                (-1.1, -0.8),
                (0.1, 0.3),
            ]
            .into_iter()
            .map(|(x, y)| {
                let ground_m = ahead + Vector3::new(x, y, relief * x * y);
                let [x0, y0] = interior.principal_point_mm;
                let u = truth.in_camera(&ground_m);
                let ideal = -50.0 * u.xy() / u.z;
                // The measured point by fixed-point iteration.
                let mut about = ideal;
                for _ in 0..60 {
                    about = ideal + interior.distortion(about.into());
                }
                KnownPoint {
                    measured_mm: [about.x + x0, about.y + y0],
                    ground_m,
                }
            })
            .collect();
            let found = resected(&interior, &points).unwrap();
            assert!(found.rms_mm < 1e-9, "{}", found.rms_mm);
            assert!((found.pose.position_m - truth.position_m).norm() < 1e-7);
        }
    }
}
