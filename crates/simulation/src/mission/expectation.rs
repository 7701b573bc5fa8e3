//! Expected consequences of a fault.

use std::fmt;

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::Flag;
use fmc_camera::flight::vh::VhSource;

use crate::wording;

/// Names of the camera's states.
pub const STATE_NAMES: [&str; 8] = [
    "standby", "armed", "degraded", "run-up", "tracking", "exposing", "fly-back", "fault",
];

/// Sources of V/H, the best first.
pub const VH_WAYS: [VhSource; 3] = [VhSource::Direct, VhSource::Altimeter, VhSource::Terrain];

/// Returns the name of a source of V/H.
#[must_use]
pub const fn way_name(way: VhSource) -> &'static str {
    match way {
        VhSource::Direct => "direct",
        VhSource::Altimeter => "altimeter",
        VhSource::Terrain => "terrain",
    }
}

/// Names of the reasons for which a trigger is refused, without faults.
pub const REASON_NAMES: [&str; 10] = [
    "not armed",
    "overlap",
    "outside limits",
    "stroke",
    "speed",
    "not at speed",
    "shutter missing",
    "disarmed",
    "records full",
    "unusable",
];

/// Outcome that a scenario expects of a fault; a field that is `None` is not judged.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Expectation {
    /// The camera names this fault after the onset.
    pub fault: Option<Fault>,
    /// Longest time from when the fault could first be felt until the camera names it, ms.
    pub within_ms: Option<f64>,
    /// The camera is in this state at some time after the onset.
    pub state: Option<String>,
    /// A trigger after the onset is refused for this reason.
    pub refused: Option<String>,
    /// A frame after the onset has this flag.
    pub flag: Option<Flag>,
    /// Largest number of triggers that are refused in the whole flight.
    pub refused_at_most: Option<usize>,
    /// The last frame exposed during the fault has its V/H from this source.
    pub vh_from: Option<VhSource>,
    /// Largest smear of the frames exposed after the onset, px.
    pub smear_px: Option<f64>,
    /// Longest time from the end of the fault until the camera compensates again, s.
    pub armed_within_s: Option<f64>,
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
            Some(most) => parts.push(format!(
                "at most {} refused",
                wording::counted(most, "trigger")
            )),
            None => {}
        }
        if let Some(way) = self.vh_from {
            parts.push(format!("V/H from {} in the end", way_name(way)));
        }
        if let Some(smear_px) = self.smear_px {
            parts.push(format!("smear at most {smear_px} px"));
        }
        if let Some(within_s) = self.armed_within_s {
            parts.push(format!("armed within {within_s} s after its end"));
        }
        if parts.is_empty() {
            f.write_str("no wrong coordinate")
        } else {
            f.write_str(&parts.join("; "))
        }
    }
}
