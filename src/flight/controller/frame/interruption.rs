//! The interruption of a frame.

use super::{Asked, FrameMachine, Phase};
use crate::flight::frame_record::{Flag, Reason};

impl FrameMachine {
    /// Ends the frame in flight before first light. Returns its number, and `true` if the shutter
    /// had been told to open; `None` if no frame is in flight, or light has come.
    pub(in super::super) fn call_off(&mut self, reason: Reason) -> Option<(u32, bool)> {
        let frame = self.in_flight.as_ref()?;
        let is_told = match frame.phase {
            Phase::Triggered { .. } | Phase::RunUp { .. } => false,
            Phase::Tracking { .. } => true,
            Phase::Exposing { .. } | Phase::Closed(_) | Phase::Measured(..) => return None,
        };
        let Asked {
            sequence, trigger, ..
        } = frame.asked;
        let faults = frame.faults;
        self.in_flight = None;
        self.kept.refuse(sequence, trigger, reason, faults);
        Some((sequence, is_told))
    }

    /// Ends the exposure in flight after a jump of the clock. Returns `true` if light had come: the
    /// exposure is then taken to have ended on time, with the planned motion unless it has been
    /// measured, and has to be recorded.
    pub(in super::super) fn end_with_clock(&mut self) -> bool {
        let Some(frame) = &mut self.in_flight else {
            return false;
        };
        match frame.phase {
            Phase::Triggered { .. } | Phase::RunUp { .. } | Phase::Tracking { .. } => return false,
            Phase::Exposing { opened, .. } => {
                frame.assume_last_light(opened);
                frame.flags.insert(Flag::PlannedMotion);
            }
            Phase::Closed(_) => frame.flags.insert(Flag::PlannedMotion),
            Phase::Measured(..) => {}
        }
        true
    }
}
