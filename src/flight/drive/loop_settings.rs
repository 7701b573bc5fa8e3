//! Gains of the velocity loop, from the plant they are for.

use super::settings::{SettingOutOfRange, within};

/// What the motor has to move, all of it reduced to the stage.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
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

    /// The plant, if it is one.
    ///
    /// # Errors
    /// [`SettingOutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, SettingOutOfRange> {
        within("mass_kg", self.mass_kg, 1e-3, 100.0)?;
        within("force_n", self.force_n, 1e-3, 1e4)?;
        within("damping_n_s_m", self.damping_n_s_m, 0.0, 1e4)?;
        within("friction_n", self.friction_n, 0.0, 1e3)?;
        Ok(self)
    }
}

/// Gains and limits of the velocity loop.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct LoopSettings {
    /// Speed asked for per following error, 1/s.
    pub position_gain_per_s: f32,
    /// Duty per error of speed, 1/(mm/s).
    pub speed_gain_per_mm_s: f32,
    /// How fast the integral of the speed error takes over from the speed error, 1/s.
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
    /// Following error that is left alone at rest, µm: above the encoder's step.
    pub rest_band_um: f32,
    /// How fast the three that are fed forward are learned from what the feedback has to add, 1/s; 0 is never.
    pub learning_rate_per_s: f32,
    /// Age of a reading of the encoder when it is used, s.
    pub reading_age_s: f32,
    /// Time from a duty to its force, s.
    pub duty_delay_s: f32,
}

/// What a stage keeps to with the gains of [`LoopSettings::tuned`], µm: largest of the true following error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowingBounds {
    /// In cruise, 5 ms after the run-up.
    pub cruise_um: f32,
    /// Its change within 10 ms of that: what smears.
    pub smear_um: f32,
    /// In run-ups, stops, and the first 5 ms of cruise.
    pub ramp_um: f32,
    /// In fly-backs, and 20 ms after any stop.
    pub fly_back_um: f32,
    /// At rest, from then on.
    pub rest_um: f32,
    /// At any time, as the camera sees it: set point less reading.
    pub seen_um: f32,
}

/// Margins of the open loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopMargins {
    /// Where its gain is 1, Hz.
    pub crossover_hz: f32,
    /// Phase above -180° there, °.
    pub phase_deg: f32,
    /// So many times the gain makes it oscillate; less of it never does.
    pub gain: f32,
}

impl LoopSettings {
    /// Margins with latencies of 0.1 ms each, on the plant that the gains are for.
    pub const MARGINS: LoopMargins = LoopMargins {
        crossover_hz: 86.4,
        phase_deg: 33.8,
        gain: 2.54,
    };

    /// The stage of [`Plant::REFERENCE`].
    pub const NOMINAL: FollowingBounds = FollowingBounds {
        cruise_um: 0.16,
        smear_um: 0.15,
        ramp_um: 1.3,
        fly_back_um: 1.8,
        rest_um: 1.3,
        seen_um: 1.5,
    };

    /// The same with an encoder of 0.5 µm instead of 0.1 µm.
    pub const COARSE: FollowingBounds = FollowingBounds {
        cruise_um: 0.5,
        smear_um: 0.7,
        ramp_um: 1.5,
        fly_back_um: 1.9,
        rest_um: 1.7,
        seen_um: 1.9,
    };

    /// Mass, friction and force each 30 % more or less than in the settings, encoders of 0.1 µm and 0.5 µm, latencies of
    /// 0.1 ms and 0.2 ms each; after two strokes to and fro, in which the loop learns.
    pub const LEARNED: FollowingBounds = FollowingBounds {
        cruise_um: 0.9,
        smear_um: 0.92,
        ramp_um: 2.2,
        fly_back_um: 3.5,
        rest_um: 2.2,
        seen_um: 3.0,
    };

    /// The same in the first motion ever.
    pub const UNLEARNED: FollowingBounds = FollowingBounds {
        cruise_um: 7.0,
        smear_um: 4.0,
        ramp_um: 9.0,
        fly_back_um: 14.0,
        rest_um: 6.5,
        seen_um: 12.5,
    };

    /// Following error that no healthy motion shows once the loop has learned, and every stage that jams or turns round does
    /// within 5 ms, at 5 mm/s and more, at its start and in cruise, µm.
    ///
    /// Seen by the camera at the latest so long after a jam, or after motor or encoder is turned round, µm:
    ///
    /// | fault | at | 2 ms | 3 ms | 4 ms | 5 ms | 6 ms |
    /// |---|---|---|---|---|---|---|
    /// | jam | 5 mm/s | 4.8 | 9.8 | 14.8 | 19.8 | 24.8 |
    /// | jam | 17 mm/s | 16.2 | 33.2 | 50.2 | 67.2 | 84.2 |
    /// | jam | start | 1.5 | 3.9 | 7.3 | 11.7 | 16.7 |
    /// | motor | 5 mm/s | 1.1 | 4.7 | 10.7 | 19.9 | 34.5 |
    /// | motor | 17 mm/s | 2.1 | 8.4 | 20.3 | 40.4 | 72.1 |
    /// | motor | start | 1.7 | 5.5 | 12.9 | 25.9 | 47.6 |
    /// | encoder | 5 mm/s | 9.9 | 21.8 | 40.2 | 68.7 | 111.6 |
    /// | encoder | 17 mm/s | 34.0 | 73.6 | 129.7 | 201.6 | 288.1 |
    /// | encoder | start | 2.8 | 7.9 | 17.3 | 33.5 | 61.0 |
    ///
    /// In the first motion ever, with settings 30 % off, 12.2 µm are healthy ([`Self::UNLEARNED`]): until the loop has learned,
    /// [`Self::FOLLOWING_LIMIT_UNLEARNED_UM`] holds.
    pub const FOLLOWING_LIMIT_UM: f32 = 10.0;

    /// The same for the first two strokes; a jam at 5 mm/s then takes 5 ms in cruise, and 6 ms at the start, to show.
    pub const FOLLOWING_LIMIT_UNLEARNED_UM: f32 = 15.0;

    /// ω_p: position loop, 1/s.
    pub const POSITION_RATE_PER_S: f32 = 200.0;

    /// ω_v: velocity loop, 1/s.
    pub const SPEED_RATE_PER_S: f32 = 500.0;

    /// ω_i: integral, 1/s.
    pub const INTEGRAL_RATE_PER_S: f32 = 80.0;

    /// The gains for a plant.
    ///
    /// # Model
    /// With m the mass, F the force of full duty, b the damping and F_c the friction, the force asked for is
    /// `m·ω_v·((1 + ω_i/s)·(ω_p·e + de/dt)) + m·a + b·v + F_c·sgn(v)`, in parts of F.
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

    /// The settings, if each is in its range.
    ///
    /// # Errors
    /// [`SettingOutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, SettingOutOfRange> {
        within("position_gain_per_s", self.position_gain_per_s, 0.0, 1e4)?;
        within("speed_gain_per_mm_s", self.speed_gain_per_mm_s, 0.0, 1e3)?;
        within("integral_rate_per_s", self.integral_rate_per_s, 0.0, 1e4)?;
        within("slope_weight", self.slope_weight, 0.01, 1.0)?;
        within("speed_feed_per_mm_s", self.speed_feed_per_mm_s, 0.0, 10.0)?;
        within(
            "acceleration_feed_per_mm_s2",
            self.acceleration_feed_per_mm_s2,
            0.0,
            1.0,
        )?;
        within("friction_feed", self.friction_feed, 0.0, 1.0)?;
        within("max_duty", self.max_duty, 0.01, 1.0)?;
        within("rest_band_um", self.rest_band_um, 0.0, 1000.0)?;
        within("learning_rate_per_s", self.learning_rate_per_s, 0.0, 100.0)?;
        within("reading_age_s", self.reading_age_s, 0.0, 0.01)?;
        within("duty_delay_s", self.duty_delay_s, 0.0, 0.01)?;
        Ok(self)
    }
}

impl Default for LoopSettings {
    fn default() -> Self {
        Self::tuned(Plant::REFERENCE)
    }
}
