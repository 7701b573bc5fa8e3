//! One frame with the residual grids of its camera.

use super::camera::Frame;
use super::exposure::CorrectionModel;
use super::interior_orientation::InteriorOrientation;
use crate::geometry::camera_grids::CameraGrids;
use crate::geometry::gridded_correction::GriddedCorrection;

/// One frame: its interior orientation, and the correction of its points with the residual grids.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GriddedFrame<'a> {
    /// Interior orientation, as it is reported; what is left out includes the grids.
    pub interior: InteriorOrientation,
    /// Correction of its coordinates.
    pub correction: GriddedCorrection<'a>,
}

impl<'a> GriddedFrame<'a> {
    /// Returns a frame with the grids of its camera.
    ///
    /// # Model
    /// The grid of the lens moves by the centroid of the frame's motion and grows by the
    /// enlargement that the frame reports, which is 0 for the fitted model. The static model does
    /// not know the motion, and its grid does not move.
    #[must_use]
    pub fn new(frame: &Frame, grids: &CameraGrids<'a>) -> Self {
        let Frame {
            mut interior,
            correction,
        } = *frame;
        let correction = match interior.model {
            CorrectionModel::Static => GriddedCorrection::calibrated(correction, grids),
            CorrectionModel::Exact | CorrectionModel::Fitted => GriddedCorrection::exposed(
                correction,
                grids,
                &interior.motion,
                interior.enlargement,
            ),
        };
        interior.left_out_nm = correction.left_out_nm();
        Self {
            interior,
            correction,
        }
    }
}
