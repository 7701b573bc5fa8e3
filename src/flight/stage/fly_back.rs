//! The way back: from any state of the stage to its waiting place.

use super::error::{PlanError, StrokeTooShort};
use super::plan::Stage;
use super::profile::Profile;
use super::setpoint::Setpoint;
use super::travel::Travel;

impl Stage {
    /// Returns the quickest motion to rest at another place; a stage that moves stops first.
    ///
    /// # Model
    /// Two ramps of speed v and, if v is the stage's largest speed, a stretch at it between them.
    /// Without stretch the distance D is two ramps: `v = √(AD)` for unlimited jerk, with jerk J
    /// `v = ∛(D²J/4)` up to D = 2A³/J², beyond it `v = (√((A/J)² + 4D/A) - A/J)·A/2`.
    ///
    /// # Units and frames
    /// Positions are along the FMC axis; times are in s after the beginning.
    ///
    /// # Errors
    /// [`PlanError`] for an end outside the stroke, for a stop that leaves it (farther than the
    /// stage already is), and for a state that is not finite.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::flight::stage::{MechanismLimits, Setpoint, Stage};
    /// let stage = Stage::new(MechanismLimits {
    ///     acceleration_mm_s2: 1000.0,
    ///     jerk_mm_s3: None,
    ///     max_speed_mm_s: Some(20.0),
    ///     settling_ms: 5.0,
    ///     stroke_mm: 4.0,
    /// })?;
    /// // Two ramps of 20 ms and 0.2 mm, 30 ms at 20 mm/s.
    /// let back = stage.reposition(Setpoint { offset_mm: 0.5, ..Setpoint::default() }, -0.5)?;
    /// assert!((back.duration_s() - 0.07).abs() < 1e-6);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn reposition(&self, from: Setpoint, to_mm: f32) -> Result<Profile, PlanError> {
        let half_stroke_mm = 0.5 * self.stroke_mm;
        let mut profile = self.stop(from);
        let (least, most) = profile.reach_mm();
        // A stage outside the stroke may come back.
        let bound_mm = half_stroke_mm.max(from.offset_mm.abs());
        let stopped_mm = profile.end().offset_mm;
        if !(from.is_finite() && stopped_mm.is_finite() && least >= -bound_mm && most <= bound_mm) {
            return Err(PlanError::Stroke(StrokeTooShort {
                from_mm: least,
                to_mm: most,
                half_stroke_mm,
            }));
        }
        self.check_reach(to_mm, to_mm)?;
        let distance_mm = to_mm - stopped_mm;
        let ramp = self.ramp(self.fastest(distance_mm.abs()).copysign(distance_mm));
        let rest_mm = distance_mm - 2.0 * ramp.distance_mm;
        ramp.accelerate(&mut profile);
        profile.then(rest_mm / profile.end().speed_mm_s, 0.0, 0.0);
        ramp.decelerate(&mut profile, to_mm);
        Ok(profile)
    }

    /// Returns the largest speed on a way from rest to rest, mm/s.
    fn fastest(&self, distance_mm: f32) -> f32 {
        let acceleration = self.acceleration_mm_s2;
        let speed = match self.jerk_mm_s3 {
            None => fmc_camera_kernel::sqrt(acceleration * distance_mm),
            Some(jerk) => {
                let rise_s = acceleration / jerk;
                if distance_mm <= 2.0 * acceleration * rise_s * rise_s {
                    libm::cbrtf(0.25 * jerk * distance_mm * distance_mm)
                } else {
                    let root_s =
                        fmc_camera_kernel::sqrt(rise_s * rise_s + 4.0 * distance_mm / acceleration);
                    0.5 * acceleration * (root_s - rise_s)
                }
            }
        };
        speed.min(self.max_speed_mm_s)
    }

    /// Returns the time from the trigger until the stage stands at its waiting place again, s.
    ///
    /// # Errors
    /// As [`Self::reposition`].
    pub fn cycle_s(&self, travel: &Travel, waiting_place_mm: f32) -> Result<f32, PlanError> {
        let back = self.reposition(travel.profile.end(), waiting_place_mm)?;
        Ok(travel.stop_s + back.duration_s())
    }
}
