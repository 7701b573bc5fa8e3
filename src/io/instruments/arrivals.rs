//! Events of a round's bytes.

use crate::flight::control_loop::{Events, MAX_EVENTS};
use crate::flight::event::Event;
use crate::flight::time::Time;

/// Longest time by which an event may be earlier than its round, µs: half of the controller's limit
/// ([`LATE_EVENT_S`](crate::flight::controller::timing::LATE_EVENT_S)), so that it may wait for a
/// round.
pub const HEARD_WITHIN_US: u64 = 5000;

/// Events of one byte at most.
const EVENTS_OF_A_BYTE: usize = 3;

/// Events with their times, and how many there may be.
#[derive(Debug)]
pub(super) struct Arrivals {
    now: Time,
    room: usize,
    pub(super) events: Events,
}

impl Arrivals {
    pub(super) const fn new(now: Time, room: usize) -> Self {
        Self {
            now,
            room,
            events: Events::new(),
        }
    }

    /// The round's time.
    pub(super) const fn now(&self) -> Time {
        self.now
    }

    /// Returns true if there is room for the events of any byte.
    pub(super) fn has_room(&self) -> bool {
        self.events.len() + EVENTS_OF_A_BYTE <= self.room.min(MAX_EVENTS)
    }

    /// Adds an event of a message whose first byte came at a time. Its age counts from there, as
    /// far as the controller's limit allows.
    pub(super) fn push_begun(&mut self, began: Time, event: Event) {
        let earliest = Time::from_us(self.now.us().saturating_sub(HEARD_WITHIN_US));
        self.push_at(began.max(earliest), event);
    }

    /// Adds an event of this round's time.
    pub(super) fn push(&mut self, event: Event) {
        self.push_at(self.now, event);
    }

    /// If there was room for a byte, there is room for its events.
    fn push_at(&mut self, time: Time, event: Event) {
        insert(&mut self.events, time, event);
    }
}

/// Inserts an event in order of time, behind those of the same time; without room, discards it.
pub(super) fn insert(events: &mut Events, time: Time, event: Event) {
    let mut carried = (time, event);
    let mut is_in_place = false;
    for place in &mut *events {
        is_in_place |= place.0 > time;
        if is_in_place {
            core::mem::swap(place, &mut carried);
        }
    }
    let _ = events.push(carried);
}
