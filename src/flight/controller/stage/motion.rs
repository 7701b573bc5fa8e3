//! Motion that the stage has been commanded to make.

use crate::flight::stage::{Profile, Setpoint};
use crate::flight::time::Time;

/// A profile, and the time at which it began; after its end the stage stands.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) profile: Profile,
    /// `None` while the stage waits at the start of the profile.
    pub(super) began: Option<Time>,
}

impl Motion {
    /// Returns the set point.
    #[inline(never)]
    pub(super) fn setpoint(&self, now: Time) -> Setpoint {
        match self.began {
            Some(began) => self.profile.setpoint(now.seconds_since(began)),
            None => self.profile.start(),
        }
    }

    /// Returns `true` if the stage should stand at the end by now.
    pub(super) fn is_over(&self, now: Time) -> bool {
        self.began
            .is_some_and(|began| now.seconds_since(began) >= self.profile.duration_s())
    }
}
