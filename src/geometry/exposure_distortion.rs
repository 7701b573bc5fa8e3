//! Distortion of an exposure: of the polynomial alone, or with residual grids.

use super::evaluation_form::Displacement;
use super::frame_correction::{Corrected, FrameCorrection};
use super::sensor::SensorPoint;

/// Distortion of one exposure, from which inverses and meshes are computed.
///
/// Only [`FrameCorrection`] and [`GriddedCorrection`] have it: it has been shown to be one-to-one
/// over the sensor, and its derivatives are those of the polynomial but for the grids' slope.
///
/// [`GriddedCorrection`]: super::gridded_correction::GriddedCorrection
pub trait ExposureDistortion: sealed::Sealed {
    /// The polynomial part, which knows the sensor and the derivatives.
    fn polynomial(&self) -> &FrameCorrection;

    /// Returns the distortion at a measured point, measured - ideal, mm, in the terms of the fold.
    fn distortion(&self, measured: SensorPoint) -> Displacement;

    /// Returns the same in all terms of the form, also those that the fold drops.
    fn full_distortion(&self, measured: SensorPoint) -> Displacement;

    /// Returns the ideal point of a measured one, and the distortion by which it moves.
    fn correct(&self, measured: SensorPoint) -> Corrected;

    /// Returns the largest residual, nm, from which a Newton step may be the last, where that of
    /// the polynomial alone is `of_polynomial_nm`.
    fn last_residual_nm(&self, of_polynomial_nm: f32) -> f32;

    /// Returns true if the polynomial is all, so that a mesh may go by its differences.
    fn is_polynomial(&self) -> bool;
}

impl ExposureDistortion for FrameCorrection {
    #[inline]
    fn polynomial(&self) -> &FrameCorrection {
        self
    }

    #[inline]
    fn distortion(&self, measured: SensorPoint) -> Displacement {
        Self::distortion(self, measured)
    }

    #[inline]
    fn full_distortion(&self, measured: SensorPoint) -> Displacement {
        let centre = self.centre();
        self.form()
            .displacement(measured.x_mm - centre.x_mm, measured.y_mm - centre.y_mm)
    }

    #[inline]
    fn correct(&self, measured: SensorPoint) -> Corrected {
        Self::correct(self, measured)
    }

    #[inline]
    fn last_residual_nm(&self, of_polynomial_nm: f32) -> f32 {
        of_polynomial_nm
    }

    #[inline]
    fn is_polynomial(&self) -> bool {
        true
    }
}

/// Seal of the trait.
pub(super) mod sealed {
    use super::FrameCorrection;

    /// Implemented by the distortions of this library alone.
    pub trait Sealed {}

    impl Sealed for FrameCorrection {}
}
