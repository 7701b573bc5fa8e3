//! Edges of the shutter's sensor.

use super::state::State;
use super::{Actions, Controller, act};
use crate::flight::event::{Action, ShutterEdge};
use crate::flight::fault::Fault;
use crate::flight::time::Time;

impl Controller {
    pub(super) fn shutter_edge(&mut self, time: Time, edge: ShutterEdge, actions: &mut Actions) {
        let Some(frame) = self.frame else {
            self.counts.unexpected_edges = self.counts.unexpected_edges.saturating_add(1);
            self.report(Fault::ShutterUnexpected, actions);
            if edge == ShutterEdge::Opened {
                act(actions, Action::CloseShutter);
            }
            return;
        };
        let tolerance_s = self.settings.shutter_tolerance_s;
        match (edge, frame.opened, frame.closed) {
            (ShutterEdge::Opened, None, _) => {
                let late_s = time.seconds_since(frame.first_light);
                if !frame.is_commanded || late_s < -tolerance_s {
                    self.report(Fault::ShutterUnexpected, actions);
                    if frame.is_commanded {
                        // Its command may not have left yet: it is not to open once more.
                        act(actions, Action::CloseShutter);
                    }
                } else if late_s > tolerance_s {
                    self.report(Fault::ShutterLate, actions);
                }
                // Light is light: whatever came before, this exposure is recorded.
                self.change_frame(|frame| frame.opened = Some(time));
                self.track.keep_from(time);
                self.state = State::Exposing;
            }
            (ShutterEdge::Closed, Some(opened), None) if time > opened => {
                let longer_s = time.seconds_since(opened) - frame.exposure.exposure_s;
                if longer_s > tolerance_s {
                    self.report(Fault::ShutterLong, actions);
                } else if longer_s < -tolerance_s {
                    self.report(Fault::ShutterShort, actions);
                }
                self.change_frame(|frame| frame.closed = Some(time));
            }
            _ => {
                self.counts.unexpected_edges = self.counts.unexpected_edges.saturating_add(1);
                self.report(Fault::ShutterUnexpected, actions);
                if edge == ShutterEdge::Opened && frame.closed.is_some() {
                    act(actions, Action::CloseShutter);
                }
            }
        }
    }

    /// A fault that ends nothing.
    pub(super) fn report(&mut self, fault: Fault, actions: &mut Actions) {
        self.note(fault);
        act(actions, Action::Fault(fault));
    }
}
