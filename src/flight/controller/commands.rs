//! Commands to the camera.

use super::readiness::{Disarming, Mode};
use super::setup::Setup;
use super::{Actions, Controller, act};
use crate::flight::event::{Action, Command};
use crate::flight::frame_record::Reason;
use crate::flight::time::Time;

impl Controller {
    pub(super) fn obey(
        &mut self,
        setup: &Setup,
        now: Time,
        command: Command,
        actions: &mut Actions,
    ) {
        match command {
            Command::Arm => match self.readiness.arm() {
                Ok(true) => {
                    self.stage.index.arm();
                    self.stage.play_watch.forget_counts();
                    self.resume(setup, now, actions);
                }
                Ok(false) => {}
                Err(fault) => act(actions, Action::Fault(fault)),
            },
            Command::Disarm => match self.readiness.disarm(self.state()) {
                Disarming::Later => {}
                Disarming::Now => self.stand_by(actions),
                Disarming::CallOff => self.call_off(setup, now, Reason::Disarmed, actions),
            },
            Command::ClearFault => {
                self.aircraft.clear_doubt();
                self.clear_fault(actions);
            }
            Command::Referenced => self.referenced(),
            // An exposure time outside the camera's limits leads to the refusal of every trigger.
            Command::Exposure(exposure_s) => self.exposure_s = exposure_s,
            // As one beyond what the camera's model holds for.
            Command::FocusShift(shift_um) => self.focus_shift_um = shift_um,
            Command::Temperature(celsius) => self.temperature.tell(now, celsius),
        }
    }

    /// Returns to standby from a fault, or from flying without compensation because of one. An
    /// exposure under way goes on. A place that is lost stays lost.
    fn clear_fault(&mut self, actions: &mut Actions) {
        if !self.frame.is_in_flight() && self.readiness.clear_fault() {
            self.stage.clear_fault();
            self.stand_by(actions);
        }
    }

    /// Notes that the encoder counts from the calibrated position again. It does so in standby
    /// alone, where nothing follows from it at once.
    fn referenced(&mut self) {
        if self.readiness.mode() == Mode::Standby {
            self.stage.refer();
        }
    }
}
