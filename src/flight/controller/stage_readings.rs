//! Readings of the stage's encoder.

use super::timing::UNLEARNED_TOLERANCE;
use super::{Actions, Controller};
use crate::flight::drive::StageReading;
use crate::flight::fault::Fault;
use crate::flight::frame_record::Flag;
use crate::flight::stage_watch::Finding;

impl Controller {
    pub(super) fn stage_reading(&mut self, reading: StageReading, actions: &mut Actions) {
        if self.is_place_lost || !self.camera.has_stage() {
            return;
        }
        let Some(setpoint) = self.motion.setpoint(reading.time) else {
            // Without force there is nothing to compare with.
            if reading.offset_mm.is_finite() {
                self.track.push(reading);
                self.following.push(reading.time, reading.offset_mm);
            }
            return;
        };
        let mut tolerance = self.settings.stage_tolerance();
        if self.exercise > 0 {
            tolerance.following_mm *= UNLEARNED_TOLERANCE;
        }
        match self.watch.look(reading, setpoint, &tolerance) {
            Finding::Suspicious => return,
            Finding::Follows => {}
            Finding::Glitch => {
                self.counts.glitches = self.counts.glitches.saturating_add(1);
                self.change_frame(|frame| frame.flags.insert(Flag::EncoderGlitch));
            }
            Finding::Fault(Fault::Encoder) => {
                self.fail(reading.time, Fault::Encoder, actions);
                return;
            }
            Finding::Fault(fault) => self.fail(reading.time, fault, actions),
        }
        let error_mm = reading.offset_mm - setpoint.offset_mm;
        self.track.push(reading);
        self.following.push(reading.time, error_mm);
        self.following_error.push(error_mm);
    }
}
