//! The machine of the frame: from a trigger to its record.
//!
//! ```text
//! Triggered ─next round─► RunUp ─at speed─► Tracking     (called off: refused)
//!   └─────────────────first light──────────────┴─► Exposing ─last light─► Closed ─stage read─┐
//!                                                           record ◄─next round─ Measured ◄──┘
//! ```
//!
//! First light ends every phase before it, since every exposure is recorded. Each phase carries the
//! data known by then.

mod interruption;
mod kept;
mod motion;
mod plan;
mod record;
mod shutter;

use self::kept::Kept;
pub(super) use self::plan::{Asked, Plan};
pub(super) use self::record::Recorded;
pub(super) use self::shutter::Due;
use super::stage::ExposureMotion;
use super::state::State;
use super::timing::TICK_S;
use crate::flight::fault::{Fault, Faults};
use crate::flight::frame_record::{Flag, Flags};
use crate::flight::time::Time;

/// The machine of the frame.
#[derive(Debug, Clone)]
pub(super) struct FrameMachine {
    in_flight: Option<InFlight>,
    /// Faults that occurred with no frame in flight; they go into the next record.
    faults: Faults,
    pub(super) kept: Kept,
}

/// A frame from its trigger to its record.
#[derive(Debug, Clone, Copy, PartialEq)]
struct InFlight {
    asked: Asked,
    /// Δδ of the plan, mm.
    planned_opening_mm: f32,
    /// δ of the plan, mm.
    planned_travel_mm: f32,
    /// First light, later than expected by this, s; negative earlier.
    late_s: f32,
    faults: Faults,
    flags: Flags,
    phase: Phase,
}

/// Progress of a frame, with the data known by then.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// The stage starts `wait_s` after the next round; first light is `opening_s` after that.
    Triggered { wait_s: f32, opening_s: f32 },
    /// The stage accelerates and settles until first light of the plan.
    RunUp { first_light: Time },
    /// The shutter has been told to open; first light is expected.
    Tracking { first_light: Time },
    /// The shutter is open since first light.
    Exposing {
        opened: Time,
        /// Time at which the shutter was told to close because it had been open for too long.
        told_to_close: Option<Time>,
    },
    /// The shutter is closed.
    Closed(Light),
    /// The motion of the stage is known.
    Measured(Light, ExposureMotion),
}

/// The interval from first to last light.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Light {
    opened: Time,
    closed: Time,
    /// Last light was not seen.
    is_end_assumed: bool,
}

impl FrameMachine {
    /// Before the first trigger.
    #[inline]
    pub(super) const fn new() -> Self {
        Self {
            in_flight: None,
            faults: Faults::NONE,
            kept: Kept::new(),
        }
    }

    /// To before the first trigger, as [`Self::new`]; what goes into the first record.
    pub(super) fn restart(&mut self, faults: Faults) {
        self.in_flight = None;
        self.faults = faults;
        self.kept.restart();
    }

    /// Begins a frame.
    pub(super) fn begin(&mut self, asked: Asked, plan: &Plan) {
        let mut faults = core::mem::take(&mut self.faults);
        faults.insert_all(plan.faults);
        self.in_flight = Some(InFlight {
            asked,
            planned_opening_mm: plan.opening_mm,
            planned_travel_mm: plan.travel_mm,
            late_s: 0.0,
            faults,
            flags: plan.flags,
            phase: Phase::Triggered {
                wait_s: plan.wait_s,
                opening_s: plan.opening_s,
            },
        });
    }

    /// Starts the run-up in the first round after the trigger. The stage starts at the same time
    /// after every trigger unless the round is late. Returns the time at which it starts.
    pub(super) fn start(&mut self, now: Time) -> Option<Time> {
        let frame = self.in_flight.as_mut()?;
        let Phase::Triggered { wait_s, opening_s } = frame.phase else {
            return None;
        };
        let began = now.max(frame.asked.trigger.plus_s(TICK_S)).plus_s(wait_s);
        frame.phase = Phase::RunUp {
            first_light: began.plus_s(opening_s),
        };
        Some(began)
    }

    /// Notes a fault for the record of the frame in flight, or else for the next record.
    pub(super) const fn note(&mut self, fault: Fault) {
        match &mut self.in_flight {
            Some(frame) => frame.faults.insert(fault),
            None => self.faults.insert(fault),
        }
    }

    /// Sets a flag of the frame in flight.
    pub(super) const fn flag(&mut self, flag: Flag) {
        if let Some(frame) = &mut self.in_flight {
            frame.flags.insert(flag);
        }
    }

    /// Sets flags of the frame in flight.
    pub(super) const fn flag_all(&mut self, flags: Flags) {
        if let Some(frame) = &mut self.in_flight {
            frame.flags.insert_all(flags);
        }
    }

    /// Number of the first record that is not finished: of the frame in flight, or else the next.
    pub(super) fn next_sequence(&self) -> u32 {
        match &self.in_flight {
            Some(frame) => frame.asked.sequence,
            None => self.kept.records().last_sequence().saturating_add(1),
        }
    }

    /// Returns the state of the frame in flight, as it is reported.
    pub(super) const fn state(&self) -> Option<State> {
        match &self.in_flight {
            None => None,
            Some(frame) => Some(match frame.phase {
                Phase::Triggered { .. } | Phase::RunUp { .. } => State::RunUp,
                Phase::Tracking { .. } => State::Tracking,
                Phase::Exposing { .. } | Phase::Closed(_) | Phase::Measured(..) => State::Exposing,
            }),
        }
    }

    const fn is_exposing(&self) -> bool {
        matches!(&self.in_flight, Some(frame) if matches!(frame.phase, Phase::Exposing { .. }))
    }

    pub(super) const fn is_in_flight(&self) -> bool {
        self.in_flight.is_some()
    }
}
