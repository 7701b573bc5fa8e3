//! Whoever arms the camera, and clears its faults.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::Command;

use super::clock::ROUND_US;

/// When the camera is told to obey triggers.
const ARMED_AT_US: u64 = 200 * ROUND_US;

/// The operator.
#[derive(Debug, Clone, Copy)]
pub(super) struct Operator {
    clear_after_us: Option<u64>,
    failed_since_us: Option<u64>,
}

impl Operator {
    /// One who clears a fault so long after it has shown, or never.
    pub(super) const fn new(clear_after_us: Option<u64>) -> Self {
        Self {
            clear_after_us,
            failed_since_us: None,
        }
    }

    /// What the operator wants now.
    pub(super) fn commands(&mut self, now_us: u64) -> Vec<Command> {
        if now_us == ARMED_AT_US {
            return vec![Command::Arm];
        }
        if let (Some(since_us), Some(after_us)) = (self.failed_since_us, self.clear_after_us)
            && now_us >= since_us + after_us
        {
            self.failed_since_us = None;
            return vec![Command::ClearFault, Command::Arm];
        }
        Vec::new()
    }

    /// The camera has come to another state.
    pub(super) fn see(&mut self, now_us: u64, state: State) {
        let has_failed = matches!(state, State::Fault(_) | State::Degraded(_));
        self.failed_since_us = if has_failed {
            self.failed_since_us.or(Some(now_us))
        } else {
            None
        };
    }
}
