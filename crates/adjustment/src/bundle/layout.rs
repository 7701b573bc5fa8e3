//! Places of the unknowns in the normal equations.

use crate::correction::COEFFICIENTS;
use crate::linear::bordered_factor::{EliminationOrder, Singular};
use crate::linear::image_pairs::ImagePairs;

use super::interior::{INTERIOR_ELEMENTS, InteriorElement};
use super::network::{ImagePoint, Network, ScaleBar};
use super::parameters::Parameter;
use super::stage::{STAGE_ELEMENTS, StageElement};

/// Number of unknowns of the camera: interior orientation, stage, additional parameters.
pub const CAMERA_UNKNOWNS: usize = INTERIOR_ELEMENTS + STAGE_ELEMENTS + COEFFICIENTS;

/// Treatment of an object point's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointUnknowns {
    /// Coordinates without error.
    Held,
    /// Unknowns, eliminated point by point.
    Eliminated,
    /// Unknowns of the border, from this column on: ends of scale bars.
    Border(usize),
    /// Too few observations; the point does not take part.
    Unused,
}

/// Places of the unknowns.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Unknowns of the border: those of the camera first.
    pub border: Vec<Parameter>,
    /// Column of the border of each unknown of the camera: interior orientation, stage, additional
    /// parameters.
    pub camera: [Option<usize>; CAMERA_UNKNOWNS],
    points: Vec<PointUnknowns>,
    order: EliminationOrder,
    pairs: ImagePairs,
}

impl Layout {
    /// Finds the places for a network, its image points in order.
    ///
    /// # Errors
    /// [`Singular`] if the matrix does not fit into memory.
    pub fn new(network: &Network) -> Result<Self, Singular> {
        let mut border: Vec<Parameter> = network.estimated.clone();
        border.sort_unstable();
        border.dedup();
        let interior = InteriorElement::ALL.into_iter().map(Parameter::Interior);
        let stage = StageElement::ALL.into_iter().map(Parameter::Stage);
        let additional = (0..COEFFICIENTS).map(Parameter::Additional);
        let mut camera = [None; CAMERA_UNKNOWNS];
        let unknowns = interior.chain(stage).chain(additional);
        for (place, parameter) in camera.iter_mut().zip(unknowns) {
            *place = border.iter().position(|other| *other == parameter);
        }
        let mut rays = vec![0_usize; network.points.len()];
        for observed in network
            .image_points
            .iter()
            .filter(|observed| observed.accepted)
        {
            if let Some(count) = rays.get_mut(observed.point) {
                *count += 1;
            }
        }
        let mut points: Vec<PointUnknowns> = network
            .points
            .iter()
            .zip(rays)
            .map(|(point, rays)| {
                let observed = point.observed_sigmas().iter().flatten().count();
                if point.is_held() {
                    PointUnknowns::Held
                } else if 2 * rays + observed > 3 && rays > 0 {
                    PointUnknowns::Eliminated
                } else {
                    PointUnknowns::Unused
                }
            })
            .collect();
        for end in network.scale_bars.iter().flat_map(|bar| bar.ends) {
            if let Some(unknowns @ PointUnknowns::Eliminated) = points.get_mut(end) {
                *unknowns = PointUnknowns::Border(border.len());
                border.extend((0..3).map(|axis| Parameter::Point { point: end, axis }));
            }
        }
        let groups: Vec<Vec<usize>> = network
            .by_point()
            .filter(|rays| {
                let point = rays.first().map(|ray| ray.point);
                point.and_then(|point| points.get(point)) == Some(&PointUnknowns::Eliminated)
            })
            .map(|rays| rays.iter().map(|ray| ray.image).collect())
            .collect();
        let groups: Vec<&[usize]> = groups.iter().map(Vec::as_slice).collect();
        let pairs = ImagePairs::new(network.images.len(), &groups);
        Ok(Self {
            border,
            camera,
            points,
            order: EliminationOrder::new(&pairs)?,
            pairs,
        })
    }

    /// Treatment of an object point.
    #[must_use]
    pub fn point(&self, number: usize) -> PointUnknowns {
        self.points
            .get(number)
            .copied()
            .unwrap_or(PointUnknowns::Unused)
    }

    /// Returns true if an image point takes part.
    #[must_use]
    pub fn uses(&self, observed: &ImagePoint) -> bool {
        observed.accepted && self.point(observed.point) != PointUnknowns::Unused
    }

    /// Returns true if a scale bar takes part: a bar with an end that does not says nothing of the
    /// other end.
    #[must_use]
    pub fn uses_bar(&self, bar: &ScaleBar) -> bool {
        let is_used = |end: usize| self.point(end) != PointUnknowns::Unused;
        bar.ends.into_iter().all(is_used)
    }

    /// Column of a shared unknown.
    #[must_use]
    pub fn column(&self, parameter: Parameter) -> Option<usize> {
        self.border.iter().position(|other| *other == parameter)
    }

    /// Unknowns of the camera that are estimated, with their columns of the border.
    pub fn camera_columns(&self) -> impl Iterator<Item = (usize, usize)> {
        let places = self.camera.iter().enumerate();
        places.filter_map(|(index, place)| Some((index, (*place)?)))
    }

    /// Number of object points with unknown coordinates.
    #[must_use]
    pub fn unknown_points(&self) -> usize {
        let is_unknown = |point: &&PointUnknowns| {
            matches!(point, PointUnknowns::Eliminated | PointUnknowns::Border(_))
        };
        self.points.iter().filter(is_unknown).count()
    }

    /// Number of unknowns of a network of so many images.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        let eliminated = self
            .points
            .iter()
            .filter(|point| **point == PointUnknowns::Eliminated)
            .count();
        6 * self.pairs.images() + self.border.len() + 3 * eliminated
    }

    /// Order of elimination of the images.
    #[must_use]
    pub const fn order(&self) -> &EliminationOrder {
        &self.order
    }

    /// Pairs of images that share an unknown point.
    #[must_use]
    pub const fn pairs(&self) -> &ImagePairs {
        &self.pairs
    }
}
