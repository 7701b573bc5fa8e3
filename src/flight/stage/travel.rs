//! Travel of a real exposure, from the stage's position at the trigger.

use super::error::PlanError;
use super::plan::{RunUp, Stage, StagePlan, Tracking};
use super::profile::Profile;
use super::setpoint::Setpoint;
use crate::geometry::range::Quantity;

/// Fraction by which the next frame's speed may exceed the present one without opening off its
/// place.
pub const RUN_UP_RESERVE: f32 = 0.1;

/// The travel of one exposure in time, from rest at the trigger to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Travel {
    /// Places of the travel.
    pub plan: StagePlan,
    /// Time at which the stage reaches its speed, s after the start.
    pub at_speed_s: f32,
    /// Time at which the shutter opens, s after the start.
    pub opening_s: f32,
    /// Time at which the shutter closes, s after the start.
    pub closing_s: f32,
    /// Time at which the stage stands again, s after the start.
    pub stop_s: f32,
    /// Offset of the opening from the planned place, mm along the FMC axis; 0 if the run-up was
    /// long enough.
    pub off_centre_mm: f32,
    /// The motion.
    pub profile: Profile,
}

impl Travel {
    /// Returns the set point at a time after the start.
    #[must_use]
    pub fn setpoint(&self, time_s: f32) -> Setpoint {
        self.profile.setpoint(time_s)
    }
}

impl Stage {
    /// Returns the travel of an exposure from the stage's present position.
    ///
    /// # Model
    /// The stage accelerates at once, stays at speed until the planned Δδ, but at least for
    /// `t_settle`, tracks, and stops. A run-up that is longer than needed settles longer. A stage
    /// that stands too near, or beyond, opens as soon as it has settled, off the planned place, as
    /// long as the stroke holds.
    ///
    /// # Units and frames
    /// `from_mm` is along the FMC axis; times are in s after the trigger.
    ///
    /// # Accuracy
    /// A run-up too short by less than 2 units in the last place of the stroke is long enough.
    ///
    /// # Errors
    /// [`PlanError`] for an exposure time out of range, a speed beyond the stage's, a travel that
    /// leaves the stroke, and for one that never reaches its place.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::flight::stage::{MechanismLimits, RunUp, Stage, Tracking};
    /// let stage = Stage::new(MechanismLimits {
    ///     acceleration_mm_s2: 1000.0,
    ///     jerk_mm_s3: None,
    ///     max_speed_mm_s: None,
    ///     settling_ms: 5.0,
    ///     stroke_mm: 4.0,
    /// })?;
    /// let tracking = Tracking {
    ///     speed_mm_s: 20.0,
    ///     exposure_s: 0.01,
    ///     centroid_time_s: 0.005,
    ///     margin_s: 0.0,
    /// };
    /// // 20 ms and 0.2 mm of ramp, 5 ms and 0.1 mm of settling: from -0.4 mm it opens at -0.1 mm
    /// // after 25 ms, from -0.5 mm 5 ms later.
    /// let travel = stage.travel(-0.5, RunUp::Centred, tracking)?;
    /// assert!((travel.plan.opening_mm + 0.1).abs() < 1e-6);
    /// assert!((travel.opening_s - 0.030).abs() < 1e-6);
    /// // From 0 mm it opens at 0.3 mm instead of -0.1 mm.
    /// let late = stage.travel(0.0, RunUp::Centred, tracking)?;
    /// assert!((late.off_centre_mm - 0.4).abs() < 1e-6 && (late.opening_s - 0.025).abs() < 1e-6);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn travel(
        &self,
        from_mm: f32,
        run_up: RunUp,
        tracking: Tracking,
    ) -> Result<Travel, PlanError> {
        let exposure_s = Quantity::ExposureS.check(tracking.exposure_s)?;
        let margin_s = tracking.margin_s.max(0.0);
        let speed = self.checked_speed(tracking.speed_mm_s)?;
        let ramp = self.ramp(speed);
        let run_up_mm = ramp.distance_mm + speed * self.settling_s;
        let planned_mm = match run_up {
            RunUp::Centred => -(speed * tracking.centroid_time_s),
            RunUp::FromRest => run_up_mm,
        };
        self.check_reach(planned_mm, planned_mm)?;
        // The rest of the way to the planned place after the shortest run-up.
        let spare_mm = planned_mm - from_mm - run_up_mm;
        let spare_s = spare_mm / speed;
        let (opening_mm, wait_s) = if spare_s > 0.0 && speed.abs() > 0.0 {
            (planned_mm, spare_s)
        } else if spare_mm.abs() <= 2.0 * f32::EPSILON * self.stroke_mm {
            (planned_mm, 0.0)
        } else {
            (from_mm + run_up_mm, 0.0)
        };
        let opening_s = ramp.duration_s + self.settling_s + wait_s;
        let closing_s = opening_s + exposure_s;
        let cruise_s = self.settling_s + wait_s + exposure_s + margin_s;
        let stop_s = ramp.duration_s + cruise_s + ramp.duration_s;
        if !stop_s.is_finite() {
            return Err(PlanError::Time {
                needed_s: stop_s,
                available_s: f32::MAX,
            });
        }
        let closing_mm = opening_mm + speed * exposure_s;
        let plan = self.within_stroke(StagePlan {
            start_mm: from_mm,
            opening_mm,
            closing_mm,
            stop_mm: closing_mm + speed * margin_s + ramp.distance_mm,
        })?;
        let mut profile = Profile::from(Setpoint {
            offset_mm: from_mm,
            ..Setpoint::default()
        });
        ramp.accelerate(&mut profile);
        profile.then(cruise_s, 0.0, 0.0);
        ramp.decelerate(&mut profile, plan.stop_mm);
        Ok(Travel {
            plan,
            at_speed_s: ramp.duration_s,
            opening_s,
            closing_s,
            stop_s,
            off_centre_mm: opening_mm - planned_mm,
            profile,
        })
    }

    /// Returns the position at which to wait for the next trigger, mm along the FMC axis: the best
    /// start of the run-up for a V/H that is larger by [`RUN_UP_RESERVE`], as far as the stroke and
    /// the stage's speed allow.
    ///
    /// # Errors
    /// As [`Self::plan`].
    pub fn waiting_place_mm(&self, run_up: RunUp, tracking: Tracking) -> Result<f32, PlanError> {
        self.plan(run_up, tracking)?;
        let most = self.max_speed_mm_s;
        let faster = (tracking.speed_mm_s * (1.0 + RUN_UP_RESERVE))
            .max(-most)
            .min(most);
        let start_mm = match run_up {
            RunUp::Centred => {
                let ramp_mm = self.ramp(faster).distance_mm;
                -(faster * tracking.centroid_time_s) - (ramp_mm + faster * self.settling_s)
            }
            RunUp::FromRest => 0.0,
        };
        let half_stroke_mm = 0.5 * self.stroke_mm;
        Ok(start_mm.max(-half_stroke_mm).min(half_stroke_mm))
    }
}
