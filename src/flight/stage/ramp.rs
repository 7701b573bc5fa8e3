//! Acceleration from rest to a speed, and back to rest.

use super::plan::Stage;
use super::profile::Profile;
use super::setpoint::Setpoint;

/// A change of speed between rest and a speed, with limited acceleration and jerk.
///
/// # Model
/// With acceleration A and jerk J the acceleration is a trapezoid for |v| ≥ A²/J: duration
/// |v|/A + A/J, distance half of it times v; else a triangle of height √(J|v|): duration 2√(|v|/J),
/// distance v√(|v|/J). Without limit of the jerk: |v|/A and v²/(2A).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ramp {
    speed_mm_s: f32,
    /// Largest acceleration, with the sign of the speed.
    peak_mm_s2: f32,
    /// Jerk, with the sign of the speed; 0 where it is unlimited.
    jerk_mm_s3: f32,
    /// Time for which the acceleration rises, and falls.
    rise_s: f32,
    /// Time for which it stays at its largest.
    hold_s: f32,
    /// Duration of the ramp.
    pub(super) duration_s: f32,
    /// Distance, with the sign of the speed.
    pub(super) distance_mm: f32,
}

impl Ramp {
    /// Appends the acceleration from rest.
    pub(super) fn accelerate(&self, profile: &mut Profile) {
        profile.then(self.rise_s, 0.0, self.jerk_mm_s3);
        profile.then(self.hold_s, self.peak_mm_s2, 0.0);
        profile.then(self.rise_s, self.peak_mm_s2, -self.jerk_mm_s3);
        profile.settle_at_speed(self.speed_mm_s);
    }

    /// Appends the deceleration to rest at a place.
    pub(super) fn decelerate(&self, profile: &mut Profile, to_mm: f32) {
        profile.then(self.rise_s, 0.0, -self.jerk_mm_s3);
        profile.then(self.hold_s, -self.peak_mm_s2, 0.0);
        profile.then(self.rise_s, -self.peak_mm_s2, self.jerk_mm_s3);
        profile.stand_at(to_mm);
    }
}

impl Stage {
    /// Returns the ramp to a speed.
    pub(super) fn ramp(&self, speed_mm_s: f32) -> Ramp {
        let most = self.acceleration_mm_s2;
        let magnitude = speed_mm_s.abs();
        let Some(jerk) = self.jerk_mm_s3 else {
            let duration_s = magnitude / most;
            return Ramp {
                speed_mm_s,
                peak_mm_s2: most.copysign(speed_mm_s),
                jerk_mm_s3: 0.0,
                rise_s: 0.0,
                hold_s: duration_s,
                duration_s,
                distance_mm: speed_mm_s * magnitude / (2.0 * most),
            };
        };
        let full_rise_s = most / jerk;
        let (rise_s, peak, hold_s) = if magnitude >= most * full_rise_s {
            (full_rise_s, most, (magnitude / most - full_rise_s).max(0.0))
        } else {
            let rise_s = fmc_camera_kernel::sqrt(magnitude / jerk);
            (rise_s, jerk * rise_s, 0.0)
        };
        let duration_s = 2.0 * rise_s + hold_s;
        Ramp {
            speed_mm_s,
            peak_mm_s2: peak.copysign(speed_mm_s),
            jerk_mm_s3: jerk.copysign(speed_mm_s),
            rise_s,
            hold_s,
            duration_s,
            distance_mm: 0.5 * speed_mm_s * duration_s,
        }
    }

    /// Returns the quickest stop, from any speed and acceleration.
    ///
    /// # Model
    /// If the acceleration a₀ went back to 0 at once, the speed would be v₁ = v₀ + a₀|a₀|/(2J). The
    /// acceleration goes to -p against v₁, stays there if p is the stage's largest, and goes back
    /// to 0, with `p² = J(v₀ + a₀²/(2J))` for positive v₁. Without limit of the jerk: |v₀|/A.
    ///
    /// # Units and frames
    /// Positions are along the FMC axis; times are in s after the beginning of the stop. The stroke
    /// is not checked, as no motion stops sooner. A state that is not finite gives a profile that
    /// stands.
    #[must_use]
    pub fn stop(&self, from: Setpoint) -> Profile {
        let mut profile = Profile::from(from);
        if !from.is_finite() {
            profile.stand_at(from.offset_mm);
            return profile;
        }
        let most = self.acceleration_mm_s2;
        let (speed, acceleration) = (from.speed_mm_s, from.acceleration_mm_s2);
        if let Some(jerk) = self.jerk_mm_s3 {
            let remaining = speed + acceleration * acceleration.abs() / (2.0 * jerk);
            // The motion is mirrored, so that the remaining speed is positive.
            let along = 1.0_f32.copysign(remaining);
            let (speed, acceleration) = (along * speed, along * acceleration);
            let square = jerk * speed + 0.5 * acceleration * acceleration;
            let peak = fmc_camera_kernel::sqrt(square.max(0.0)).min(most);
            let turn_s = (acceleration + peak).abs() / jerk;
            let turning = jerk.copysign(-along * (acceleration + peak));
            let turned = speed + 0.5 * (acceleration - peak) * turn_s;
            let rise_s = peak / jerk;
            let hold_s = (turned - 0.5 * peak * rise_s) / most;
            profile.then(turn_s, from.acceleration_mm_s2, turning);
            if peak >= most {
                profile.then(hold_s, -along * peak, 0.0);
            }
            profile.then(rise_s, -along * peak, along * jerk);
        } else {
            profile.then(speed.abs() / most, most.copysign(-speed), 0.0);
        }
        profile.stand_at(profile.end().offset_mm);
        profile
    }
}
