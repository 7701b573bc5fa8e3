//! Observations of a frame: position and attitude on board, and control points.

use crate::correction::CorrectedPoint;
use crate::exterior_orientation::{ELEMENTS, ExteriorOrientation};

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
