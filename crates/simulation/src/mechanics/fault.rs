//! What can break in the mechanics, when, and for how long.

use serde::Deserialize;

/// What breaks.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind", deny_unknown_fields)]
pub enum MechanicalFault {
    /// The stage jams: so much more friction, N.
    Stall {
        /// Friction of the jam, N; more than the motor's force holds the stage.
        force_n: f64,
    },
    /// The encoder is off by so many counts.
    EncoderGlitch {
        /// How many.
        counts: i32,
    },
    /// The motor turns the other way.
    MotorReversed,
    /// The encoder counts the other way.
    EncoderReversed,
    /// The bridge drives at a duty of its own, whatever it is told.
    Runaway {
        /// Which, -1 to 1.
        duty: f64,
    },
    /// The bridge is dead.
    BridgeOff,
    /// A limit switch is closed wherever the stage is.
    LimitStuck,
}

/// A fault with its time.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Injection {
    /// What breaks.
    pub fault: MechanicalFault,
    /// When, s since the start of the mechanics.
    pub from_s: f64,
    /// When it is whole again, s; infinity for never.
    #[serde(default = "never")]
    pub until_s: f64,
}

const fn never() -> f64 {
    f64::INFINITY
}

impl Injection {
    /// A fault that begins at a time and stays.
    #[must_use]
    pub const fn from(fault: MechanicalFault, from_s: f64) -> Self {
        Self {
            fault,
            from_s,
            until_s: f64::INFINITY,
        }
    }

    pub(super) fn is_active(&self, time_s: f64) -> bool {
        self.from_s <= time_s && time_s < self.until_s
    }
}
