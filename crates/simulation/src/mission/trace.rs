//! What happened round by round around one frame.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::stage::Setpoint;

/// One round of the control loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// When, µs.
    pub time_us: u64,
    /// Where the stage should be; `None` where it has been told nothing.
    pub setpoint: Option<Setpoint>,
    /// Where it is, mm.
    pub true_mm: f64,
    /// Where its encoder says it is, mm.
    pub encoder_mm: f64,
    /// Pulse width of the motor; 0 without power.
    pub duty: f64,
    /// V/H as the first source has it, 1/s.
    pub told_vh_per_s: f64,
    /// Whether light passes.
    pub is_open: bool,
    /// What the camera is doing.
    pub state: State,
}

/// The rounds around one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Number of the frame's trigger.
    pub sequence: u32,
    /// Its trigger, µs.
    pub trigger_us: u64,
    /// From shortly before the trigger to its record and a little longer.
    pub rounds: Vec<Round>,
    /// True V/H over the ground below at each round, 1/s.
    pub true_vh_per_s: Vec<f64>,
}
