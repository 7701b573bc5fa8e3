//! Inverse of the correction: from the ideal point to the measured one.

use core::fmt;

use fmc_camera_kernel::Coefficients;
use fmc_camera_kernel::inverse::{self, LastStep};

use super::evaluation_form::Displacement;
use super::exposure_distortion::ExposureDistortion;
use super::frame_correction::{Corrected, FrameCorrection, Terms};
use super::newton_step::{displacement, newton_step};
use super::sensor::SensorPoint;

/// Largest number of Newton steps that may leave the sensor; a lens of up to a per cent of
/// distortion needs one step.
pub const FREE_STEPS: u8 = 3;

/// Largest number of Newton steps that are kept on the sensor.
pub const MAX_STEPS: u8 = 12;

/// The step taken on the sensor from a residual of at most this length, nm, is the last one:
/// Newton's steps shrink quadratically, and the next would be far below rounding.
pub const LAST_RESIDUAL_NM: f32 = 20.0;

/// No measured point belongs to the ideal one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DistortError {
    /// The measured point lies off the sensor, at the place given, as far as Newton's method leads.
    OffSensor(SensorPoint),
    /// The residual did not become small in [`MAX_STEPS`] steps.
    NotConverged {
        /// Length of the residual, nm; a NaN for an ideal point that is not finite.
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
    /// Index of the point in the slice, from 0.
    pub index: usize,
    /// Error of this point.
    pub error: DistortError,
}

impl fmt::Display for DistortSliceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "point {}: {}", self.index, self.error)
    }
}

impl core::error::Error for DistortSliceError {}

impl FrameCorrection {
    /// Returns the measured point of an ideal one: the inverse of [`Self::correct`].
    ///
    /// # Model
    /// Newton's method on the displacement d: `d - D(ideal + d) = 0`. Iterating the displacement,
    /// not the coordinate, keeps its finer resolution until the one addition at the end. The
    /// calibration has been shown to be one-to-one over the sensor, so that there is only one
    /// solution on the sensor.
    ///
    /// The first attempt starts from the radial terms, `d = D(ideal)·(1 + s + s²)` with the slope s
    /// of the radial distortion, and takes up to [`FREE_STEPS`] steps. The last step is one that is
    /// so short that it leaves no more than [`LEFT_BY_ONE_STEP_NM`], by a bound of the frame's
    /// curvature (Newton and Kantorovich), and it must end on the sensor; on lenses of up to a per
    /// cent of distortion it is the first.
    ///
    /// If this fails, the second attempt starts from `d = D(ideal)`, keeps every iterate on the
    /// sensor and takes at most [`MAX_STEPS`] steps, the last from a residual of at most
    /// [`LAST_RESIDUAL_NM`].
    ///
    /// [`LEFT_BY_ONE_STEP_NM`]: super::newton_step::LEFT_BY_ONE_STEP_NM
    ///
    /// # Units and frames
    /// Sensor frame, mm. The ideal point may lie off the sensor; the measured one must lie on it,
    /// edges included.
    ///
    /// # Accuracy
    /// `distort(correct(p))` is within two units in the last place of p, or of its ideal point
    /// where that is larger, divided by the scale `∂(ideal)/∂(measured)` where that is below 0.7,
    /// and within 0.02 nm where all this is less (`tests/geometry/round_trip.rs`). The displacement
    /// agrees within 0.11 nm with the one in double precision on the published cameras
    /// (`tests/geometry/inverse.rs`). Instructions on Cortex-M4F and M7 if the first step is the
    /// last: 116 with the short kernel and 128 with the full one (`docs/instructions.csv`); if
    /// every iterate has to be kept on the sensor, some hundred more.
    ///
    /// # Errors
    /// [`DistortError`]; the result is never a finite point that does not belong to `ideal`. On a
    /// lens of tens of per cent of distortion Newton's method may stop at an edge or cycle and end
    /// in an error although there is a measured point.
    #[inline]
    pub fn distort(&self, ideal: SensorPoint) -> Result<Corrected, DistortError> {
        let first = match self.terms() {
            Terms::Short => self.first_step::<false>(ideal),
            Terms::Full => self.first_step::<true>(ideal),
        };
        match first {
            Ok(measured) => Ok(measured),
            Err(distortion) => self.steps(ideal, Some(distortion)),
        }
    }

    /// Takes the first free step of [`Self::distort`], and returns where it leads as an error if it
    /// is not the last or leaves the sensor.
    #[expect(
        clippy::inline_always,
        reason = "a call per point would load the coefficients again: 23 instructions"
    )]
    #[inline(always)]
    fn first_step<const FULL: bool>(&self, ideal: SensorPoint) -> Result<Corrected, Displacement> {
        let step = self
            .coefficients()
            .first_step::<FULL>([ideal.x_mm, ideal.y_mm]);
        let distortion = displacement(step.distortion);
        let [x_mm, y_mm] = step.measured;
        let point = SensorPoint::new(x_mm, y_mm);
        let found = self.last_step().ends(step.step2_mm2, step.measured);
        found
            .then_some(Corrected { point, distortion })
            .ok_or(distortion)
    }

    /// Takes all steps of [`Self::distort`], or those behind the first, from its result.
    #[cold]
    #[inline(never)]
    fn steps(
        &self,
        ideal: SensorPoint,
        first: Option<Displacement>,
    ) -> Result<Corrected, DistortError> {
        let (x, y) = self.centred(ideal);
        let begun = u8::from(first.is_some());
        let mut distortion = first.unwrap_or_else(|| self.form().start(self.terms(), x, y));
        for _ in begun..FREE_STEPS {
            let step2_mm2;
            (distortion, step2_mm2) = self.form().stepped(self.terms(), x, y, distortion);
            if let Some(measured) = self.ended(ideal, distortion, step2_mm2) {
                return Ok(measured);
            }
        }
        kept_on_sensor(self, ideal)
    }

    /// Returns the result of a free step if it may be the last and ends on the sensor.
    #[inline]
    fn ended(
        &self,
        ideal: SensorPoint,
        distortion: Displacement,
        step2_mm2: f32,
    ) -> Option<Corrected> {
        let point = shifted(ideal, distortion);
        let found = step2_mm2 <= self.longest_last_step2() && self.contains(point);
        found.then_some(Corrected { point, distortion })
    }

    #[inline]
    fn centred(&self, ideal: SensorPoint) -> (f32, f32) {
        let centre = self.centre();
        (ideal.x_mm - centre.x_mm, ideal.y_mm - centre.y_mm)
    }

    /// Replaces every ideal point of a slice by its measured point.
    ///
    /// # Model
    /// [`Self::distort`], bit for bit, on every machine. No point depends on another.
    ///
    /// # Units and frames
    /// Sensor frame, mm; the domain is that of [`Self::distort`].
    ///
    /// # Accuracy
    /// That of [`Self::distort`]. Instructions per point on Cortex-M4F and M7 if the first step is
    /// the last: 93 with the short kernel and 102 with the full one. The vectors of a Cortex-M55
    /// halve them; they take numbers below 2⁻¹²⁶ for zero.
    ///
    /// # Errors
    /// [`DistortSliceError`] for the first point that has no measured one. The points before it
    /// have been replaced; it and those behind it are unchanged.
    ///
    /// # Examples
    /// ```
    /// # use fmc_camera::{Brown, Calibration, CalibrationParameters, FrameCorrection, SensorPoint};
    /// let mut parameters = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
    /// parameters.distortion = Brown { k1: 1e-6, ..Brown::NONE };
    /// let correction = FrameCorrection::without_motion(&Calibration::new(parameters)?);
    /// // K1·r² = 1e-6 * 500 of each measured coordinate; half the side is 40.32 mm.
    /// let mut points = [SensorPoint::new(9.995, 19.99), SensorPoint::new(0.0, 50.0)];
    /// let refused = correction.distort_slice(&mut points).unwrap_err();
    /// assert_eq!((points[0], refused.index), (SensorPoint::new(10.0, 20.0), 1));
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn distort_slice(&self, points: &mut [SensorPoint]) -> Result<(), DistortSliceError> {
        let (form, last_step) = (self.coefficients(), self.last_step());
        let mut rest = points;
        let mut index = 0;
        while !rest.is_empty() {
            let pairs = bytemuck::must_cast_slice_mut(rest);
            // Blocks side by side where the first step ends all of their points.
            let replaced = match self.terms() {
                Terms::Short => inverse::blocks::<false>(&form, &last_step, pairs),
                Terms::Full => inverse::blocks::<true>(&form, &last_step, pairs),
            };
            let behind = rest.get_mut(replaced..).unwrap_or_default();
            let length = inverse::block_length(behind.len());
            let (block, behind) = behind.split_at_mut_checked(length).unwrap_or_default();
            index += replaced;
            self.distort_one_by_one((&form, &last_step), block, index)?;
            index += length;
            rest = behind;
        }
        Ok(())
    }

    /// Replaces points, of which the first has this index in the slice.
    fn distort_one_by_one(
        &self,
        (form, last_step): (&Coefficients, &LastStep),
        points: &mut [SensorPoint],
        mut index: usize,
    ) -> Result<(), DistortSliceError> {
        let mut rest = points;
        loop {
            let pairs = bytemuck::must_cast_slice_mut(rest);
            let replaced = match self.terms() {
                Terms::Short => inverse::pairs::<false>(form, last_step, pairs),
                Terms::Full => inverse::pairs::<true>(form, last_step, pairs),
            };
            index += replaced;
            let left = rest.get_mut(replaced..).and_then(<[_]>::split_first_mut);
            let Some((point, behind)) = left else {
                return Ok(());
            };
            let measured = self.steps(*point, None);
            *point = measured
                .map_err(|error| DistortSliceError { index, error })?
                .point;
            index += 1;
            rest = behind;
        }
    }
}

/// Second attempt of [`FrameCorrection::distort`], for ideal points at the edge or beyond it and
/// for strong lenses. It decides between the two errors.
pub(super) fn kept_on_sensor<D: ExposureDistortion>(
    exposure: &D,
    ideal: SensorPoint,
) -> Result<Corrected, DistortError> {
    let polynomial = exposure.polynomial();
    // Every iterate stays on the sensor, where the map is one-to-one; beyond it the polynomial
    // may have other roots.
    let start = evaluated(exposure, polynomial.clamped(ideal));
    let mut d = on_sensor(polynomial, ideal, start);
    let last_nm = exposure.last_residual_nm(LAST_RESIDUAL_NM);
    let mut residual_nm = f32::NAN;
    for _ in 0..MAX_STEPS {
        let measured = shifted(ideal, d);
        let distortion = evaluated(exposure, measured);
        let residual = Displacement {
            dx_mm: d.dx_mm - distortion.dx_mm,
            dy_mm: d.dy_mm - distortion.dy_mm,
        };
        let step = newton_step(polynomial.jacobian(measured), residual);
        let next = Displacement {
            dx_mm: d.dx_mm - step.dx_mm,
            dy_mm: d.dy_mm - step.dy_mm,
        };
        residual_nm = 1e6 * (residual.dx_mm.abs() + residual.dy_mm.abs());
        if !(next.dx_mm + next.dy_mm).is_finite() {
            break;
        }
        let point = shifted(ideal, next);
        if residual_nm <= last_nm {
            return if polynomial.contains(point) {
                Ok(Corrected {
                    point,
                    distortion: next,
                })
            } else {
                Err(DistortError::OffSensor(point))
            };
        }
        let kept = on_sensor(polynomial, ideal, next);
        // Between the steps of a grid's weights the place along the edge may move on for ever.
        let change_mm = (kept.dx_mm - d.dx_mm).abs() + (kept.dy_mm - d.dy_mm).abs();
        let crawls = 1e6 * change_mm <= last_nm && !polynomial.contains(point);
        let stopped = kept == d || (crawls && !exposure.is_polynomial());
        if stopped {
            // The edge stops the iteration: the measured point lies beyond it.
            return Err(DistortError::OffSensor(point));
        }
        d = kept;
    }
    Err(DistortError::NotConverged { residual_nm })
}

/// Returns the distortion at a measured point, by a call: the steps are seldom taken.
#[inline(never)]
fn evaluated<D: ExposureDistortion>(exposure: &D, measured: SensorPoint) -> Displacement {
    exposure.distortion(measured)
}

/// Returns the displacement, shortened if it would leave the sensor.
#[inline(never)]
fn on_sensor(polynomial: &FrameCorrection, ideal: SensorPoint, d: Displacement) -> Displacement {
    let point = shifted(ideal, d);
    let clamped = polynomial.clamped(point);
    let cut = |d: f32, point: f32, clamped: f32| {
        let beyond = point - clamped;
        if beyond.abs() > 0.0 { d - beyond } else { d }
    };
    Displacement {
        dx_mm: cut(d.dx_mm, point.x_mm, clamped.x_mm),
        dy_mm: cut(d.dy_mm, point.y_mm, clamped.y_mm),
    }
}

pub(super) fn shifted(point: SensorPoint, by: Displacement) -> SensorPoint {
    SensorPoint::new(point.x_mm + by.dx_mm, point.y_mm + by.dy_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::brown::Brown;
    use crate::geometry::calibration::{Calibration, CalibrationParameters};
    use proptest::prelude::*;

    fn correction(distortion: Brown) -> Option<FrameCorrection> {
        let mut parameters = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
        parameters.distortion = distortion;
        let calibration = Calibration::new(parameters).ok()?;
        Some(FrameCorrection::without_motion(&calibration))
    }

    /// Returns true if two points agree within two units in the last place at 40 mm, over the
    /// scale.
    fn is_same(a: SensorPoint, b: SensorPoint, scale: f32) -> bool {
        let near = |a: f32, b: f32| (a - b).abs() <= 7.7e-6 / scale;
        near(a.x_mm, b.x_mm) && near(a.y_mm, b.y_mm)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]

        #[test]
        fn free_steps_lead_to_the_point_that_steps_on_the_sensor_find(
            k1 in -9e-5_f32..9e-5,
            k2 in -3e-8_f32..3e-8,
            p in [-2e-5_f32..2e-5, -2e-5_f32..2e-5],
            b in [-1e-3_f32..1e-3, -1e-3_f32..1e-3],
            share in 0.0_f32..1.0,
            x in -60.0_f32..60.0,
            y in -45.0_f32..45.0,
        ) {
            let lens = Brown { k1: share * k1, k2: share * k2, p1: p[0], p2: p[1], b1: b[0], b2: b[1], ..Brown::NONE };
            let correction = correction(lens);
            prop_assume!(correction.is_some());
            let correction = correction.unwrap();
            let ideal = SensorPoint::new(x, y);
            match (correction.distort(ideal), kept_on_sensor(&correction, ideal)) {
                (Ok(free), Ok(kept)) => prop_assert!(is_same(free.point, kept.point, 0.1)),
                // The second attempt stopped at the edge or cycled, as documented: then the result
                // of the free steps must be right.
                (Ok(free), Err(_)) => {
                    prop_assert!(is_same(correction.correct(free.point).point, ideal, 1.0));
                }
                (Err(free), Err(kept)) => prop_assert_eq!(free, kept),
                (Err(error), Ok(_)) => prop_assert!(false, "{error}"),
            }
        }
    }

    #[test]
    fn first_step_is_the_last_over_a_lens_of_one_per_cent() {
        let lens = Brown {
            k1: -1.6056e-5,
            k2: 6.18966e-9,
            k3: -1.31329e-12,
            p1: 2e-6,
            p2: -4.5e-6,
            ..Brown::NONE
        };
        let mut parameters = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
        parameters.distortion = lens;
        let calibration = Calibration::new(parameters).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        let mut largest = 0.0_f32;
        for row in -20_i8..=20 {
            for column in -26_i8..=26 {
                let measured = SensorPoint::new(f32::from(column), f32::from(row));
                let answer = correction.correct(measured);
                let first = correction.first_step::<false>(answer.point);
                assert!(first.is_ok(), "{measured:?}");
                largest = largest.max(answer.distortion.dx_mm.abs());
            }
        }
        assert!(largest > 0.3, "no distortion was tried: {largest} mm");
    }
}
