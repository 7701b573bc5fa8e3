//! Checks that reveal a fault: late rounds, and readings of the stage.

use super::readiness::Round;
use super::setup::Setup;
use super::state::State;
use super::{Actions, Controller};
use crate::flight::drive::StageReading;
use crate::flight::fault::Fault;
use crate::flight::frame_record::{Flag, Reason};
use crate::flight::stage_watch::ReadingVerdict;
use crate::flight::time::Time;

impl Controller {
    /// Judges the time of a round. Too many late rounds end a frame that has no light yet, and from
    /// then on the camera flies without compensation.
    pub(super) fn come_round(&mut self, setup: &Setup, now: Time, actions: &mut Actions) {
        match self.readiness.come_round(now) {
            Round::Punctual | Round::Idle => {}
            Round::Backwards => self.restart_clock(setup, now, actions),
            Round::Late => self.frame.note(Fault::Overload),
            Round::Overload => {
                self.report(Fault::Overload, actions);
                if let State::RunUp | State::Tracking = self.state() {
                    self.call_off(setup, now, Reason::Fault(Fault::Overload), actions);
                }
            }
        }
    }

    /// Judges a reading of the stage's encoder, and keeps it if it can be used.
    pub(super) fn stage_reading(
        &mut self,
        setup: &Setup,
        time: Time,
        reading: StageReading,
        actions: &mut Actions,
    ) {
        let obedience = self.readiness.obedience();
        let Some(seen) = self.stage.look(setup, obedience, time, reading) else {
            return;
        };
        match seen.verdict {
            ReadingVerdict::Follows | ReadingVerdict::Suspicious => {}
            ReadingVerdict::Glitch => self.frame.flag(Flag::EncoderGlitch),
            ReadingVerdict::Fault(fault) => self.fail(setup, fault, actions),
        }
        if seen.verdict != ReadingVerdict::Fault(Fault::Encoder) {
            self.stage.keep(setup, reading, seen);
            self.judge_index(setup, actions);
        }
    }
}
