//! From the ideal point to the measured one.

use core::fmt;

use super::evaluation_form::{Displacement, Jacobian};
use super::frame_correction::{Corrected, FrameCorrection, Kernel};
use super::sensor::SensorPoint;

/// Most Newton steps without looking where they lead; a lens of up to a per cent of distortion needs one.
pub const FREE_STEPS: u8 = 3;

/// Most Newton steps along which every place is kept on the sensor.
pub const MAX_STEPS: u8 = 12;

/// The step taken on the sensor from a residual of at most this length, nm, is the last one: Newton's
/// steps shrink quadratically, and the next would be far below rounding.
pub const LAST_RESIDUAL_NM: f32 = 20.0;

/// No measured point belongs to the ideal one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub enum DistortError {
    /// The measured point lies off the sensor as far as Newton's method leads: at this place.
    OffSensor(SensorPoint),
    /// The residual was still this long after [`MAX_STEPS`] steps, nm; a NaN for an ideal point
    /// that is not finite.
    NotConverged {
        /// Length of the residual, nm.
        residual_nm: f32,
    },
}

impl fmt::Display for DistortError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OffSensor(point) => write!(
                f,
                "its measured point ({:.4}, {:.4}) mm is off the sensor",
                point.x_mm, point.y_mm
            ),
            Self::NotConverged { residual_nm } => write!(
                f,
                "no measured point found: {residual_nm} nm are left after {MAX_STEPS} Newton steps"
            ),
        }
    }
}

impl core::error::Error for DistortError {}

/// A point of a slice to which no measured one belongs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistortSliceError {
    /// Its place in the slice, from 0.
    pub index: usize,
    /// Why.
    pub error: DistortError,
}

impl fmt::Display for DistortSliceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "point {}: {}", self.index, self.error)
    }
}

impl core::error::Error for DistortSliceError {}

impl FrameCorrection {
    /// The measured point of an ideal one: the inverse of [`Self::correct`].
    ///
    /// # Model
    /// Newton's method on the displacement d: `d - D(ideal + d) = 0`. Iterating the displacement, not
    /// the coordinate, keeps its finer resolution until the one addition at the end. The calibration
    /// has been shown to be one-to-one over the sensor, so that a solution on the sensor is the only one.
    ///
    /// First from where the radial terms lead, `d = D(ideal)·(1 + s + s²)` with the slope s of the radial
    /// distortion, up to [`FREE_STEPS`] steps. The last is one so short that it leaves no more than
    /// [`LEFT_BY_ONE_STEP_NM`](super::newton_step::LEFT_BY_ONE_STEP_NM), by a bound of the frame's curvature (Newton and Kantorovich), and it must
    /// end on the sensor; on lenses of up to a per cent of distortion it is the first.
    ///
    /// Where there is none, again from `d = D(ideal)` with every place kept on the sensor, at most [`MAX_STEPS`]
    /// steps, the last from a residual of at most [`LAST_RESIDUAL_NM`].
    ///
    /// # Units and frames
    /// Sensor frame, mm. The ideal point may lie off the sensor; the measured one must lie on it,
    /// edges included.
    ///
    /// # Accuracy
    /// `distort(correct(p))` is within two units in the last place of p, or of its ideal point
    /// where that is larger, divided by the scale `∂(ideal)/∂(measured)` where that is below 0.7,
    /// and within 0.02 nm where all this is less (`tests/geometry/round_trip.rs`). The displacement is
    /// within 0.11 nm of that in double precision on the published cameras (`tests/geometry/inverse.rs`).
    /// Instructions on Cortex-M4F and M7 where the first step is the last: 115 with the short kernel and 128 with the full
    /// one (`docs/instructions.csv`); where every place has to be kept on the sensor, some hundred more.
    ///
    /// # Errors
    /// [`DistortError`]; never a finite point that does not belong to `ideal`. A lens of tens of
    /// per cent of distortion may hold Newton's method at an edge or cycling: then an error, though
    /// there is a measured point.
    #[inline]
    pub fn distort(&self, ideal: SensorPoint) -> Result<Corrected, DistortError> {
        let quick = match self.kernel() {
            Kernel::Short => self.freely::<false>(ideal),
            Kernel::Full => self.freely::<true>(ideal),
        };
        match quick {
            Some(measured) => Ok(measured),
            None => self.kept_on_sensor(ideal),
        }
    }

    /// [`Self::distort`] by free steps; `None` where they do not find a point of the sensor.
    #[expect(
        clippy::inline_always,
        reason = "a call per point would load the coefficients again: 20 instructions"
    )]
    #[inline(always)]
    fn freely<const FULL: bool>(&self, ideal: SensorPoint) -> Option<Corrected> {
        let (centre, form) = (self.centre(), self.form());
        let (x, y) = (ideal.x_mm - centre.x_mm, ideal.y_mm - centre.y_mm);
        let mut distortion = form.start::<FULL>(x, y);
        for _ in 0..FREE_STEPS {
            let step2_mm2;
            (distortion, step2_mm2) = form.stepped::<FULL>(x, y, distortion);
            if step2_mm2 <= self.longest_last_step2() {
                let point = shifted(ideal, distortion);
                return self
                    .contains(point)
                    .then_some(Corrected { point, distortion });
            }
        }
        None
    }

    /// [`Self::distort`] where free steps find nothing: at the edge, beyond it, and with a strong lens. It decides which
    /// error it is.
    #[cold]
    #[inline(never)]
    fn kept_on_sensor(&self, ideal: SensorPoint) -> Result<Corrected, DistortError> {
        // Every iterate stays on the sensor, where the map is one-to-one: beyond it the polynomial
        // may have other roots.
        let mut d = self.on_sensor(ideal, self.distortion(self.clamped(ideal)));
        let mut residual_nm = f32::NAN;
        for _ in 0..MAX_STEPS {
            let measured = shifted(ideal, d);
            let distortion = self.distortion(measured);
            let residual = Displacement {
                dx_mm: d.dx_mm - distortion.dx_mm,
                dy_mm: d.dy_mm - distortion.dy_mm,
            };
            let step = newton_step(self.jacobian(measured), residual);
            let next = Displacement {
                dx_mm: d.dx_mm - step.dx_mm,
                dy_mm: d.dy_mm - step.dy_mm,
            };
            residual_nm = 1e6 * (residual.dx_mm.abs() + residual.dy_mm.abs());
            if !(next.dx_mm + next.dy_mm).is_finite() {
                break;
            }
            let point = shifted(ideal, next);
            if residual_nm <= LAST_RESIDUAL_NM {
                return if self.contains(point) {
                    Ok(Corrected {
                        point,
                        distortion: next,
                    })
                } else {
                    Err(DistortError::OffSensor(point))
                };
            }
            let kept = self.on_sensor(ideal, next);
            if kept == d {
                // The edge holds it back: the measured point is beyond.
                return Err(DistortError::OffSensor(point));
            }
            d = kept;
        }
        Err(DistortError::NotConverged { residual_nm })
    }

    /// Replaces every ideal point of a slice by its measured point.
    ///
    /// # Model
    /// [`Self::distort`], bit for bit, on every machine. A point does not touch another.
    ///
    /// # Units and frames
    /// Sensor frame, mm; domain as [`Self::distort`].
    ///
    /// # Accuracy
    /// That of [`Self::distort`]. Instructions to a point on Cortex-M4F and M7 where the first step is the last: 95 with the
    /// short kernel and 106 with the full one.
    ///
    /// # Errors
    /// [`DistortSliceError`] for the first point that no measured one belongs to. Those before it have been replaced; it
    /// and those behind it are as they were.
    ///
    /// # Examples
    /// ```
    /// # use fmc_camera::{Brown, Calibration, CalibrationRecord, FrameCorrection, SensorPoint};
    /// let mut record = CalibrationRecord::new(100.0, [9216, 9216], 8.75);
    /// record.distortion = Brown { k1: 1e-6, ..Brown::NONE };
    /// let correction = FrameCorrection::without_motion(&Calibration::new(record)?);
    /// // K1·r² = 1e-6 * 500 of each measured coordinate; half the side is 40.32 mm.
    /// let mut points = [SensorPoint::new(9.995, 19.99), SensorPoint::new(0.0, 50.0)];
    /// let refused = correction.distort_slice(&mut points).unwrap_err();
    /// assert_eq!((points[0], refused.index), (SensorPoint::new(10.0, 20.0), 1));
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn distort_slice(&self, points: &mut [SensorPoint]) -> Result<(), DistortSliceError> {
        let mut rest = points;
        let mut index = 0;
        loop {
            let found = match self.kernel() {
                Kernel::Short => self.free_run::<false>(rest),
                Kernel::Full => self.free_run::<true>(rest),
            };
            let left = rest.get_mut(found..).and_then(<[_]>::split_first_mut);
            let Some((point, behind)) = left else {
                return Ok(());
            };
            index += found;
            let measured = self.kept_on_sensor(*point);
            *point = measured
                .map_err(|error| DistortSliceError { index, error })?
                .point;
            index += 1;
            rest = behind;
        }
    }

    /// Replaces points as long as one step is enough; how many. A loop that calls nothing keeps the coefficients in registers.
    #[inline(never)]
    fn free_run<const FULL: bool>(&self, points: &mut [SensorPoint]) -> usize {
        let all = points.len();
        let is_last = |point: &mut SensorPoint| match self.freely::<FULL>(*point) {
            Some(measured) => {
                *point = measured.point;
                false
            }
            None => true,
        };
        points.iter_mut().position(is_last).unwrap_or(all)
    }

    /// The displacement cut where it would leave the sensor.
    fn on_sensor(&self, ideal: SensorPoint, d: Displacement) -> Displacement {
        let point = shifted(ideal, d);
        let clamped = self.clamped(point);
        let cut = |d: f32, point: f32, clamped: f32| {
            let beyond = point - clamped;
            if beyond.abs() > 0.0 { d - beyond } else { d }
        };
        Displacement {
            dx_mm: cut(d.dx_mm, point.x_mm, clamped.x_mm),
            dy_mm: cut(d.dy_mm, point.y_mm, clamped.y_mm),
        }
    }
}

/// `(I - J)⁻¹` times the residual; not finite where I - J is singular.
pub(super) fn newton_step(j: Jacobian, residual: Displacement) -> Displacement {
    let scale_x = 1.0 - j.dx_by_x;
    let scale_y = 1.0 - j.dy_by_y;
    let determinant = scale_x * scale_y - j.dx_by_y * j.dy_by_x;
    Displacement {
        dx_mm: (scale_y * residual.dx_mm + j.dx_by_y * residual.dy_mm) / determinant,
        dy_mm: (j.dy_by_x * residual.dx_mm + scale_x * residual.dy_mm) / determinant,
    }
}

pub(super) fn shifted(point: SensorPoint, by: Displacement) -> SensorPoint {
    SensorPoint::new(point.x_mm + by.dx_mm, point.y_mm + by.dy_mm)
}
