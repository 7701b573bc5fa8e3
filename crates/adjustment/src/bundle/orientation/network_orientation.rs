//! Initial orientation of all images of a network, and initial coordinates of its points.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::bundle::interior::Interior;
use crate::bundle::network::{ImagePoint, Network, PointRole};
use crate::bundle::pose::Pose;

use super::intersection::intersected;
use super::resection::{KnownPoint, resected};
use super::similarity::vertical;

/// Rounds of orientation and intersection.
const MOST_ROUNDS: usize = 100;

/// Images and points without initial values.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Unoriented {
    /// Numbers of the images that could not be oriented.
    pub images: Vec<usize>,
    /// Numbers of the points seen by two images at least whose rays do not meet.
    pub points: Vec<usize>,
    /// Numbers of the images that were taken for vertical ones, since they show fewer than four
    /// points with coordinates.
    pub taken_for_vertical: Vec<usize>,
}

/// Values known before the adjustment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KnownValues {
    /// `true` for an image with an initial pose.
    pub images: Vec<bool>,
    /// `true` for an object point with initial coordinates.
    pub points: Vec<bool>,
}

/// Finds initial poses and coordinates, and writes them into the network.
///
/// # Model
/// Images are resected from at least four points with coordinates, points intersected from two
/// images at least, in turn until nothing changes. Images that are left then, with two known points
/// at least, are taken for vertical ones.
pub fn orient(network: &mut Network, mut known: KnownValues) -> Unoriented {
    let by_image = places_by_image(network);
    let mut taken_for_vertical = Vec::new();
    for _ in 0..MOST_ROUNDS {
        let by_resection = |interior: &Interior, points: &[KnownPoint]| {
            resected(interior, points).map(|resected| resected.pose)
        };
        let oriented = orient_images(network, &mut known, &by_image, by_resection);
        let intersected = intersect_points(network, &mut known);
        if !oriented.is_empty() || intersected {
            continue;
        }
        let taken = orient_images(network, &mut known, &by_image, vertical);
        if taken.is_empty() {
            break;
        }
        taken_for_vertical.extend(taken);
    }
    let unknown = |flags: &[bool]| {
        let numbers = flags.iter().enumerate();
        numbers
            .filter_map(|(number, known)| (!known).then_some(number))
            .collect()
    };
    Unoriented {
        images: unknown(&known.images),
        points: unknown(&known.points),
        taken_for_vertical,
    }
}

fn places_by_image(network: &Network) -> Vec<Vec<usize>> {
    let mut places = vec![Vec::new(); network.images.len()];
    for (place, observed) in network.image_points.iter().enumerate() {
        if let Some(list) = places.get_mut(observed.image) {
            list.push(place);
        }
    }
    places
}

fn is_known(flags: &[bool], number: usize) -> bool {
    flags.get(number).copied().unwrap_or(false)
}

/// Finds poses of images that have none; returns their numbers.
fn orient_images(
    network: &mut Network,
    known: &mut KnownValues,
    by_image: &[Vec<usize>],
    pose: impl Fn(&Interior, &[KnownPoint]) -> Option<Pose>,
) -> Vec<usize> {
    let mut found = HashMap::new();
    for (number, places) in by_image.iter().enumerate() {
        if is_known(&known.images, number) {
            continue;
        }
        let points: Vec<KnownPoint> = places
            .iter()
            .filter_map(|place| network.image_points.get(*place))
            .filter(|observed| observed.accepted && is_known(&known.points, observed.point))
            .filter_map(|observed| {
                let point = network.points.get(observed.point)?;
                (point.role != PointRole::Check).then_some(KnownPoint {
                    measured_mm: observed.measured_mm,
                    ground_m: point.given_m,
                })
            })
            .collect();
        if let Some(pose) = pose(&network.parameters.interior, &points) {
            found.insert(number, pose);
        }
    }
    for (number, image) in network.images.iter_mut().enumerate() {
        if let (Some(pose), Some(flag)) = (found.get(&number), known.images.get_mut(number)) {
            image.pose = *pose;
            *flag = true;
        }
    }
    let mut numbers: Vec<usize> = found.into_keys().collect();
    numbers.sort_unstable();
    numbers
}

fn intersect_points(network: &mut Network, known: &mut KnownValues) -> bool {
    let mut found: HashMap<usize, Vector3<f64>> = HashMap::new();
    for observed in network.by_point() {
        let Some(&ImagePoint { point, .. }) = observed.first() else {
            continue;
        };
        if is_known(&known.points, point) {
            continue;
        }
        let rays: Vec<_> = observed
            .iter()
            .filter(|observed| observed.accepted && is_known(&known.images, observed.image))
            .filter_map(|observed| {
                let image = network.images.get(observed.image)?;
                Some((image.pose, observed.measured_mm))
            })
            .collect();
        if rays.len() > 1
            && let Some(position) = intersected(&network.parameters.interior, &rays)
        {
            found.insert(point, position);
        }
    }
    for (number, point) in network.points.iter_mut().enumerate() {
        if let (Some(position), Some(flag)) = (found.get(&number), known.points.get_mut(number)) {
            point.given_m = *position;
            *flag = true;
        }
    }
    !found.is_empty()
}
