//! The stage's travel for one exposure: run-up, tracking, stop, at constant acceleration.

use core::fmt;

use crate::geometry::range::{OutOfRange, Quantity};

/// Where the run-up puts the exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub enum RunUp {
    /// The exposure centroid falls on the calibrated principal point: Δδ = -v·E\[τ\].
    #[default]
    Centred,
    /// The stage starts at the calibrated position: Δδ = v²/(2a) + `v·t_settle`.
    FromRest,
}

/// What the mechanism can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    acceleration_mm_s2: f32,
    settling_s: f32,
    stroke_mm: f32,
}

/// The exposure the stage has to track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    /// v: speed, mm/s.
    pub speed_mm_s: f32,
    /// t: exposure, the shutter's base, s.
    pub exposure_s: f32,
    /// E\[τ\]: centroid of the exposure after opening, s.
    pub centroid_time_s: f32,
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

/// Where the stage should be at an instant, and how it should move.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct Setpoint {
    /// Offset along the FMC axis from the calibrated position, mm.
    pub offset_mm: f32,
    /// Speed along the FMC axis, mm/s.
    pub speed_mm_s: f32,
    /// Acceleration along the FMC axis, mm/s².
    pub acceleration_mm_s2: f32,
}

/// The travel does not fit the stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct StrokeTooShort {
    /// Start of the travel that is needed, mm from the calibrated position.
    pub from_mm: f32,
    /// Its end, mm.
    pub to_mm: f32,
    /// What there is on either side, mm.
    pub half_stroke_mm: f32,
}

impl fmt::Display for StrokeTooShort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the exposure moves the principal point from {:.4} mm to {:.4} mm, the stroke allows -{:.4} mm to {:.4} mm",
            self.from_mm, self.to_mm, self.half_stroke_mm, self.half_stroke_mm
        )
    }
}

impl core::error::Error for StrokeTooShort {}

impl Stage {
    /// A stage of the given acceleration (mm/s²), settling time (ms) and total stroke (mm).
    ///
    /// # Errors
    /// [`OutOfRange`] naming the quantity.
    pub fn new(
        acceleration_mm_s2: f32,
        settling_ms: f32,
        stroke_mm: f32,
    ) -> Result<Self, OutOfRange> {
        Ok(Self {
            acceleration_mm_s2: Quantity::AccelerationMmS2.check(acceleration_mm_s2)?,
            settling_s: Quantity::SettlingMs.check(settling_ms)? / 1000.0,
            stroke_mm: Quantity::StrokeMm.check(stroke_mm)?,
        })
    }

    /// The travel of one exposure, from the start of the run-up to the stop.
    ///
    /// # Model
    /// Run-up over `v²/(2a) + v·t_settle`, tracking over `v·t`, stop over `v²/(2a)`. Centred:
    /// `Δδ = -v·E[τ]`; from rest: the run-up begins at the calibrated position.
    ///
    /// # Errors
    /// [`StrokeTooShort`] where any part of it would leave ± half the stroke.
    pub fn plan(&self, run_up: RunUp, tracking: Tracking) -> Result<StagePlan, StrokeTooShort> {
        let speed = tracking.speed_mm_s;
        let ramp_mm = speed * speed / (2.0 * self.acceleration_mm_s2);
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
            stop_mm: closing_mm + ramp_mm,
        })
    }

    /// The travel of an exposure that opens at a given offset, however the stage gets there: only
    /// opening and closing must lie inside the stroke.
    ///
    /// # Errors
    /// [`StrokeTooShort`] where one of them does not.
    pub fn opening_at(
        &self,
        opening_mm: f32,
        tracking: Tracking,
    ) -> Result<StagePlan, StrokeTooShort> {
        let closing_mm = opening_mm + tracking.speed_mm_s * tracking.exposure_s;
        self.within_stroke(StagePlan {
            start_mm: opening_mm,
            opening_mm,
            closing_mm,
            stop_mm: closing_mm,
        })
    }

    fn within_stroke(&self, plan: StagePlan) -> Result<StagePlan, StrokeTooShort> {
        let half_stroke_mm = 0.5 * self.stroke_mm;
        if plan.start_mm >= -half_stroke_mm && plan.stop_mm <= half_stroke_mm {
            Ok(plan)
        } else {
            Err(StrokeTooShort {
                from_mm: plan.start_mm,
                to_mm: plan.stop_mm,
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
    };

    fn stage(stroke_mm: f32) -> Stage {
        Stage::new(1000.0, 5.0, stroke_mm).unwrap()
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
        let refused = stage(0.79).plan(RunUp::Centred, TRACKING).unwrap_err();
        assert!((refused.from_mm + 0.4).abs() < 1e-6);
        assert!(stage(0.79).opening_at(-0.1, TRACKING).is_ok());
        assert!(stage(0.79).opening_at(0.2, TRACKING).is_err());
        assert!(stage(0.79).opening_at(f32::NAN, TRACKING).is_err());
    }
}
