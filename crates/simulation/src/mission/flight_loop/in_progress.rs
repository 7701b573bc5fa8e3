//! A flight in progress, which can be given faults and flown on by itself.

use super::{Flight, Told};
use crate::mission::device::FlyingDevice;
use crate::mission::fault::stage::mechanical;
use crate::mission::fault::trigger::with_overlaps;
use crate::mission::fault::{InjectedFault, Injection};
use crate::mission::flown::Flown;

impl<D: FlyingDevice> Flight<D> {
    /// Time of the last round, µs on the camera's clock.
    #[must_use]
    pub const fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Readings and events of the last round.
    #[must_use]
    pub const fn told(&self) -> &Told {
        &self.told
    }

    /// Adds a fault that is still to come.
    pub fn inject(&mut self, injection: Injection) {
        for fault in mechanical(&[injection]) {
            self.mechanics.inject(fault);
        }
        self.line.inject(&injection);
        self.sensors.inject(injection);
        self.shutter.inject(injection);
        self.injections.push(injection);
        self.flown.felt_us.push(None);
        if injection.fault == InjectedFault::TriggerOverlap {
            let clock = &self.clock;
            let all = with_overlaps(&self.regular_us, &self.injections).into_iter();
            self.flown.triggers_us = all.map(|time_us| clock.stamp_us(time_us)).collect();
        }
    }

    /// Leaves out the triggers after a time, µs on the camera's clock.
    pub fn end_triggers(&mut self, after_us: u64) {
        self.flown
            .triggers_us
            .retain(|trigger_us| *trigger_us <= after_us);
        self.last_trigger_us = self.flown.triggers_us.last().copied().unwrap_or(0);
    }

    /// Flies on until the record of the last trigger should be there: so long after it as the first
    /// of the times says, µs, and at most as long as the second if a record is missing. `told` is
    /// called after every round with what the camera was told.
    ///
    /// # Errors
    /// An error if the connection to the camera fails.
    pub fn to_end(
        mut self,
        after_us: [u64; 2],
        mut told: impl FnMut(u64, &Told),
    ) -> Result<Flown, D::Error> {
        loop {
            let answer = self.advance()?;
            told(self.now_us, &self.told);
            if self.is_over(self.now_us, answer.state, after_us) {
                return self.into_flown(String::new());
            }
        }
    }
}
