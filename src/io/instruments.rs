//! Instruments of the aircraft on two wires: a satellite receiver (NMEA 0183) and an autopilot (`MAVLink`).
//!
//! Bytes go in as they come, and a round of the control loop takes the events that they lead to: samples of V/H, times
//! and attitudes. Whatever comes on one wire, a round reads [`BYTES_PER_ROUND`] of its bytes and no more, so that a flood
//! costs as much as the line's own rate does; bytes beyond [`WAITING_BYTES`] are dropped and counted. Neither wire
//! changes what the other says, but for this: while the receiver gives ground speed, altitude or time, the autopilot's
//! own speed counts as that of its inertial unit, and its altitude and time are left out.
//!
//! One talker is listened to on the receiver's wire, and one system on the autopilot's: the first that speaks, until it
//! has been silent for [`ALIVE_US`]. Everything that is not used is counted ([`InstrumentCounters`]).

mod arrivals;
mod autopilot;
pub mod counters;
mod intake;
mod receiver;

use self::arrivals::Arrivals;
use self::autopilot::AutopilotWire;
use self::counters::{InstrumentCounters, count};
use self::receiver::ReceiverWire;
use crate::flight::control_loop::{Events, MAX_EVENTS};
use crate::flight::rig::RigStep;
use crate::flight::time::Time;

pub use self::arrivals::HEARD_WITHIN_US;
pub use self::intake::{BYTES_PER_ROUND, WAITING_BYTES};
pub use self::receiver::ALIVE_US;

/// A wire of the aircraft.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Wire {
    /// The satellite receiver's.
    Receiver,
    /// The autopilot's.
    Autopilot,
}

impl Wire {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Receiver, Self::Autopilot];
}

/// Bytes that have come on each wire since the camera was prepared, modulo 2³².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WireBytes {
    /// On the receiver's.
    pub receiver: u32,
    /// On the autopilot's.
    pub autopilot: u32,
}

/// Both wires with their decoders.
#[derive(Debug, Clone, Default)]
pub struct Instruments {
    receiver: ReceiverWire,
    autopilot: AutopilotWire,
    received: WireBytes,
}

impl Instruments {
    /// Silent wires; the first autopilot that speaks is listened to.
    #[must_use]
    pub const fn new() -> Self {
        Self::listening_to(None)
    }

    /// Silent wires; the autopilot of this system number alone is listened to.
    #[must_use]
    pub const fn of_system(system: u8) -> Self {
        Self::listening_to(Some(system))
    }

    const fn listening_to(system: Option<u8>) -> Self {
        Self {
            receiver: ReceiverWire::new(),
            autopilot: AutopilotWire::new(system),
            received: WireBytes {
                receiver: 0,
                autopilot: 0,
            },
        }
    }

    /// Forgets what has come.
    pub fn clear(&mut self) {
        *self = Self::listening_to(self.autopilot.wanted());
    }

    /// Takes a byte of a wire; where there is no room it is dropped and counted.
    pub fn push(&mut self, wire: Wire, byte: u8) {
        let (intake, bytes, flooded, received) = match wire {
            Wire::Receiver => (
                &mut self.receiver.intake,
                &mut self.receiver.counters.bytes,
                &mut self.receiver.counters.flooded_bytes,
                &mut self.received.receiver,
            ),
            Wire::Autopilot => (
                &mut self.autopilot.intake,
                &mut self.autopilot.counters.bytes,
                &mut self.autopilot.counters.flooded_bytes,
                &mut self.received.autopilot,
            ),
        };
        *received = received.wrapping_add(1);
        count(bytes, 1);
        if !intake.keep(byte) {
            count(flooded, 1);
        }
    }

    /// Bytes of a wire were lost before they could be taken.
    pub const fn count_lost(&mut self, wire: Wire, bytes: u32) {
        let (come, lost) = match wire {
            Wire::Receiver => (
                &mut self.receiver.counters.bytes,
                &mut self.receiver.counters.lost_bytes,
            ),
            Wire::Autopilot => (
                &mut self.autopilot.counters.bytes,
                &mut self.autopilot.counters.lost_bytes,
            ),
        };
        count(come, bytes);
        count(lost, bytes);
    }

    /// Bytes that have been taken of each wire, those without room included.
    #[must_use]
    pub const fn received(&self) -> WireBytes {
        self.received
    }

    /// A round begins: what the bytes that have come say, in order of time, as far as there is room for so many events.
    /// The others wait. A byte has come at the time of the round that reads it; samples and attitudes have the time at
    /// which the first byte of their message came, up to [`HEARD_WITHIN_US`] before the round, times that of the last.
    ///
    /// # Accuracy
    /// Of [`BYTES_PER_ROUND`] bytes of each wire: `instruments_round_worst` of `docs/instructions.csv` is what the
    /// dearest of them cost.
    pub fn round(&mut self, now: Time, room: usize) -> Events {
        let mut arrivals = Arrivals::new(now, room);
        self.receiver.round(&mut arrivals);
        self.autopilot.round(&self.receiver, &mut arrivals);
        arrivals.events
    }

    /// The round of a test rig whose receiver and autopilot speak on wires: the step's own events, and those of the
    /// bytes.
    #[must_use]
    pub fn wired(&mut self, step: &RigStep) -> RigStep {
        let room = MAX_EVENTS.saturating_sub(step.events.len());
        let mut wired = step.clone();
        for (time, event) in self.round(step.time, room) {
            let later = wired.events.iter().position(|(other, _)| *other > time);
            let place = later.unwrap_or(wired.events.len());
            // There is room.
            let _ = wired.events.insert(place, (time, event));
        }
        wired
    }

    /// What has come, and what of it was not used.
    #[must_use]
    pub const fn counters(&self) -> InstrumentCounters {
        InstrumentCounters {
            receiver: self.receiver.counters,
            autopilot: self.autopilot.counters,
        }
    }
}
