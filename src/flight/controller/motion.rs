//! What the stage has been told.

use crate::flight::stage::{Profile, Setpoint};
use crate::flight::time::Time;

/// A profile that began at a time; after its end, to stand.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) profile: Profile,
    pub(super) since: Time,
}

impl Motion {
    /// Where the stage should be.
    pub(super) fn setpoint(&self, now: Time) -> Setpoint {
        self.profile.setpoint(now.seconds_since(self.since))
    }

    /// Whether it should stand by now.
    pub(super) fn is_over(&self, now: Time) -> bool {
        now.seconds_since(self.since) >= self.profile.duration_s()
    }
}
