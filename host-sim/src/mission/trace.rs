//! What happened round by round, of the last seconds and of one frame.

use std::collections::VecDeque;

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::stage::Setpoint;

/// Rounds that are remembered.
const REMEMBERED: usize = 3000;

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

/// The last rounds.
#[derive(Debug, Clone, Default)]
pub(super) struct Recorder {
    rounds: VecDeque<Round>,
}

impl Recorder {
    pub(super) fn push(&mut self, round: Round) {
        if self.rounds.len() == REMEMBERED {
            self.rounds.pop_front();
        }
        self.rounds.push_back(round);
    }

    /// The rounds from a time on, µs.
    pub(super) fn since(&self, time_us: u64) -> Vec<Round> {
        let first = self.rounds.partition_point(|round| round.time_us < time_us);
        self.rounds.range(first..).copied().collect()
    }
}
