//! Closed solution of the pose from three points.

use nalgebra::{Matrix3, Matrix4, Rotation3, Vector3};

use crate::bundle::pose::Pose;

/// Largest imaginary part of a root taken as real, relative to its size; noise turns a double root
/// into a complex pair.
const MOST_IMAGINARY: f64 = 0.05;

/// Returns the poses, at most four, from which three points appear in three directions.
///
/// # Model
/// Grunert's solution as given by Haralick et al. 1994, eqs. 4 to 9 (International Journal of
/// Computer Vision 13(3), 331-356): a quartic for the ratio of two distances.
///
/// # Units and frames
/// Unit vectors in camera axes from the projection centre to the points; ground points in m.
#[must_use]
pub fn poses(directions: [Vector3<f64>; 3], points_m: [Vector3<f64>; 3]) -> Vec<Pose> {
    let [j1, j2, j3] = directions;
    let [p1, p2, p3] = points_m;
    let [a2, b2, c2] = [p2 - p3, p1 - p3, p1 - p2].map(|side| side.norm_squared());
    let [cos_a, cos_b, cos_c] = [j2.dot(&j3), j1.dot(&j3), j1.dot(&j2)];
    if b2 <= 0.0 {
        return Vec::new();
    }
    let (difference, sum) = ((a2 - c2) / b2, (a2 + c2) / b2);
    let quartic = [
        (1.0 + difference).powi(2) - 4.0 * a2 / b2 * cos_c.powi(2),
        4.0 * (-difference * (1.0 + difference) * cos_b + 2.0 * a2 / b2 * cos_c.powi(2) * cos_b
            - (1.0 - sum) * cos_a * cos_c),
        2.0 * (difference.powi(2) - 1.0
            + 2.0 * (difference * cos_b).powi(2)
            + 2.0 * (b2 - c2) / b2 * cos_a.powi(2)
            - 4.0 * sum * cos_a * cos_b * cos_c
            + 2.0 * (b2 - a2) / b2 * cos_c.powi(2)),
        4.0 * (difference * (1.0 - difference) * cos_b - (1.0 - sum) * cos_a * cos_c
            + 2.0 * c2 / b2 * cos_a.powi(2) * cos_b),
        (difference - 1.0).powi(2) - 4.0 * c2 / b2 * cos_a.powi(2),
    ];
    real_roots(quartic)
        .into_iter()
        .filter_map(|v| {
            let divisor = 2.0 * (cos_c - v * cos_a);
            let u = ((difference - 1.0) * v * v - 2.0 * difference * cos_b * v + 1.0 + difference)
                / divisor;
            let s1 = (b2 / (1.0 + v * v - 2.0 * v * cos_b)).sqrt();
            (u > 0.0 && v > 0.0 && s1.is_finite() && u.is_finite())
                .then(|| pose([s1 * j1, u * s1 * j2, v * s1 * j3], points_m))?
        })
        .collect()
}

/// Returns the real roots of a polynomial of the fourth degree, lowest power first.
fn real_roots([c0, c1, c2, c3, c4]: [f64; 5]) -> Vec<f64> {
    let largest = [c0, c1, c2, c3, c4]
        .into_iter()
        .fold(0.0, |most: f64, c| most.max(c.abs()));
    if c4.abs() <= 1e-14 * largest {
        return Vec::new();
    }
    let companion = Matrix4::new(
        0.0,
        0.0,
        0.0,
        -c0 / c4, //
        1.0,
        0.0,
        0.0,
        -c1 / c4, //
        0.0,
        1.0,
        0.0,
        -c2 / c4, //
        0.0,
        0.0,
        1.0,
        -c3 / c4,
    );
    companion
        .complex_eigenvalues()
        .iter()
        .filter(|root| root.im.abs() <= MOST_IMAGINARY * (1.0 + root.re.abs()))
        .map(|root| root.re)
        .collect()
}

/// Returns the pose that takes points in camera axes to ground points.
fn pose(in_camera: [Vector3<f64>; 3], points_m: [Vector3<f64>; 3]) -> Option<Pose> {
    let rotation = triad(points_m)? * triad(in_camera)?.transpose();
    let rotation = Rotation3::from_matrix_unchecked(rotation);
    let mean = |[a, b, c]: [Vector3<f64>; 3]| (a + b + c) / 3.0;
    Some(Pose {
        position_m: mean(points_m) - rotation * mean(in_camera),
        rotation,
    })
}

/// Returns right-handed axes fixed to a triangle, as columns.
fn triad([a, b, c]: [Vector3<f64>; 3]) -> Option<Matrix3<f64>> {
    let first = (b - a).try_normalize(0.0)?;
    let third = (b - a).cross(&(c - a)).try_normalize(0.0)?;
    Some(Matrix3::from_columns(&[first, third.cross(&first), third]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exterior_orientation::ExteriorOrientation;

    #[test]
    fn one_of_the_poses_is_the_true_one() {
        for (number, attitude) in [[0.3, -0.2, 2.1], [0.0, 0.0, 0.0], [-0.8, 0.1, -1.0]]
            .into_iter()
            .enumerate()
        {
            let truth = Pose::from(ExteriorOrientation {
                position_m: [0.3, -1.2, 6.0],
                attitude,
            });
            let in_camera = [[0.7, -0.4, -6.0], [-1.5, 0.9, -7.1], [0.2, 1.6, -5.3]];
            let in_camera = in_camera.map(Vector3::from);
            let points = in_camera.map(|point| truth.rotation * point + truth.position_m);
            let found = poses(in_camera.map(|point| point.normalize()), points);
            assert!(
                found
                    .iter()
                    .any(|pose| (pose.position_m - truth.position_m).norm() < 1e-7),
                "attitude {number}"
            );
        }
    }
}
