//! Observations of a frame: position and attitude on board, and control points.

use crate::correction::CorrectedPoint;
use crate::exterior_orientation::{ELEMENTS, ExteriorOrientation};
use crate::normal_equations::{FrameBlock, FrameVector};

/// Position and attitude observed on board; for an element without σ the observation is only an
/// initial value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PosObservation {
    /// Observed exterior orientation at the centroid of the exposure.
    pub orientation: ExteriorOrientation,
    /// σ of each element, m and rad; `None`: free.
    pub sigmas: [Option<f64>; ELEMENTS],
}

/// A control point in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlObservation {
    /// Corrected image point.
    pub corrected: CorrectedPoint,
    /// Surveyed position, ground frame, m.
    pub ground_m: [f64; 3],
}

/// Observations of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameObservations {
    /// Observation of the position and orientation system.
    pub pos: PosObservation,
    /// Control points.
    pub control: Vec<ControlObservation>,
}

/// Standard deviations of the observations on the image and on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSigmas {
    /// σ of an image coordinate, mm.
    pub image_mm: f64,
    /// σ of a coordinate of a control point, m.
    pub ground_m: f64,
}

impl PosObservation {
    /// Returns observed less adjusted elements, angles in (-π, π].
    pub(crate) fn residuals(&self, orientation: &ExteriorOrientation) -> FrameVector {
        let mut residuals = self.orientation.elements() - orientation.elements();
        for angle in residuals.iter_mut().skip(3) {
            *angle = angle.sin().atan2(angle.cos());
        }
        residuals
    }

    pub(crate) fn add_to(&self, block: &mut FrameBlock, orientation: &ExteriorOrientation) {
        let residuals = self.residuals(orientation);
        for (index, (residual, sigma)) in residuals.iter().zip(self.sigmas).enumerate() {
            let Some(sigma) = sigma else { continue };
            let weight = sigma.powi(-2);
            if let Some(element) = block.matrix.get_mut((index, index)) {
                *element += weight;
            }
            if let Some(element) = block.right.get_mut(index) {
                *element += weight * residual;
            }
        }
    }
}
