//! The motion that the stage has been told.

use crate::flight::stage::{Profile, Setpoint};
use crate::flight::time::Time;

/// A profile, and when it began; after its end, to stand.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) profile: Profile,
    /// `None`: it waits at its start.
    pub(super) began: Option<Time>,
}

impl Motion {
    /// Where the stage should be.
    #[inline(never)]
    pub(super) fn setpoint(&self, now: Time) -> Setpoint {
        match self.began {
            Some(began) => self.profile.setpoint(now.seconds_since(began)),
            None => self.profile.start(),
        }
    }

    /// Whether it should stand by now, at the end.
    pub(super) fn is_over(&self, now: Time) -> bool {
        self.began
            .is_some_and(|began| now.seconds_since(began) >= self.profile.duration_s())
    }
}
