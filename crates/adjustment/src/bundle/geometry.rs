//! Geometry of an adjusted network that decides what it can determine.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::layout::PointUnknowns;
use super::network::Network;
use super::pose::Pose;
use super::solution::Solution;

/// Roll about the optical axis, degrees, that separates the principal point from the attitude.
pub const LEAST_ROLL_DEG: f64 = 45.0;

/// Depth of the object points over their extent below which the field counts as plane.
const LEAST_DEPTH: f64 = 0.02;

/// Angle of an optical axis with the normal of a plane field, degrees, below which an image is not
/// tilted.
const LEAST_TILT_DEG: f64 = 10.0;

/// Returns the largest roll of an image against another about the optical axis, degrees.
#[must_use]
pub fn largest_roll_deg(poses: &[Pose]) -> f64 {
    let Some(first) = poses.first() else {
        return 0.0;
    };
    let about_axis = |pose: &Pose, reference: &Pose| {
        let relative = reference.rotation.inverse() * pose.rotation;
        let r = relative.matrix();
        (r.m21 - r.m12).atan2(r.m11 + r.m22).abs().to_degrees()
    };
    // The roll farthest from the first image's, then the farthest from that.
    let farthest = poses
        .iter()
        .max_by(|a, b| about_axis(a, first).total_cmp(&about_axis(b, first)))
        .unwrap_or(first);
    poses
        .iter()
        .map(|pose| about_axis(pose, farthest))
        .fold(0.0, f64::max)
}

/// Returns true if the object points lie in a plane and no image is tilted against it.
#[must_use]
pub fn is_plane_without_tilt(solution: &Solution) -> bool {
    let used: Vec<Vector3<f64>> = solution
        .state
        .points_m
        .iter()
        .enumerate()
        .filter(|(number, _)| solution.layout.point(*number) != PointUnknowns::Unused)
        .map(|(_, point)| *point - solution.datum.centre_m)
        .collect();
    let moments: Matrix3<f64> = used.iter().map(|point| point * point.transpose()).sum();
    let eigen = SymmetricEigen::new(moments);
    let order = |index: usize| eigen.eigenvalues.get(index).copied().unwrap_or(0.0);
    let thinnest = (0..3)
        .min_by(|a, b| order(*a).total_cmp(&order(*b)))
        .unwrap_or(0);
    let largest = eigen.eigenvalues.max();
    if largest <= 0.0 || eigen.eigenvalues.min() > LEAST_DEPTH.powi(2) * largest {
        return false;
    }
    let normal = eigen.eigenvectors.column(thinnest).into_owned();
    solution.state.poses.iter().all(|pose| {
        let axis = pose.rotation * Vector3::z();
        axis.dot(&normal).abs() > LEAST_TILT_DEG.to_radians().cos()
    })
}

/// Returns the largest angle between two rays of an object point, degrees; `None` with fewer than
/// two.
#[must_use]
pub fn intersection_deg(
    network: &Network,
    solution: &Solution,
    images: &[usize],
    point: usize,
) -> Option<f64> {
    let position = solution.state.point(point);
    let rays: Vec<Vector3<f64>> = images
        .iter()
        .filter(|image| network.images.get(**image).is_some())
        .filter_map(|image| solution.state.poses.get(*image))
        .map(|pose| (position - pose.position_m).normalize())
        .collect();
    let first = rays.first()?;
    let angle = |a: &Vector3<f64>, b: &Vector3<f64>| a.cross(b).norm().atan2(a.dot(b));
    let farthest = rays
        .iter()
        .max_by(|a, b| angle(a, first).total_cmp(&angle(b, first)))?;
    (rays.len() > 1).then(|| {
        let angles = rays.iter().map(|ray| angle(ray, farthest));
        angles.fold(0.0, f64::max).to_degrees()
    })
}

/// Returns groups of images that share no object point with each other, by number; one group for a
/// connected network.
#[must_use]
pub fn groups(network: &Network) -> Vec<Vec<usize>> {
    let count = network.images.len();
    let mut parent: Vec<usize> = (0..count).collect();
    for observed in network.by_point() {
        let mut images = observed.iter().map(|observed| observed.image);
        let Some(first) = images.next() else { continue };
        for other in images {
            let (a, b) = (root(&mut parent, first), root(&mut parent, other));
            if let Some(place) = parent.get_mut(b) {
                *place = a;
            }
        }
    }
    let mut groups: Vec<(usize, Vec<usize>)> = Vec::new();
    for image in 0..count {
        let representative = root(&mut parent, image);
        match groups
            .iter_mut()
            .find(|(other, _)| *other == representative)
        {
            Some((_, members)) => members.push(image),
            None => groups.push((representative, vec![image])),
        }
    }
    groups.into_iter().map(|(_, members)| members).collect()
}

fn root(parent: &mut [usize], mut number: usize) -> usize {
    while let Some(&above) = parent.get(number) {
        if above == number {
            break;
        }
        let grand = parent.get(above).copied().unwrap_or(above);
        if let Some(place) = parent.get_mut(number) {
            *place = grand;
        }
        number = grand;
    }
    number
}
