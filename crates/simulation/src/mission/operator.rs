//! Operator, who arms the camera and clears its faults.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::Command;

use super::clock::ROUND_US;

/// Time at which the camera is armed.
const ARMED_AT_US: u64 = 200 * ROUND_US;

/// The operator.
#[derive(Debug, Clone, Copy)]
pub(super) struct Operator {
    clear_after_us: Option<u64>,
    failed_since_us: Option<u64>,
}

impl Operator {
    /// Creates an operator who clears a fault a time after it has shown, or never.
    pub(super) const fn new(clear_after_us: Option<u64>) -> Self {
        Self {
            clear_after_us,
            failed_since_us: None,
        }
    }

    /// Returns the commands of the operator at a time.
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

    /// Notes the state that the camera has entered.
    pub(super) fn see(&mut self, now_us: u64, state: State) {
        let has_failed = matches!(state, State::Fault(_) | State::Degraded(_));
        self.failed_since_us = if has_failed {
            self.failed_since_us.or(Some(now_us))
        } else {
            None
        };
    }
}
