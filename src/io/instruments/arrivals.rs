//! Events that the bytes of a round lead to.

use heapless::Vec;

use crate::flight::control_loop::MAX_EVENTS;
use crate::flight::event::Event;
use crate::flight::time::Time;

/// How much earlier than the round the time of an event may be, µs: half of what the controller takes for an event in
/// time ([`LATE_EVENT_S`](crate::flight::controller::timing::LATE_EVENT_S)), so that it may wait for a round.
pub const HEARD_WITHIN_US: u64 = 5000;

/// Events that one byte leads to at most.
const EVENTS_OF_A_BYTE: usize = 3;

/// Events with their times, and how many there may be.
#[derive(Debug)]
pub(super) struct Arrivals {
    now: Time,
    room: usize,
    pub(super) events: Vec<(Time, Event), MAX_EVENTS>,
}

impl Arrivals {
    pub(super) const fn new(now: Time, room: usize) -> Self {
        Self {
            now,
            room,
            events: Vec::new(),
        }
    }

    /// The round's time.
    pub(super) const fn now(&self) -> Time {
        self.now
    }

    /// Whether there is room for whatever a byte leads to.
    pub(super) fn has_room(&self) -> bool {
        self.events.len() + EVENTS_OF_A_BYTE <= self.room.min(MAX_EVENTS)
    }

    /// What a message says whose first byte came at a time: its age counts from there, as far as the controller lets it.
    pub(super) fn push_begun(&mut self, began: Time, event: Event) {
        let earliest = Time::from_us(self.now.us().saturating_sub(HEARD_WITHIN_US));
        self.push_at(began.max(earliest), event);
    }

    /// What arrives now.
    pub(super) fn push(&mut self, event: Event) {
        self.push_at(self.now, event);
    }

    /// In order of time; of one time, as they came. Where there was room for a byte there is for its events.
    fn push_at(&mut self, time: Time, event: Event) {
        let later = |(other, _): &(Time, Event)| *other > time;
        let place = self.events.iter().position(later);
        let _ = self
            .events
            .insert(place.unwrap_or(self.events.len()), (time, event));
    }
}
