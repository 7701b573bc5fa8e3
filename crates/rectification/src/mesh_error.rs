//! Maps that are no mesh.

use crate::fixed_point::VERTEX_BITS;
use crate::spacing::LARGEST_ERROR_PX;

/// A map that cannot be stated as a mesh.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// Not even neighbouring pixels can be interpolated, or the map folds at the sensor's edge.
    #[error(
        "the distortion is too strong for a mesh: no spacing keeps its places within {LARGEST_ERROR_PX} px"
    )]
    TooStrong,
    /// A source lies too far from its output pixel.
    #[error("a source lies {displacement_px:.0} px from its output pixel, beyond {} px", 1 << (31 - VERTEX_BITS))]
    TooFar {
        /// Distance along an axis, pixels, less the constant part.
        displacement_px: f64,
    },
}
