//! Readings of the stage's encoder.

use super::state::State;
use super::timing::{LATE_EVENT_S, TICK_S, UNLEARNED_TOLERANCE};
use super::{Actions, Controller};
use crate::flight::drive::StageReading;
use crate::flight::fault::Fault;
use crate::flight::frame_record::Flag;
use crate::flight::stage::Setpoint;
use crate::flight::stage_watch::{Finding, StageWatch};
use crate::flight::time::Time;

impl Controller {
    pub(super) fn stage_reading(
        &mut self,
        time: Time,
        reading: StageReading,
        actions: &mut Actions,
    ) {
        if self.is_place_lost || !self.camera.has_stage() {
            return;
        }
        let older_s = time.seconds_since(reading.time);
        if !(-TICK_S..=LATE_EVENT_S).contains(&older_s) || reading.time < self.last_reading {
            // No reading of now: where none comes, the encoder has failed.
            return;
        }
        let mut tolerance = self.settings.stage_tolerance();
        if let State::Standby | State::Fault(_) = self.state {
            // It may be moved by hand, or coast.
            self.watch = StageWatch::new();
        }
        let setpoint = if let Some(setpoint) = self.setpoint(reading.time) {
            if self.arming.is_some_and(|ways| ways > 0) {
                tolerance.following_mm *= UNLEARNED_TOLERANCE;
            }
            setpoint
        } else {
            // Without force there is nothing to follow, but jumps are none of its.
            tolerance.following_mm = f32::INFINITY;
            Setpoint {
                acceleration_mm_s2: 1.0,
                ..Setpoint::default()
            }
        };
        match self.watch.look(reading, setpoint, &tolerance) {
            // Until the next one shows what this one is.
            Finding::Suspicious => return,
            Finding::Follows => {}
            Finding::Glitch => {
                self.counts.glitches = self.counts.glitches.saturating_add(1);
                self.change_frame(|frame| frame.flags.insert(Flag::EncoderGlitch));
            }
            Finding::Fault(Fault::Encoder) => {
                self.fail(Fault::Encoder, actions);
                return;
            }
            Finding::Fault(fault) => self.fail(fault, actions),
        }
        let error_mm = reading.offset_mm - setpoint.offset_mm;
        self.last_reading = reading.time;
        self.track.push(reading);
        self.following.push(reading.time, error_mm);
        if self.motion.is_some() {
            self.following_error.push(error_mm);
        }
    }
}
