//! What a fault is expected to lead to.

use std::fmt;

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::Flag;

/// Names of the camera's states.
pub const STATE_NAMES: [&str; 8] = [
    "standby", "armed", "degraded", "run-up", "tracking", "exposing", "fly-back", "fault",
];

/// Names of the reasons for which a trigger is refused, faults apart.
pub const REASON_NAMES: [&str; 9] = [
    "not armed",
    "overlap",
    "outside limits",
    "stroke",
    "speed",
    "not at speed",
    "shutter missing",
    "disarmed",
    "records full",
];

/// The outcome that a scenario expects of a fault; what is not named may be or not.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Expectation {
    /// The camera names this fault after the onset.
    pub fault: Option<Fault>,
    /// So soon after the fault could first be felt, ms.
    pub within_ms: Option<f64>,
    /// The camera is in this state at some time after the onset.
    pub state: Option<String>,
    /// A trigger after the onset is refused for this reason.
    pub refused: Option<String>,
    /// A frame after the onset has this flag.
    pub flag: Option<Flag>,
    /// No more triggers than these are refused in the whole flight.
    pub refused_at_most: Option<usize>,
}

impl fmt::Display for Expectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        if let Some(fault) = self.fault {
            parts.push(match self.within_ms {
                Some(within_ms) => format!("{fault} within {within_ms} ms"),
                None => fault.to_string(),
            });
        }
        if let Some(state) = &self.state {
            parts.push(format!("state {state}"));
        }
        if let Some(reason) = &self.refused {
            parts.push(format!("a trigger refused: {reason}"));
        }
        if let Some(flag) = self.flag {
            parts.push(format!("flag {}", flag.name()));
        }
        match self.refused_at_most {
            Some(0) => parts.push("no trigger refused".to_owned()),
            Some(most) => parts.push(format!("at most {most} triggers refused")),
            None => {}
        }
        if parts.is_empty() {
            f.write_str("no wrong coordinate")
        } else {
            f.write_str(&parts.join("; "))
        }
    }
}
