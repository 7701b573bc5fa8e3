//! Measured points of a scene: marks and ties.

use fmc_adjustment::collinearity::image_point;
use fmc_simulation::noise::Noise;

use super::exposure::Scene;
use super::marks::marks;
use crate::number::real;
use crate::rig::control::{ControlPoint, Place, Tie};

/// Distance of the outermost pixels' centres within which no point is measured, px.
const EDGE_PX: f64 = 2.0;
/// The same of the edge of a sub-image, beyond which an error of measurement may not put a point.
const SENSOR_EDGE_PX: f64 = -0.5;

impl Scene {
    /// Returns the true place of a ground point in the virtual image of an exposure; `None` of one
    /// behind the camera.
    #[must_use]
    pub fn virtual_of_ground(&self, exposure: usize, ground_m: [f64; 3]) -> Option<[f64; 2]> {
        let exposure = self.exposures.get(exposure)?;
        let f_px = self.rig.principal_distance_px();
        let [x, y] = image_point(&exposure.orientation, f_px, ground_m)?;
        let [u, v] = self.rig.frame.centre_px();
        Some([u + x, v - y])
    }

    /// Returns the control measured in an exposure, with the noise of image points and of control
    /// coordinates, which all exposures share.
    #[must_use]
    pub fn control(&self, exposure: usize) -> Vec<ControlPoint> {
        let Some(name) = self.exposures.get(exposure).map(|one| one.name.clone()) else {
            return Vec::new();
        };
        let mut of_ground = Noise::new(self.seed(10), 0);
        let mut of_image = Noise::new(self.seed(11), exposure as u64);
        let sigma_m = self.request.control_sigma_m;
        let mut control = Vec::new();
        for mark in &self.marks {
            let error_m = of_ground.next([sigma_m; 3]);
            let Some(place) = self.virtual_of_ground(exposure, mark.ground_m) else {
                continue;
            };
            for (number, sub) in self.rig.sub.iter().enumerate() {
                let Some(pixel) = self.truth.pixel(sub, number, place) else {
                    continue;
                };
                let error_px = of_image.next([self.request.noise_px; 2]);
                if let Some(pixel) = measured(sub.size_px(), pixel, error_px) {
                    let [x, y, z] = mark.ground_m;
                    control.push(ControlPoint {
                        id: mark.id.clone(),
                        exposure: name.clone(),
                        place: Place { sub: number, pixel },
                        ground_m: [x + error_m[0], y + error_m[1], z + error_m[2]],
                        sigma_m: sigma_m.max(1e-3),
                        line: 0,
                    });
                }
            }
        }
        control
    }

    /// Returns the ties measured in an exposure: places spread evenly over each overlap.
    #[must_use]
    pub fn ties(&self, exposure: usize) -> Vec<Tie> {
        let Some(name) = self.exposures.get(exposure).map(|one| one.name.clone()) else {
            return Vec::new();
        };
        let mut noise = Noise::new(self.seed(12), exposure as u64);
        let mut ties = Vec::new();
        for first in 0..self.rig.sub.len() {
            for second in first + 1..self.rig.sub.len() {
                let places = self.overlap_places(first, second, self.request.ties);
                for (number, place) in places.iter().enumerate() {
                    let places = [first, second].map(|sub| {
                        let description = self.rig.sub.get(sub)?;
                        let pixel = self.truth.pixel(description, sub, *place)?;
                        let error_px = noise.next([self.request.noise_px; 2]);
                        let pixel = measured(description.size_px(), pixel, error_px)?;
                        Some(Place { sub, pixel })
                    });
                    if let [Some(one), Some(other)] = places {
                        ties.push(Tie {
                            id: format!("{name}-T{}{}-{number:02}", first + 1, second + 1),
                            exposure: name.clone(),
                            places: [one, other],
                        });
                    }
                }
            }
        }
        ties
    }
}

impl Scene {
    /// Returns so many places spread evenly over the nominal overlap of two neighbours, in the
    /// virtual image; none where they do not overlap along an edge.
    pub(super) fn overlap_places(
        &self,
        first: usize,
        second: usize,
        count: usize,
    ) -> Vec<[f64; 2]> {
        match overlap(self, first, second) {
            Some((least, most)) => marks(count, least, most),
            None => Vec::new(),
        }
    }
}

/// Returns the measured place of a point; `None` of one that is too near to the edge, or that its
/// error puts off the sub-image.
fn measured(size_px: [usize; 2], pixel: [f64; 2], error_px: [f64; 2]) -> Option<[f64; 2]> {
    let found = [pixel[0] + error_px[0], pixel[1] + error_px[1]];
    let is_seen = is_inside(size_px, pixel, EDGE_PX) && is_inside(size_px, found, SENSOR_EDGE_PX);
    is_seen.then_some(found)
}

fn is_inside([width, height]: [usize; 2], [col, row]: [f64; 2], edge_px: f64) -> bool {
    let is_between =
        |place: f64, count: usize| (edge_px..=real(count) - 1.0 - edge_px).contains(&place);
    is_between(col, width) && is_between(row, height)
}

/// Returns the corners of the nominal overlap of two neighbours in the virtual image; `None` where
/// they touch at a corner only.
fn overlap(scene: &Scene, first: usize, second: usize) -> Option<([f64; 2], [f64; 2])> {
    let (a, b) = (scene.rig.sub.get(first)?, scene.rig.sub.get(second)?);
    let centre = scene.rig.frame.centre_px();
    let mut corners = [[0.0; 2]; 2];
    let mut sides = [0.0; 2];
    for (axis, side) in sides.iter_mut().enumerate() {
        let pick = |pair: [f64; 2]| pair.get(axis).copied().unwrap_or_default();
        let half = |sub: &crate::rig::SubImage| pick(sub.centre_px()) + 0.5;
        let least = (pick(a.place_px) - half(a)).max(pick(b.place_px) - half(b));
        let most = (pick(a.place_px) + half(a)).min(pick(b.place_px) + half(b));
        *side = most - least;
        for (corner, value) in corners.iter_mut().zip([least, most]) {
            if let Some(slot) = corner.get_mut(axis) {
                *slot = pick(centre) + value;
            }
        }
    }
    let [width, height] = sides;
    let longest = width.max(height);
    let is_edge = width > 0.0 && height > 0.0 && longest > 4.0 * width.min(height);
    is_edge.then_some(corners.into())
}
