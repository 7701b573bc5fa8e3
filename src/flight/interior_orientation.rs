//! Interior orientation of a frame, for the block adjustment, and its origin.

use super::exposure::CorrectionModel;
use crate::geometry::frame_correction::Terms;
use crate::geometry::principal_point::PrincipalPointMotion;
use crate::geometry::sensor::SensorPoint;

/// The interior orientation of one frame.
///
/// Principal point and time belong together: both are means over the exposure, and only as a pair
/// are they right at every terrain height.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InteriorOrientation {
    /// η = V/H used, 1/s.
    pub vh_per_s: f32,
    /// t: exposure, s.
    pub exposure_s: f32,
    /// Δδ, δ, E\[τ\], c̄ and moments along the FMC axis.
    pub motion: PrincipalPointMotion,
    /// Principal point at the exposure centroid, sensor frame, mm.
    pub principal_point: SensorPoint,
    /// Principal distance that goes with the corrected coordinates, mm. It is the calibrated one
    /// whatever Δz is: the corrected coordinates contain the enlargement (convention (A) of
    /// `docs/conventions.md`, section 6).
    pub principal_distance_mm: f32,
    /// Δz: run-out and focus shift of this frame, mm.
    pub focus_shift_mm: f32,
    /// κ: relative enlargement of the image that Δz causes, by the formula asked for; 0 for models
    /// that have none.
    pub enlargement: f32,
    /// Model that corrects the coordinates of this frame.
    pub model: CorrectionModel,
    /// Terms that are evaluated.
    pub terms: Terms,
    /// Upper bound of the terms that model fold and kernel leave out, per axis, nm.
    pub left_out_nm: f32,
}
