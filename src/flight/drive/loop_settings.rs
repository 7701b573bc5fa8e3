//! Gains of the velocity loop, from the plant.

use crate::geometry::range::{OutOfRange, Quantity};

/// Load of the motor, all of it reduced to the stage.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plant {
    /// Moving mass, with the motor's and the screw's inertia, kg.
    pub mass_kg: f32,
    /// Force of full duty at rest, N.
    pub force_n: f32,
    /// Viscous friction and back-EMF together, N per m/s.
    pub damping_n_s_m: f32,
    /// Coulomb friction, N.
    pub friction_n: f32,
}

impl Plant {
    /// The stage that the gains were tuned on in simulation: 0.3 kg, 6 N, 22 N·s/m, 0.25 N.
    pub const REFERENCE: Self = Self {
        mass_kg: 0.3,
        force_n: 6.0,
        damping_n_s_m: 22.0,
        friction_n: 0.25,
    };

    /// Returns the plant, if each quantity is in its range.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        Quantity::MassKg.check(self.mass_kg)?;
        Quantity::ForceN.check(self.force_n)?;
        Quantity::DampingNSM.check(self.damping_n_s_m)?;
        Quantity::FrictionN.check(self.friction_n)?;
        Ok(self)
    }
}

/// Gains and limits of the velocity loop.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LoopSettings {
    /// Demanded speed per following error, 1/s.
    pub position_gain_per_s: f32,
    /// Duty per error of speed, 1/(mm/s).
    pub speed_gain_per_mm_s: f32,
    /// Rate at which the integral of the speed error takes over from the speed error, 1/s.
    pub integral_rate_per_s: f32,
    /// Part of a new difference of following errors in the measured error of speed, 0 to 1.
    pub slope_weight: f32,
    /// Duty per speed, 1/(mm/s): viscous friction and back-EMF.
    pub speed_feed_per_mm_s: f32,
    /// Duty per acceleration, 1/(mm/s²): the mass.
    pub acceleration_feed_per_mm_s2: f32,
    /// Duty against Coulomb friction.
    pub friction_feed: f32,
    /// Largest duty, 0 to 1.
    pub max_duty: f32,
    /// Following error that is tolerated at rest, µm: above the encoder's step.
    pub rest_band_um: f32,
    /// Rate at which the three fed-forward values are learned from what the feedback has to add,
    /// 1/s; 0 is never.
    pub learning_rate_per_s: f32,
    /// Age of a reading of the encoder when it is used, s: the time from its stamp to the round.
    pub reading_age_s: f32,
    /// Time from a duty to its force, s.
    pub duty_delay_s: f32,
}

impl LoopSettings {
    /// `ω_p`: position loop, 1/s.
    pub(crate) const POSITION_RATE_PER_S: f32 = 200.0;

    /// `ω_v`: velocity loop, 1/s.
    pub(crate) const SPEED_RATE_PER_S: f32 = 500.0;

    /// `ω_i`: integral, 1/s.
    pub(crate) const INTEGRAL_RATE_PER_S: f32 = 80.0;

    /// The gains for a plant, for latencies of 0.1 ms each.
    ///
    /// # Model
    /// With m the mass, F the force of full duty, b the damping and `F_c` the friction, the force
    /// asked for is `m·ω_v·(1 + ω_i/s)·(ω_p·e + de/dt) + m·a + b·v + F_c·sgn(v)`, in parts of F.
    /// `ω_v`, `ω_p` and `ω_i` were chosen on the simulated stage
    /// (`crates/simulation/src/mechanics`) for the least smear that still leaves a gain margin of
    /// 1.3/0.7: mass and force 30 % off. At a rate of 60/s, friction, damping and mass are learned
    /// in two strokes to and fro of 2 mm at 50 mm/s, which the camera should make at arming.
    ///
    /// # Accuracy
    /// [`Self::MARGINS`], [`Self::NOMINAL`], [`Self::COARSE`], [`Self::LEARNED`] and
    /// [`Self::UNLEARNED`], each asserted in `host-sim/tests/mechanics`: ramps of 1000 mm/s²,
    /// cruise at 5 to 25 mm/s, fly-back at up to 50 mm/s.
    #[must_use]
    pub const fn tuned(plant: Plant) -> Self {
        // N per m/s² is mN per mm/s².
        let duty_per_mm_s2 = 1e-3 * plant.mass_kg / plant.force_n;
        Self {
            position_gain_per_s: Self::POSITION_RATE_PER_S,
            speed_gain_per_mm_s: Self::SPEED_RATE_PER_S * duty_per_mm_s2,
            integral_rate_per_s: Self::INTEGRAL_RATE_PER_S,
            slope_weight: 1.0,
            speed_feed_per_mm_s: 1e-3 * plant.damping_n_s_m / plant.force_n,
            acceleration_feed_per_mm_s2: duty_per_mm_s2,
            friction_feed: plant.friction_n / plant.force_n,
            max_duty: 1.0,
            rest_band_um: 2.0,
            learning_rate_per_s: 60.0,
            reading_age_s: 1e-4,
            duty_delay_s: 1e-4,
        }
    }

    /// Returns the acceleration of a stage on which friction alone acts, mm/s²; 0 if friction or
    /// mass are not known.
    pub(crate) fn friction_mm_s2(&self) -> f32 {
        if self.acceleration_feed_per_mm_s2 > 0.0 {
            self.friction_feed / self.acceleration_feed_per_mm_s2
        } else {
            0.0
        }
    }

    /// Returns the following error under friction that nothing but the speed error answers, mm.
    ///
    /// # Model
    /// `F_c/(m·ω_p·ω_v)`, which is the duty against friction by the gains of position and speed.
    pub(crate) fn friction_error_mm(&self) -> f32 {
        let gain_per_mm = self.position_gain_per_s * self.speed_gain_per_mm_s;
        if gain_per_mm > 0.0 {
            self.friction_feed / gain_per_mm
        } else {
            0.0
        }
    }

    /// Returns the settings, if each is in its range.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        Quantity::PositionGainPerS.check(self.position_gain_per_s)?;
        Quantity::SpeedGainPerMmS.check(self.speed_gain_per_mm_s)?;
        Quantity::IntegralRatePerS.check(self.integral_rate_per_s)?;
        Quantity::SlopeWeight.check(self.slope_weight)?;
        Quantity::SpeedFeedPerMmS.check(self.speed_feed_per_mm_s)?;
        Quantity::AccelerationFeedPerMmS2.check(self.acceleration_feed_per_mm_s2)?;
        Quantity::FrictionFeed.check(self.friction_feed)?;
        Quantity::MaxDuty.check(self.max_duty)?;
        Quantity::RestBandUm.check(self.rest_band_um)?;
        Quantity::LearningRatePerS.check(self.learning_rate_per_s)?;
        Quantity::ReadingAgeS.check(self.reading_age_s)?;
        Quantity::DutyDelayS.check(self.duty_delay_s)?;
        Ok(self)
    }
}

impl Default for LoopSettings {
    fn default() -> Self {
        Self::tuned(Plant::REFERENCE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_that_no_gain_tells_is_not_added() {
        let known = LoopSettings::default();
        // 0.25 N on 0.3 kg, and the same by 200/s and 500/s.
        assert!((known.friction_mm_s2() - 833.333).abs() < 0.01);
        assert!((known.friction_error_mm() - 833.333 / 1e5).abs() < 1e-6);
        let massless = LoopSettings {
            acceleration_feed_per_mm_s2: 0.0,
            ..known
        };
        assert!(massless.friction_mm_s2().abs() <= 0.0);
        for (position_gain_per_s, speed_gain_per_mm_s) in [(0.0, 0.02), (200.0, 0.0)] {
            let open = LoopSettings {
                position_gain_per_s,
                speed_gain_per_mm_s,
                ..known
            };
            assert!(open.friction_error_mm().abs() <= 0.0);
        }
    }
}
