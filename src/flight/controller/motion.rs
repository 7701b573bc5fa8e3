//! What the stage has been told.

use crate::flight::stage::{Profile, Setpoint};
use crate::flight::time::Time;

/// What the stage has been told.
#[derive(Debug, Clone)]
pub(super) enum Motion {
    /// Nothing: there is no force on it.
    Released,
    /// To follow a profile that began at a time; after its end, to stand.
    Profile { profile: Profile, since: Time },
}

impl Motion {
    /// Where the stage should be; `None` where it has been told nothing.
    pub(super) fn setpoint(&self, now: Time) -> Option<Setpoint> {
        match self {
            Self::Released => None,
            Self::Profile { profile, since } => Some(profile.setpoint(now.seconds_since(*since))),
        }
    }

    /// Whether it should stand by now.
    pub(super) fn is_over(&self, now: Time) -> bool {
        match self {
            Self::Released => true,
            Self::Profile { profile, since } => now.seconds_since(*since) >= profile.duration_s(),
        }
    }
}
