//! Instruments of the aircraft on two wires: a satellite receiver (NMEA 0183) and an autopilot
//! (`MAVLink`).
//!
//! [`Instruments`] takes bytes as they come; a round of the control loop takes the events that they
//! make: samples of V/H, times and attitudes. A round reads at most [`BYTES_PER_ROUND`] bytes of
//! each wire, so that a flood costs no more than the line at its own rate; bytes beyond
//! [`WAITING_BYTES`] are dropped and counted. The wires affect each other in one way only: while
//! the receiver gives ground speed, altitude or time, the autopilot's speed counts as that of its
//! inertial unit, and its time is ignored, or its altitude with the height of the terrain that goes
//! with it.
//!
//! On the receiver's wire one receiver is used, and on the autopilot's one system: the first that
//! speaks, until it has been silent for [`ALIVE_US`]. Another talker is the same receiver if it has
//! the same position and time. Of a system one component is used: its autopilot (component 1), or
//! without it the first that speaks. Everything that is not used is counted
//! ([`InstrumentCounters`]).

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
    /// Both wires.
    pub const ALL: [Self; 2] = [Self::Receiver, Self::Autopilot];
}

/// Numbers of bytes on each wire since the camera was prepared, modulo 2³².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WireBytes {
    /// On the receiver's.
    pub receiver: u32,
    /// On the autopilot's.
    pub autopilot: u32,
}

/// The two wires with their decoders.
#[derive(Debug, Clone, Default)]
pub struct Instruments {
    receiver: ReceiverWire,
    autopilot: AutopilotWire,
    received: WireBytes,
    crowded_out: u32,
}

impl Instruments {
    /// Returns silent wires, which use the first autopilot that speaks.
    #[must_use]
    pub const fn new() -> Self {
        Self::listening_to(None)
    }

    /// Returns silent wires, which use no autopilot but that of this system number.
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
            crowded_out: 0,
        }
    }

    /// Discards everything that has come.
    #[inline(never)]
    pub fn clear(&mut self) {
        *self = Self::listening_to(self.autopilot.wanted());
    }

    /// Takes a byte of a wire. Without room for it, drops and counts it.
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

    /// Counts bytes of a wire that were lost before they could be taken.
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

    /// Counts an event that found no place among those that wait for the control loop.
    pub const fn count_crowded_out(&mut self) {
        count(&mut self.crowded_out, 1);
    }

    /// Returns the number of bytes taken of each wire, those without room included.
    #[must_use]
    pub const fn received(&self) -> WireBytes {
        self.received
    }

    /// Returns the events of a round, in order of time: those of the bytes that have come, as far
    /// as there is room for so many events. Other bytes wait for the next round.
    ///
    /// A byte counts as come at the time of the round that reads it. A sample or an attitude has
    /// the time of the first byte of its message, at most [`HEARD_WITHIN_US`] before the round, and
    /// a time that of the last byte.
    ///
    /// # Accuracy
    /// `instruments_round_worst` in `docs/instructions.csv` is the cost of the most expensive
    /// [`BYTES_PER_ROUND`] bytes of both wires.
    pub fn round(&mut self, now: Time, room: usize) -> Events {
        let mut arrivals = Arrivals::new(now, room);
        self.receiver.round(&mut arrivals);
        self.autopilot.round(&self.receiver, &mut arrivals);
        arrivals.events
    }

    /// Returns a round of a test rig with the events of the wires added to its own.
    #[must_use]
    #[inline(never)]
    pub fn wired(&mut self, step: &RigStep) -> RigStep {
        let room = MAX_EVENTS.saturating_sub(step.events.len());
        let mut wired = step.clone();
        for &(time, event) in &self.round(step.time, room) {
            // There is room.
            arrivals::insert(&mut wired.events, time, event);
        }
        wired
    }

    /// Returns the counts of what has come, and of what was not used.
    #[must_use]
    pub const fn counters(&self) -> InstrumentCounters {
        InstrumentCounters {
            receiver: self.receiver.counters,
            autopilot: self.autopilot.counters,
            crowded_out: self.crowded_out,
        }
    }
}
