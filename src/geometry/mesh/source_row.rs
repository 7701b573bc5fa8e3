//! Ways from points of the ideal image to the measured ones, along a row.

use crate::geometry::evaluation_form::{Displacement, Jacobian};
use crate::geometry::exposure_distortion::ExposureDistortion;
use crate::geometry::frame_correction::FrameCorrection;
use crate::geometry::inverse::{DistortError, MAX_STEPS, shifted};
use crate::geometry::newton_step::newton_step;
use crate::geometry::sensor::SensorPoint;

/// Largest residual, nm, that is removed without derivatives: a distortion of slope q leaves the
/// share q of it, 0.1 nm for 5 %.
pub(crate) const LAST_FIXED_POINT_RESIDUAL_NM: f32 = 2.0;

/// Largest residual, nm, after which a Newton step is the last, unless it crosses an edge of the
/// sensor: the step leaves half the second derivative of the distortion times the square of a
/// micrometre, 0.001 nm for 0.5 mm of distortion over 104 mm.
pub(crate) const LAST_NEWTON_RESIDUAL_NM: f32 = 1000.0;

/// Displacements from ideal points to measured ones, each predicted from those before.
///
/// # Model
/// `d = D(ideal + d)`, as [`FrameCorrection::distort`] solves it, but starting from the parabola
/// through the three displacements before: along a row of a mesh its error is nanometres, and one
/// evaluation of D is enough. Where the error is larger, Newton's method follows. A measured point
/// may lie off the sensor, where there is no image but a warp engine needs a number: there the
/// distortion of the nearest point of the sensor counts, which continues the map without a jump.
/// All terms of the form are evaluated, also those that
/// [`Terms::Short`](crate::geometry::frame_correction::Terms::Short) drops. With residual grids
/// ([`GriddedCorrection`](crate::geometry::gridded_correction::GriddedCorrection)) D is the
/// polynomial with the grids, and the derivatives are those of the polynomial.
///
/// # Units and frames
/// Sensor frame, mm; measured - ideal, as a function of the *ideal* point.
///
/// # Accuracy
/// Within 0.3 nm of the exact inverse at 0.5 mm of distortion over 104 mm, rounding included
/// (`tests/geometry/source_row.rs`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceRow<'frame, D = FrameCorrection> {
    correction: &'frame D,
    last: Option<Displacement>,
    /// Difference of the last displacement to the one before.
    change: Displacement,
    predicted: Displacement,
}

impl<'frame, D: ExposureDistortion> SourceRow<'frame, D> {
    /// Returns a row of a frame, before its first point.
    #[must_use]
    pub const fn new(correction: &'frame D) -> Self {
        const NONE: Displacement = Displacement {
            dx_mm: 0.0,
            dy_mm: 0.0,
        };
        Self {
            correction,
            last: None,
            change: NONE,
            predicted: NONE,
        }
    }

    /// Returns the displacement from the next ideal point to its measured one. Points of a mesh are
    /// equidistant; others take more steps.
    ///
    /// # Errors
    /// [`DistortError::NotConverged`] for an ideal point that is not finite, and if Newton's method
    /// does not end in [`MAX_STEPS`] steps.
    #[inline]
    pub fn next(&mut self, ideal: SensorPoint) -> Result<Displacement, DistortError> {
        let first = || self.distortion(self.polynomial().clamped(ideal));
        let d = self.last.map_or_else(first, |_| self.predicted);
        let measured = shifted(ideal, d);
        let distortion = self.distortion(self.polynomial().clamped(measured));
        let residual = difference(d, distortion);
        let d = if length_nm(residual) <= LAST_FIXED_POINT_RESIDUAL_NM
            && (measured.x_mm + measured.y_mm).is_finite()
        {
            distortion
        } else {
            self.newton(ideal, d)?
        };
        let change = self
            .last
            .map_or(Displacement::default(), |last| difference(d, last));
        let bend = difference(change, self.change);
        self.last = Some(d);
        self.change = change;
        self.predicted = Displacement {
            dx_mm: d.dx_mm + (change.dx_mm + bend.dx_mm),
            dy_mm: d.dy_mm + (change.dy_mm + bend.dy_mm),
        };
        Ok(d)
    }

    fn newton(&self, ideal: SensorPoint, from: Displacement) -> Result<Displacement, DistortError> {
        let mut d = from;
        let mut residual_nm = f32::NAN;
        for _ in 0..MAX_STEPS {
            let measured = shifted(ideal, d);
            let residual = difference(d, self.distortion(self.polynomial().clamped(measured)));
            let step = newton_step(self.jacobian(measured), residual);
            d = difference(d, step);
            residual_nm = length_nm(residual);
            let point = shifted(ideal, d);
            // A step that has crossed the sensor's edge used the derivatives of the wrong side.
            let last_nm = if self.off_sensor(measured) == self.off_sensor(point) {
                self.correction.last_residual_nm(LAST_NEWTON_RESIDUAL_NM)
            } else {
                LAST_FIXED_POINT_RESIDUAL_NM
            };
            if residual_nm <= last_nm && (point.x_mm + point.y_mm).is_finite() {
                return Ok(d);
            }
        }
        Err(DistortError::NotConverged { residual_nm })
    }

    #[inline]
    fn distortion(&self, point: SensorPoint) -> Displacement {
        self.correction.full_distortion(point)
    }

    #[inline]
    fn polynomial(&self) -> &'frame FrameCorrection {
        self.correction.polynomial()
    }

    /// Returns the derivatives of the distortion; off the sensor it does not change in the
    /// direction that leads away.
    fn jacobian(&self, measured: SensorPoint) -> Jacobian {
        let mut jacobian = self
            .polynomial()
            .jacobian(self.polynomial().clamped(measured));
        let [off_x, off_y] = self.off_sensor(measured);
        if off_x {
            jacobian.dx_by_x = 0.0;
            jacobian.dy_by_x = 0.0;
        }
        if off_y {
            jacobian.dx_by_y = 0.0;
            jacobian.dy_by_y = 0.0;
        }
        jacobian
    }

    /// Returns true for a point beyond the left or right edge, and for one beyond the lower or
    /// upper edge.
    fn off_sensor(&self, point: SensorPoint) -> [bool; 2] {
        let nearest = self.polynomial().clamped(point);
        [
            (point.x_mm - nearest.x_mm).abs() > 0.0,
            (point.y_mm - nearest.y_mm).abs() > 0.0,
        ]
    }
}

fn difference(of: Displacement, and: Displacement) -> Displacement {
    Displacement {
        dx_mm: of.dx_mm - and.dx_mm,
        dy_mm: of.dy_mm - and.dy_mm,
    }
}

fn length_nm(residual: Displacement) -> f32 {
    1e6 * (residual.dx_mm.abs() + residual.dy_mm.abs())
}
