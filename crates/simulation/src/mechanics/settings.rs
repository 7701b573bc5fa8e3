//! Parameters of the stage's mechanics.

use fmc_camera::flight::drive::kind::DriveKind;
use serde::Deserialize;

use super::position_stage::PositionStage;

/// A stage with its motor, screw, encoder and end stops; masses and forces are reduced to the
/// moving stage.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MechanicsSettings {
    /// Moving mass, with the motor's and the screw's inertia, kg.
    pub mass_kg: f64,
    /// Force at full duty and at rest, N.
    pub force_n: f64,
    /// Back-EMF, N per m/s; acts while the bridge is on.
    pub back_emf_n_s_m: f64,
    /// Viscous friction, N per m/s.
    pub viscous_n_s_m: f64,
    /// Coulomb friction, N.
    pub coulomb_n: f64,
    /// Friction at which the stage breaks away, N.
    pub breakaway_n: f64,
    /// Stribeck speed, over which breakaway friction falls to Coulomb friction, mm/s.
    pub stribeck_mm_s: f64,
    /// Play between the screw and the stage, µm.
    pub backlash_um: f64,
    /// Part that the encoder sits on.
    pub encoder_side: EncoderSide,
    /// The stage has an index mark.
    pub has_index: bool,
    /// Place of the index mark, mm: its edge on the way along the FMC axis.
    pub index_mm: f64,
    /// Width of the mark, µm: its edge on the way against the axis is as much farther on.
    pub index_width_um: f64,
    /// Standard deviation of the place at which a crossing is seen, µm.
    pub index_noise_um: f64,
    /// Travel per count of the encoder, µm.
    pub encoder_step_um: f64,
    /// Position of the middle of count 0, µm; `None` leaves it to the seed.
    pub encoder_phase_um: Option<f64>,
    /// Excess of the true travel per count, ppm.
    pub encoder_scale_ppm: f64,
    /// Age of the encoder's reading that is known, s.
    pub encoder_latency_s: f64,
    /// Age of the encoder's reading beyond the known one, s.
    pub encoder_latency_error_s: f64,
    /// σ of the instant at which the encoder is read, s.
    pub encoder_jitter_s: f64,
    /// Time from the command of a duty to its force, s.
    pub duty_latency_s: f64,
    /// Offsets of the end stops, mm.
    pub end_stops_mm: [f64; 2],
    /// Offsets beyond which the limit switches are closed, mm.
    pub limits_mm: [f64; 2],
    /// Stepper in place of the motor; its largest force is `force_n`.
    pub stepper: Option<Stepper>,
    /// Stage that follows a position command in place of motor and screw, with an absolute sensor
    /// as the encoder.
    pub position_stage: Option<PositionStage>,
    /// Longest integration step, s.
    pub substep_s: f64,
    /// Time for which the motion is remembered, s.
    pub history_s: f64,
}

/// A stepper: its field turns by steps, and its rotor follows the field as on a spring.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stepper {
    /// Steps per millimetre of the stage, micro-steps counted.
    pub steps_per_mm: f64,
    /// Pulses of the drive's timer per second, Hz.
    pub pulse_rate_hz: f64,
    /// Most steps per second, Hz.
    pub max_step_rate_hz: f64,
    /// Force per distance of the rotor from the field, reduced to the stage, N/mm.
    pub stiffness_n_mm: f64,
    /// Damping of the rotor, N per m/s.
    pub damping_n_s_m: f64,
}

impl Default for Stepper {
    /// 1 mm of pitch, 200 steps, 16 micro-steps; 40 kHz.
    fn default() -> Self {
        Self {
            steps_per_mm: 3200.0,
            pulse_rate_hz: 40_000.0,
            max_step_rate_hz: 20_000.0,
            stiffness_n_mm: 200.0,
            damping_n_s_m: 300.0,
        }
    }
}

/// Part that the encoder sits on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EncoderSide {
    /// On the motor or its screw, where play moves the stage unseen.
    Screw,
    /// On the stage itself.
    Stage,
}

impl Default for MechanicsSettings {
    /// The stage that the library's gains are tuned for (`Plant::REFERENCE`).
    fn default() -> Self {
        Self {
            mass_kg: 0.3,
            force_n: 6.0,
            back_emf_n_s_m: 20.0,
            viscous_n_s_m: 2.0,
            coulomb_n: 0.25,
            breakaway_n: 0.32,
            stribeck_mm_s: 1.0,
            backlash_um: 1.0,
            encoder_side: EncoderSide::Screw,
            has_index: true,
            index_mm: 0.0,
            index_width_um: 50.0,
            index_noise_um: 0.01,
            encoder_step_um: 0.1,
            encoder_phase_um: None,
            encoder_scale_ppm: 0.0,
            encoder_latency_s: 1e-4,
            encoder_latency_error_s: 0.0,
            encoder_jitter_s: 0.0,
            duty_latency_s: 1e-4,
            end_stops_mm: [-2.5, 2.5],
            limits_mm: [-2.2, 2.2],
            stepper: None,
            position_stage: None,
            substep_s: 2e-5,
            history_s: 2.0,
        }
    }
}

/// Longest integration step that is allowed, s.
pub const LONGEST_SUBSTEP_S: f64 = 5e-5;

impl MechanicsSettings {
    /// Kind of the camera's drive.
    #[must_use]
    pub const fn drive_kind(&self) -> DriveKind {
        if self.position_stage.is_some() {
            DriveKind::PositionCommand
        } else if self.stepper.is_some() {
            DriveKind::Stepper
        } else {
            DriveKind::Motor
        }
    }

    /// Returns the settings if a stage can be built from them.
    ///
    /// # Errors
    /// A message that names the field, its value and what is allowed.
    pub fn checked(self) -> Result<Self, String> {
        let ranges = [
            ("mass_kg", self.mass_kg, 1e-3, 100.0),
            ("force_n", self.force_n, 1e-3, 1e4),
            ("back_emf_n_s_m", self.back_emf_n_s_m, 0.0, 1e4),
            ("viscous_n_s_m", self.viscous_n_s_m, 0.0, 1e4),
            ("coulomb_n", self.coulomb_n, 0.0, 1e3),
            ("breakaway_n", self.breakaway_n, self.coulomb_n, 1e3),
            ("stribeck_mm_s", self.stribeck_mm_s, 1e-3, 1e3),
            ("backlash_um", self.backlash_um, 0.0, 1e3),
            ("index_mm", self.index_mm, -50.0, 50.0),
            ("index_width_um", self.index_width_um, 0.0, 1e4),
            ("index_noise_um", self.index_noise_um, 0.0, 100.0),
            ("encoder_step_um", self.encoder_step_um, 1e-3, 100.0),
            (
                "encoder_phase_um",
                self.encoder_phase_um.unwrap_or(0.0),
                -100.0,
                100.0,
            ),
            ("encoder_scale_ppm", self.encoder_scale_ppm, -1e4, 1e4),
            ("encoder_latency_s", self.encoder_latency_s, 0.0, 0.01),
            (
                "encoder_latency_error_s",
                self.encoder_latency_error_s,
                -self.encoder_latency_s,
                0.01,
            ),
            ("encoder_jitter_s", self.encoder_jitter_s, 0.0, 1e-3),
            ("duty_latency_s", self.duty_latency_s, 0.0, 0.01),
            ("end_stops_mm[0]", self.end_stops_mm[0], -100.0, 0.0),
            ("end_stops_mm[1]", self.end_stops_mm[1], 0.0, 100.0),
            ("limits_mm[0]", self.limits_mm[0], -100.0, 0.0),
            ("limits_mm[1]", self.limits_mm[1], 0.0, 100.0),
            ("substep_s", self.substep_s, 1e-7, LONGEST_SUBSTEP_S),
            ("history_s", self.history_s, 0.02, 60.0),
        ];
        let of_stepper = self.stepper.map(|stepper| {
            [
                ("stepper.steps_per_mm", stepper.steps_per_mm, 1.0, 1e6),
                ("stepper.pulse_rate_hz", stepper.pulse_rate_hz, 1000.0, 1e6),
                (
                    "stepper.max_step_rate_hz",
                    stepper.max_step_rate_hz,
                    1.0,
                    0.5 * stepper.pulse_rate_hz,
                ),
                (
                    "stepper.stiffness_n_mm",
                    stepper.stiffness_n_mm,
                    1.0,
                    1000.0,
                ),
                ("stepper.damping_n_s_m", stepper.damping_n_s_m, 0.0, 2000.0),
            ]
        });
        if self.stepper.is_some() && self.position_stage.is_some() {
            return Err("stepper and position_stage exclude each other".to_owned());
        }
        let of_stepper = of_stepper.into_iter().flatten();
        let of_stage = self.position_stage.iter().flat_map(PositionStage::ranges);
        let all = ranges.into_iter().chain(of_stepper).chain(of_stage);
        for (name, value, least, most) in all {
            if !(value >= least && value <= most) {
                return Err(format!("{name} = {value} is outside {least} to {most}"));
            }
        }
        Ok(self)
    }
}
