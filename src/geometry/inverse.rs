//! From the ideal point to the measured one.

use core::fmt;

use super::evaluation_form::Displacement;
use super::frame_correction::{Corrected, FrameCorrection, Terms};
use super::newton_step::newton_step;
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
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// [`LEFT_BY_ONE_STEP_NM`], by a bound of the frame's curvature (Newton and Kantorovich), and it must
    /// end on the sensor; on lenses of up to a per cent of distortion it is the first.
    ///
    /// Where there is none, again from `d = D(ideal)` with every place kept on the sensor, at most [`MAX_STEPS`]
    /// steps, the last from a residual of at most [`LAST_RESIDUAL_NM`].
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
    /// and within 0.02 nm where all this is less (`tests/geometry/round_trip.rs`). The displacement is
    /// within 0.11 nm of that in double precision on the published cameras (`tests/geometry/inverse.rs`).
    /// Instructions on Cortex-M4F and M7 where the first step is the last: 115 with the short kernel and 128 with the
    /// full one (`docs/instructions.csv`); where every place has to be kept on the sensor, some hundred more.
    ///
    /// # Errors
    /// [`DistortError`]; never a finite point that does not belong to `ideal`. A lens of tens of
    /// per cent of distortion may hold Newton's method at an edge or cycling: then an error, though
    /// there is a measured point.
    #[inline]
    pub fn distort(&self, ideal: SensorPoint) -> Result<Corrected, DistortError> {
        let first = match self.terms() {
            Terms::Short => self.first_step::<false>(ideal),
            Terms::Full => self.first_step::<true>(ideal),
        };
        match first {
            Ok(measured) => Ok(measured),
            Err(distortion) => self.further_steps(ideal, distortion),
        }
    }

    /// [`Self::distort`] by one free step, or where that leads if it is not the last or leaves the sensor.
    #[expect(
        clippy::inline_always,
        reason = "a call per point would load the coefficients again: 21 instructions"
    )]
    #[inline(always)]
    fn first_step<const FULL: bool>(&self, ideal: SensorPoint) -> Result<Corrected, Displacement> {
        let (x, y) = self.centred(ideal);
        let start = self.form().start::<FULL>(x, y);
        let (distortion, step2_mm2) = self.form().stepped::<FULL>(x, y, start);
        self.ended(ideal, distortion, step2_mm2).ok_or(distortion)
    }

    /// [`Self::distort`] from where the first free step has led.
    #[cold]
    #[inline(never)]
    fn further_steps(
        &self,
        ideal: SensorPoint,
        mut distortion: Displacement,
    ) -> Result<Corrected, DistortError> {
        let (x, y) = self.centred(ideal);
        for _ in 1..FREE_STEPS {
            let step2_mm2;
            (distortion, step2_mm2) = match self.terms() {
                Terms::Short => self.form().stepped::<false>(x, y, distortion),
                Terms::Full => self.form().stepped::<true>(x, y, distortion),
            };
            if let Some(measured) = self.ended(ideal, distortion, step2_mm2) {
                return Ok(measured);
            }
        }
        self.kept_on_sensor(ideal)
    }

    /// Where a free step has led, if it may be the last and ends on the sensor.
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

    /// [`Self::distort`] where free steps find nothing: at the edge, beyond it, and with a strong lens. It decides
    /// which error it is.
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
    /// That of [`Self::distort`]. Instructions to a point on Cortex-M4F and M7 where the first step is the last: 94
    /// with the short kernel and 105 with the full one.
    ///
    /// # Errors
    /// [`DistortSliceError`] for the first point that no measured one belongs to. Those before it have been replaced;
    /// it and those behind it are as they were.
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
        let mut rest = points;
        let mut index = 0;
        loop {
            let not_found = match self.terms() {
                Terms::Short => self.first_steps::<false>(rest),
                Terms::Full => self.first_steps::<true>(rest),
            };
            let Some((found, distortion)) = not_found else {
                return Ok(());
            };
            index += found;
            let left = rest.get_mut(found..).and_then(<[_]>::split_first_mut);
            let Some((point, behind)) = left else {
                return Ok(());
            };
            let measured = self.further_steps(*point, distortion);
            *point = measured
                .map_err(|error| DistortSliceError { index, error })?
                .point;
            index += 1;
            rest = behind;
        }
    }

    /// Replaces points as long as the first step is the last: at which index it is not, and where it leads. A loop that
    /// calls nothing keeps the coefficients in registers.
    #[inline(never)]
    fn first_steps<const FULL: bool>(
        &self,
        points: &mut [SensorPoint],
    ) -> Option<(usize, Displacement)> {
        for (index, point) in points.iter_mut().enumerate() {
            match self.first_step::<FULL>(*point) {
                Ok(measured) => *point = measured.point,
                Err(distortion) => return Some((index, distortion)),
            }
        }
        None
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

    /// Two units in the last place at 40 mm, over the scale.
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
            match (correction.distort(ideal), correction.kept_on_sensor(ideal)) {
                (Ok(free), Ok(kept)) => prop_assert!(is_same(free.point, kept.point, 0.1)),
                // Held at the edge or cycling, as documented: then what the free steps found must be right.
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
