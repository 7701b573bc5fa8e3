//! Settings of a flight: everything that the calibration does not contain.

use super::controller::timing::TICK_S;
use super::drive::settings::DriveSettings;
use super::exposure::FlightDirection;
use super::index_watch::IndexSides;
use super::input_settings::InputSettings;
use super::stage_tolerance::StageTolerance;
use super::vh::settings::VhSettings;
use crate::geometry::range::{OutOfRange, Quantity};

/// Factor of the excess of the encoder's step over [`FINE_STEP_UM`] by which a stage that follows
/// may be farther off its set point than the following tolerance: the velocity loop sees speeds in
/// steps of the encoder per round.
pub const FOLLOWING_STEPS: f32 = 5.0;

/// Coarsest step of an encoder for which the following tolerance holds as it is, µm
/// ([`LoopSettings::LEARNED`](super::drive::loop_settings::LoopSettings::LEARNED)).
pub const FINE_STEP_UM: f32 = 0.5;

/// Steps of the encoder by which a reading of a stage that follows may step beyond its set point.
pub const JUMP_STEPS: f32 = 3.0;

/// Distance by which friction moves a stage off its set point from one reading to the next, in
/// parts of the distance of a round from rest under it, `F_c/m·T²`.
///
/// Friction that turns round acts with twice its size, and more where the stage breaks away; in the
/// third round the loop has answered.
pub const FRICTION_ROUNDS: f32 = 6.0;

/// Step that stands alone between two rounds, in parts of that which begins or ends with the
/// planned acceleration, with friction that turns round, and with a step of the encoder at either
/// end, `(A + 2·F_c/m)·T² + 2·q`; 300 random missions reach 1.2 of it.
pub const ISOLATED: f32 = 1.5;

/// Part of the play that a step may stand out alone where a screw comes to push a stage with the
/// encoder on it, one that has stood or that a screw which slows down has lost: the screw has
/// gained speed in between, and loses it as it pushes.
pub const CONTACT_PART: f32 = 0.25;

/// Distance from the index mark at which a way across it begins and ends, and from the waiting
/// place at which the last way there begins, as a multiple of the following tolerance: the stage is
/// under way when it comes there.
pub const BESIDE_PLACE: f32 = 2.0;

/// Part of the following error that friction leads to by which a stage may be off its set point,
/// where it turns round: the feed-forward takes the rest.
pub const FRICTION_PART: f32 = 0.1;

/// Settings of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FlightSettings {
    /// Exposure time of the frames to come, s.
    pub exposure_s: f32,
    /// Direction of flight, along the FMC axis or against it.
    pub direction: FlightDirection,
    /// Largest smear of a frame that is not flagged, and with which the shutter may open, pixels.
    pub smear_budget_px: f32,
    /// Largest error of the stage's speed at which the shutter is told to open, per cent.
    pub speed_tolerance_percent: f32,
    /// Largest following error that is not a fault, µm.
    pub following_tolerance_um: f32,
    /// Largest difference between a step of the encoder's reading and of its set point at constant
    /// speed, µm.
    pub jump_tolerance_um: f32,
    /// Time from command to first light, s.
    pub shutter_latency_s: f32,
    /// Largest error of first light and of exposure in time, s.
    pub shutter_tolerance_s: f32,
    /// Shortest planned time between triggers, s; 0 if not known.
    pub trigger_interval_s: f32,
    /// σ of the satellite receiver's time pulse, s.
    pub time_pulse_sigma_s: f32,
    /// `true` if the encoder counts on while the supply is too low for the motor.
    pub encoder_survives_brown_out: bool,
    /// σ of pitch, roll and drift while no attitude is reported, °.
    pub attitude_sigma_deg: f32,
    /// σ of each attitude rate while no attitude is reported, °/s.
    pub rate_sigma_deg_s: f32,
    /// Sources of V/H.
    pub vh: VhSettings,
    /// Motor, encoder and velocity loop.
    pub drive: DriveSettings,
    /// Lines that lead into the board.
    pub inputs: InputSettings,
    /// `true` if a flight that a reset of the camera ends goes on by itself, without force on the
    /// stage.
    pub flies_on_after_reset: bool,
    /// `true` if the frames are corrected by the five-coefficient model that was fitted to the
    /// camera, which must have one; otherwise by the exposure mean of the calibration.
    pub fitted_model: bool,
}

impl FlightSettings {
    /// Returns the settings, if each is in its range.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field, its value and its range.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        let fields = [
            (Quantity::ExposureS, self.exposure_s),
            (Quantity::SmearBudgetPx, self.smear_budget_px),
            (
                Quantity::SpeedTolerancePercent,
                self.speed_tolerance_percent,
            ),
            (Quantity::FollowingToleranceUm, self.following_tolerance_um),
            (Quantity::JumpToleranceUm, self.jump_tolerance_um),
            (Quantity::ShutterLatencyS, self.shutter_latency_s),
            (Quantity::ShutterToleranceS, self.shutter_tolerance_s),
            (Quantity::TimePulseSigmaS, self.time_pulse_sigma_s),
            (Quantity::TriggerIntervalS, self.trigger_interval_s),
            (Quantity::AttitudeSigmaDeg, self.attitude_sigma_deg),
            (Quantity::RateSigmaDegS, self.rate_sigma_deg_s),
        ];
        for (quantity, value) in fields {
            quantity.check(value)?;
        }
        Ok(Self {
            vh: self.vh.checked()?,
            drive: self.drive.checked()?,
            inputs: self.inputs.checked()?,
            ..self
        })
    }

    /// Returns the places on both sides of the index mark between which a way crosses it with the
    /// play taken up; `None` without a mark.
    pub(super) fn index_sides(&self) -> Option<IndexSides> {
        let index_mm = self.drive.index_mm?;
        let beside_mm = self.taking_up_mm();
        Some(IndexSides {
            low_mm: index_mm - beside_mm,
            high_mm: index_mm + beside_mm,
        })
    }

    /// Returns the length of a way at the end of which the play is taken up and the stage follows,
    /// mm.
    fn taking_up_mm(&self) -> f32 {
        BESIDE_PLACE * self.following_mm() + self.drive.unseen_play_mm()
    }

    /// Returns the last way to the waiting place, mm along the FMC axis: the stage comes there in
    /// the direction in which it leaves, with the play taken up; 0 without play.
    pub(super) fn approach_mm(&self) -> f32 {
        if self.drive.play_um > 0.0 {
            libm::copysignf(self.taking_up_mm(), self.direction.sign())
        } else {
            0.0
        }
    }

    /// Largest difference between set point and reading, mm.
    fn following_mm(&self) -> f32 {
        let drive = &self.drive;
        // An encoder on the stage stands still while its screw takes up the play.
        let step_um = drive.coarseness_um();
        let coarser_um = (step_um - FINE_STEP_UM).max(0.0);
        let least_um = FOLLOWING_STEPS * step_um;
        1e-3 * (self.following_tolerance_um + FOLLOWING_STEPS * coarser_um).max(least_um)
            + drive.seen_play_mm()
            + FRICTION_PART * drive.velocity_loop.friction_error_mm()
    }

    /// Returns the tolerances of a stage with a largest planned acceleration, mm/s².
    pub(super) fn stage_tolerance(&self, acceleration_mm_s2: f32) -> StageTolerance {
        let drive = &self.drive;
        let (step_um, play_mm) = (drive.coarseness_um(), drive.seen_play_mm());
        let in_round_mm = |mm_s2: f32| mm_s2 * TICK_S * TICK_S;
        let friction_mm = in_round_mm(drive.velocity_loop.friction_mm_s2());
        let planned_mm = in_round_mm(acceleration_mm_s2) + 2e-3 * step_um;
        let isolated_mm = planned_mm + 2.0 * friction_mm;
        let jump_mm = 1e-3 * self.jump_tolerance_um.max(JUMP_STEPS * step_um);
        StageTolerance {
            following_mm: self.following_mm(),
            jump_mm,
            slip_mm: FRICTION_ROUNDS * friction_mm + play_mm,
            isolated_mm: ISOLATED * isolated_mm,
            undoubted_mm: jump_mm.max(planned_mm),
            contact_mm: CONTACT_PART * play_mm,
            play_mm,
            rest_band_mm: 1e-3 * drive.velocity_loop.rest_band_um,
            step_mm: 1e-3 * step_um,
        }
    }
}

impl Default for FlightSettings {
    /// Returns 1/300 s along the FMC axis, a quarter of a pixel of smear, a shutter that opens 2 ms
    /// after its command to within 1 ms.
    fn default() -> Self {
        Self {
            exposure_s: 1.0 / 300.0,
            direction: FlightDirection::Forward,
            smear_budget_px: 0.25,
            speed_tolerance_percent: 1.0,
            following_tolerance_um: 10.0,
            jump_tolerance_um: 1.0,
            shutter_latency_s: 0.002,
            shutter_tolerance_s: 0.001,
            trigger_interval_s: 0.0,
            time_pulse_sigma_s: 1e-6,
            encoder_survives_brown_out: true,
            attitude_sigma_deg: 0.5,
            rate_sigma_deg_s: 0.02,
            vh: VhSettings::default(),
            drive: DriveSettings::default(),
            inputs: InputSettings::default(),
            flies_on_after_reset: true,
            fitted_model: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn following_um(following_tolerance_um: f32, encoder_step_um: f32) -> f32 {
        let mut settings = FlightSettings {
            following_tolerance_um,
            ..FlightSettings::default()
        };
        settings.drive.encoder_step_um = encoder_step_um;
        let mut alone = settings;
        alone.following_tolerance_um = 0.0;
        alone.drive.encoder_step_um = 0.0;
        1e3 * (settings.following_mm() - alone.following_mm())
    }

    #[test]
    fn coarse_step_widens_the_following_tolerance_which_is_five_steps_at_least() {
        for (tolerance_um, step_um, expected_um) in [
            (10.0, 0.1, 10.0),
            (10.0, 0.5, 10.0),
            (10.0, 1.7, 16.0),
            (0.1, 0.5, 2.5),
            (1.0, 5.0, 25.0),
        ] {
            let found = following_um(tolerance_um, step_um);
            assert!((found - expected_um).abs() < 1e-3, "{found} for {step_um}");
        }
    }
}
