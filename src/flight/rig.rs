//! The camera on a test rig: the wires of its drive, shutter and sensors are numbers, its time is given.

use heapless::Vec;

use super::controller::state::State;
use super::event::{Action, Event};
use super::time::Time;

/// Events in one step.
pub const MAX_EVENTS: usize = 16;

/// Actions in one answer.
pub const MAX_ACTIONS: usize = 24;

/// What happens from one round of the control loop to the next.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct RigStep {
    /// When the control loop comes round.
    pub time: Time,
    /// What the encoder has counted by then.
    pub encoder_count: i32,
    /// What happened since the last round, in order of time.
    pub events: Vec<(Time, Event), MAX_EVENTS>,
}

/// What the camera does in that round.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct RigAnswer {
    /// Pulse width at the motor, -1 to 1; positive is along the FMC axis.
    pub duty: f32,
    /// Whether the motor's power stage is on.
    pub powered: bool,
    /// What else it does, in order.
    pub actions: Vec<Action, MAX_ACTIONS>,
    /// What it is doing now.
    pub state: State,
}
