//! Trace of the rounds around one frame.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::stage::Setpoint;

/// One round of the control loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// Time, µs.
    pub time_us: u64,
    /// Set point of the stage; `None` without one.
    pub setpoint: Option<Setpoint>,
    /// True position of the stage, mm.
    pub true_mm: f64,
    /// Position according to the encoder, mm.
    pub encoder_mm: f64,
    /// Duty of the motor; 0 without power.
    pub duty: f64,
    /// V/H according to the first source, 1/s.
    pub told_vh_per_s: f64,
    /// `true` if light passes.
    pub is_open: bool,
    /// State of the camera.
    pub state: State,
}

/// The rounds around one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Number of the frame's trigger.
    pub sequence: u32,
    /// Time of the frame's trigger, µs.
    pub trigger_us: u64,
    /// Rounds from shortly before the trigger until shortly after the record.
    pub rounds: Vec<Round>,
    /// True V/H over the ground below at each round, 1/s.
    pub true_vh_per_s: Vec<f64>,
}
