//! The way from points of the ideal image to the measured ones, along a row.

use crate::geometry::evaluation_form::{Displacement, Jacobian};
use crate::geometry::frame_correction::FrameCorrection;
use crate::geometry::inverse::{DistortError, MAX_STEPS, newton_step, shifted};
use crate::geometry::sensor::SensorPoint;

/// The step taken from a residual of at most this length, nm, is the last one: what is left is half the second
/// derivative of the distortion times the square of a micrometre, 0.001 nm for 0.5 mm of distortion over 104 mm.
pub const LAST_ROW_RESIDUAL_NM: f32 = 1000.0;

/// The displacements from ideal points to measured ones, each found from those before.
///
/// # Model
/// As [`FrameCorrection::distort`], Newton's method on `d - D(ideal + d) = 0`, but from `d = 2d₋₁ - d₋₂`: along a row of
/// a mesh one step is enough. A measured point may lie off the sensor, where no image is but a warp engine wants a
/// number: there the distortion of the nearest point of the sensor counts, which continues the map without a jump.
///
/// # Units and frames
/// Sensor frame, mm; measured - ideal, as a function of the *ideal* point.
///
/// # Accuracy
/// Within 0.2 nm of the exact inverse of [`FrameCorrection::distortion`] at 0.5 mm of distortion over 104 mm, rounding
/// included (`tests/geometry/source_row.rs`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceRow<'frame> {
    correction: &'frame FrameCorrection,
    last: Option<Displacement>,
    predicted: Displacement,
}

impl<'frame> SourceRow<'frame> {
    /// A row of a frame, before its first point.
    #[must_use]
    pub const fn new(correction: &'frame FrameCorrection) -> Self {
        Self {
            correction,
            last: None,
            predicted: Displacement {
                dx_mm: 0.0,
                dy_mm: 0.0,
            },
        }
    }

    /// From the next ideal point to its measured one. Points of a mesh are equidistant; others take more steps.
    ///
    /// # Errors
    /// [`DistortError::NotConverged`]: for an ideal point that is not finite, and where Newton's method does not end in
    /// [`MAX_STEPS`] steps.
    pub fn next(&mut self, ideal: SensorPoint) -> Result<Displacement, DistortError> {
        let mut d = match self.last {
            Some(_) => self.predicted,
            None => self.correction.distortion(self.correction.clamped(ideal)),
        };
        let mut residual_nm = f32::NAN;
        for _ in 0..MAX_STEPS {
            let measured = shifted(ideal, d);
            let (distortion, jacobian) = self.continued(measured);
            let residual = Displacement {
                dx_mm: d.dx_mm - distortion.dx_mm,
                dy_mm: d.dy_mm - distortion.dy_mm,
            };
            let step = newton_step(jacobian, residual);
            d = Displacement {
                dx_mm: d.dx_mm - step.dx_mm,
                dy_mm: d.dy_mm - step.dy_mm,
            };
            residual_nm = 1e6 * (residual.dx_mm.abs() + residual.dy_mm.abs());
            if residual_nm <= LAST_ROW_RESIDUAL_NM && (d.dx_mm + d.dy_mm).is_finite() {
                let last = self.last.replace(d).unwrap_or(d);
                self.predicted = Displacement {
                    dx_mm: d.dx_mm + (d.dx_mm - last.dx_mm),
                    dy_mm: d.dy_mm + (d.dy_mm - last.dy_mm),
                };
                return Ok(d);
            }
        }
        Err(DistortError::NotConverged { residual_nm })
    }

    /// The distortion and its derivatives; off the sensor those of the nearest point, constant in the direction that
    /// leads away.
    #[inline]
    fn continued(&self, measured: SensorPoint) -> (Displacement, Jacobian) {
        let nearest = self.correction.clamped(measured);
        let distortion = self.correction.distortion(nearest);
        let mut jacobian = self.correction.jacobian(nearest);
        if (measured.x_mm - nearest.x_mm).abs() > 0.0 {
            jacobian.dx_by_x = 0.0;
            jacobian.dy_by_x = 0.0;
        }
        if (measured.y_mm - nearest.y_mm).abs() > 0.0 {
            jacobian.dx_by_y = 0.0;
            jacobian.dy_by_y = 0.0;
        }
        (distortion, jacobian)
    }
}
