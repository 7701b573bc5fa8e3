//! Values of all unknowns.

use nalgebra::{DMatrix, Vector3, Vector6};

use super::layout::{Layout, PointUnknowns};
use super::network::Network;
use super::parameters::{Parameter, SharedValues};
use super::pose::Pose;
use crate::linear::element::element;

/// Poses, object points and shared unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Positions and attitudes of the images.
    pub poses: Vec<Pose>,
    /// Object points, m.
    pub points_m: Vec<Vector3<f64>>,
    /// Shared unknowns.
    pub parameters: SharedValues,
}

/// Changes of all unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Of the images, six rows each.
    pub images: DMatrix<f64>,
    /// Of the border, in the order of [`Layout::border`].
    pub border: DMatrix<f64>,
    /// Of the object points, m; zero for those held.
    pub points: Vec<Vector3<f64>>,
    /// Fall of vᵀPv that the linearised observations predict.
    pub fall: f64,
}

impl Step {
    /// Length in the metric of the normal matrix: no function of the unknowns moves by more of its
    /// own a priori σ.
    ///
    /// # Model
    /// `√(xᵀNx)`, N of all unknowns; it is the largest `cᵀx/√(cᵀN⁻¹c)` over all c. An undamped step
    /// predicts a fall of vᵀPv by its square.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.fall.max(0.0).sqrt()
    }
}

impl State {
    /// Initial values.
    #[must_use]
    pub fn initial(network: &Network) -> Self {
        Self {
            poses: network.images.iter().map(|image| image.pose).collect(),
            points_m: network.points.iter().map(|point| point.given_m).collect(),
            parameters: network.parameters.clone(),
        }
    }

    /// Returns the values after a step.
    #[must_use]
    pub fn moved(&self, layout: &Layout, step: &Step) -> Self {
        let mut moved = self.clone();
        for (image, pose) in moved.poses.iter_mut().enumerate() {
            let own = Vector6::from_fn(|row, _| element(&step.images, 6 * image + row, 0));
            *pose = pose.moved(&own);
        }
        for (position, change) in moved.points_m.iter_mut().zip(&step.points) {
            *position += change;
        }
        for (column, parameter) in layout.border.iter().enumerate() {
            let change = element(&step.border, column, 0);
            if let Parameter::Point { point, axis } = *parameter {
                if let Some(coordinate) = moved
                    .points_m
                    .get_mut(point)
                    .and_then(|point| point.get_mut(axis))
                {
                    *coordinate += change;
                }
            } else {
                moved.parameters.add(*parameter, change);
            }
        }
        moved
    }

    /// Position of an object point, m.
    #[must_use]
    pub fn point(&self, number: usize) -> Vector3<f64> {
        self.points_m.get(number).copied().unwrap_or_default()
    }

    /// Returns true if the point's coordinates are unknowns.
    #[must_use]
    pub fn is_unknown(layout: &Layout, point: usize) -> bool {
        !matches!(
            layout.point(point),
            PointUnknowns::Held | PointUnknowns::Unused
        )
    }
}
