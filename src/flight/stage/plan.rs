//! Limits of the mechanism, and the places of one exposure.

use super::error::{PlanError, StrokeTooShort};
use crate::geometry::range::{OutOfRange, Quantity};

/// Position of the exposure relative to the calibrated position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RunUp {
    /// The exposure centroid falls on the calibrated principal point: Δδ = -v·E\[τ\].
    #[default]
    Centred,
    /// The stage starts at the calibrated position: Δδ is the ramp, v²/(2a) for unlimited jerk,
    /// plus `v·t_settle`.
    FromRest,
}

/// Limits of the mechanism, not yet validated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MechanismLimits {
    /// A: largest acceleration, mm/s².
    pub acceleration_mm_s2: f32,
    /// J: largest change of the acceleration, mm/s³; `None` is unlimited.
    pub jerk_mm_s3: Option<f32>,
    /// Largest speed, mm/s; `None` is unlimited.
    pub max_speed_mm_s: Option<f32>,
    /// `t_settle`: time at speed between run-up and exposure, ms.
    pub settling_ms: f32,
    /// Total stroke, half of it on either side of the calibrated position, mm.
    pub stroke_mm: f32,
}

/// The mechanism, and the only planner of its motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    pub(super) acceleration_mm_s2: f32,
    pub(super) jerk_mm_s3: Option<f32>,
    pub(super) max_speed_mm_s: f32,
    pub(super) settling_s: f32,
    pub(super) stroke_mm: f32,
}

/// The exposure the stage has to track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    /// v: speed along the FMC axis, mm/s; negative where the camera flies against it.
    pub speed_mm_s: f32,
    /// t: exposure, the shutter's base, s.
    pub exposure_s: f32,
    /// E\[τ\]: centroid of the exposure after opening, s.
    pub centroid_time_s: f32,
    /// Time for which the stage stays at speed beyond the exposure, for a late shutter, s.
    pub margin_s: f32,
}

/// Positions of the principal point along the FMC axis, mm from the calibrated one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagePlan {
    /// Start of the run-up.
    pub start_mm: f32,
    /// Δδ: shutter opens.
    pub opening_mm: f32,
    /// Δδ + δ: shutter closes.
    pub closing_mm: f32,
    /// End of the deceleration.
    pub stop_mm: f32,
}

impl Stage {
    /// Validates the limits of a stage.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the quantity.
    pub fn new(limits: MechanismLimits) -> Result<Self, OutOfRange> {
        let (_, fastest) = Quantity::MaxSpeedMmS.range();
        Ok(Self {
            acceleration_mm_s2: Quantity::AccelerationMmS2.check(limits.acceleration_mm_s2)?,
            jerk_mm_s3: match limits.jerk_mm_s3 {
                Some(jerk) => Some(Quantity::JerkMmS3.check(jerk)?),
                None => None,
            },
            max_speed_mm_s: Quantity::MaxSpeedMmS
                .check(limits.max_speed_mm_s.unwrap_or(fastest))?,
            settling_s: Quantity::SettlingMs.check(limits.settling_ms)? / 1000.0,
            stroke_mm: Quantity::StrokeMm.check(limits.stroke_mm)?,
        })
    }

    /// A: largest acceleration, mm/s².
    pub(crate) const fn acceleration_mm_s2(&self) -> f32 {
        self.acceleration_mm_s2
    }

    /// Largest speed, mm/s; that of its range if it is not limited.
    pub(crate) const fn max_speed_mm_s(&self) -> f32 {
        self.max_speed_mm_s
    }

    /// Returns the travel of one exposure, from the best start of the run-up to the stop.
    ///
    /// # Model
    /// Run-up over the ramp and `v·t_settle`, tracking over `v·(t + margin)`, stop over the ramp.
    /// The ramp is v²/(2A) for unlimited jerk, with jerk J `v(v/A + A/J)/2`, and `v√(v/J)` for
    /// v < A²/J. Centred: `Δδ = -v·E[τ]`; from rest: the run-up begins at the calibrated position.
    /// Negative v mirrors everything, bit by bit.
    ///
    /// # Errors
    /// [`PlanError`] for a speed beyond the stage's and if any part would leave ± half the stroke.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::flight::stage::{MechanismLimits, RunUp, Stage, Tracking};
    /// let stage = Stage::new(MechanismLimits {
    ///     acceleration_mm_s2: 1000.0,
    ///     jerk_mm_s3: Some(100_000.0),
    ///     max_speed_mm_s: Some(50.0),
    ///     settling_ms: 5.0,
    ///     stroke_mm: 4.0,
    /// })?;
    /// let tracking = Tracking {
    ///     speed_mm_s: 20.0,
    ///     exposure_s: 0.01,
    ///     centroid_time_s: 0.005,
    ///     margin_s: 0.0,
    /// };
    /// // Δδ = 20(20/1000 + 1000/100000)/2 + 20·0.005 = 0.3 + 0.1 mm.
    /// let plan = stage.plan(RunUp::FromRest, tracking)?;
    /// assert!((plan.opening_mm - 0.4).abs() < 1e-6);
    /// // 0.2 mm of exposure, 0.3 mm to stop.
    /// assert!((plan.stop_mm - 0.9).abs() < 1e-6);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn plan(&self, run_up: RunUp, tracking: Tracking) -> Result<StagePlan, PlanError> {
        let speed = self.checked_speed(tracking.speed_mm_s)?;
        let ramp_mm = self.ramp(speed).distance_mm;
        let run_up_mm = ramp_mm + speed * self.settling_s;
        let opening_mm = match run_up {
            RunUp::Centred => -(speed * tracking.centroid_time_s),
            RunUp::FromRest => run_up_mm,
        };
        let closing_mm = opening_mm + speed * tracking.exposure_s;
        self.within_stroke(StagePlan {
            start_mm: opening_mm - run_up_mm,
            opening_mm,
            closing_mm,
            stop_mm: closing_mm + speed * tracking.margin_s + ramp_mm,
        })
    }

    /// Returns the travel of an exposure that opens at a given offset, for any run-up: only opening
    /// and closing must lie inside the stroke.
    ///
    /// # Errors
    /// [`PlanError`] if one of them does not, and for a speed beyond the stage's.
    pub fn opening_at(&self, opening_mm: f32, tracking: Tracking) -> Result<StagePlan, PlanError> {
        let speed = self.checked_speed(tracking.speed_mm_s)?;
        let closing_mm = opening_mm + speed * tracking.exposure_s;
        self.within_stroke(StagePlan {
            start_mm: opening_mm,
            opening_mm,
            closing_mm,
            stop_mm: closing_mm,
        })
    }

    /// Returns a speed that the stage can have, in either direction.
    pub(super) fn checked_speed(&self, speed_mm_s: f32) -> Result<f32, PlanError> {
        if speed_mm_s.abs() <= self.max_speed_mm_s {
            Ok(speed_mm_s)
        } else {
            Err(PlanError::Speed {
                wanted_mm_s: speed_mm_s,
                max_mm_s: self.max_speed_mm_s,
            })
        }
    }

    pub(super) fn within_stroke(&self, plan: StagePlan) -> Result<StagePlan, PlanError> {
        self.check_reach(plan.start_mm, plan.stop_mm)?;
        Ok(plan)
    }

    /// Checks that a path between two ends, in either direction, lies within the stroke.
    pub(super) fn check_reach(&self, from_mm: f32, to_mm: f32) -> Result<(), StrokeTooShort> {
        let half_stroke_mm = 0.5 * self.stroke_mm;
        if from_mm.abs() <= half_stroke_mm && to_mm.abs() <= half_stroke_mm {
            Ok(())
        } else {
            Err(StrokeTooShort {
                from_mm,
                to_mm,
                half_stroke_mm,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRACKING: Tracking = Tracking {
        speed_mm_s: 20.0,
        exposure_s: 0.01,
        centroid_time_s: 0.005,
        margin_s: 0.0,
    };

    fn stage(stroke_mm: f32) -> Stage {
        Stage::new(MechanismLimits {
            acceleration_mm_s2: 1000.0,
            jerk_mm_s3: None,
            max_speed_mm_s: None,
            settling_ms: 5.0,
            stroke_mm,
        })
        .unwrap()
    }

    #[test]
    fn from_rest_opens_after_ramp_and_settling() {
        let plan = stage(4.0).plan(RunUp::FromRest, TRACKING).unwrap();
        // 20²/2000 = 0.2 mm of ramp, 0.1 mm of settling, 0.2 mm of exposure, 0.2 mm to stop.
        let expected = [0.0, 0.3, 0.5, 0.7];
        let found = [
            plan.start_mm,
            plan.opening_mm,
            plan.closing_mm,
            plan.stop_mm,
        ];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{plan:?}");
        }
    }

    #[test]
    fn centred_puts_the_centroid_on_the_calibrated_position() {
        let plan = stage(4.0).plan(RunUp::Centred, TRACKING).unwrap();
        assert!((plan.opening_mm + 0.1).abs() < 1e-7);
        assert!((plan.opening_mm + plan.closing_mm).abs() < 1e-7);
    }

    #[test]
    fn stroke_must_hold_the_whole_travel_but_only_the_exposure_of_a_given_opening() {
        // Centred: -0.4 mm to +0.3 mm.
        assert!(stage(0.81).plan(RunUp::Centred, TRACKING).is_ok());
        let refused = stage(0.79).plan(RunUp::Centred, TRACKING);
        let Err(PlanError::Stroke(refused)) = refused else {
            panic!("{refused:?}");
        };
        assert!((refused.from_mm + 0.4).abs() < 1e-6);
        assert!(stage(0.79).opening_at(-0.1, TRACKING).is_ok());
        assert!(stage(0.79).opening_at(0.2, TRACKING).is_err());
        assert!(stage(0.79).opening_at(f32::NAN, TRACKING).is_err());
    }
}
