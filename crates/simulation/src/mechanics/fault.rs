//! Faults of the mechanics, with their times.

use serde::Deserialize;

/// Kind of a mechanical fault.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind", deny_unknown_fields)]
pub enum MechanicalFault {
    /// The stage jams: the friction rises by a force.
    Stall {
        /// Additional friction, N; one larger than the motor's force holds the stage.
        force_n: f64,
    },
    /// The encoder's count is off.
    EncoderGlitch {
        /// Number of counts by which it is off.
        counts: i32,
    },
    /// The encoder loses counts for good: evenly over the duration of the fault, or all at its
    /// begin if it has no end.
    CountsLost {
        /// Sum of the counts, µm; negative counts are added.
        um: f64,
    },
    /// The index mark is not seen.
    IndexMissing,
    /// The motor turns against the commanded direction.
    MotorReversed,
    /// The encoder counts the other way.
    EncoderReversed,
    /// The bridge drives at a fixed duty, whatever it is commanded.
    Runaway {
        /// The duty, -1 to 1.
        duty: f64,
    },
    /// The bridge does not drive.
    BridgeOff,
    /// A limit switch is closed wherever the stage is.
    LimitStuck,
    /// The encoder gives more or fewer counts per travel.
    EncoderScale {
        /// Excess of the counts, %.
        percent: f64,
    },
    /// The play grows for good: evenly over the duration of the fault, or all at its begin if it
    /// has no end.
    PlayGrows {
        /// Growth, µm.
        um: f64,
    },
}

/// A fault with its time.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Injection {
    /// The fault.
    pub fault: MechanicalFault,
    /// Begin of the fault, s since the start of the mechanics.
    pub from_s: f64,
    /// End of the fault, s; infinity for a fault that stays.
    #[serde(default = "never")]
    pub until_s: f64,
}

const fn never() -> f64 {
    f64::INFINITY
}

impl Injection {
    /// Creates a fault that begins at a time and stays.
    #[must_use]
    pub const fn from(fault: MechanicalFault, from_s: f64) -> Self {
        Self {
            fault,
            from_s,
            until_s: f64::INFINITY,
        }
    }

    /// Returns the part of the fault's duration that is over at a time, 0 to 1.
    pub(super) fn part(&self, time_s: f64) -> f64 {
        if time_s < self.from_s {
            0.0
        } else if self.until_s.is_finite() && time_s < self.until_s {
            (time_s - self.from_s) / (self.until_s - self.from_s)
        } else {
            1.0
        }
    }

    pub(super) fn is_active(&self, time_s: f64) -> bool {
        self.from_s <= time_s && time_s < self.until_s
    }
}
