//! The camera's state machine: one frame from trigger to record.
//!
//! Events come in with their time, in order; actions go out. The machine neither waits nor reads
//! anything from outside, so that firmware, simulator and tests run the same code. In each round of
//! the control loop (1 kHz) it gets the events since the last round, then [`Event::Stage`], then
//! [`Event::Tick`].
//!
//! ```text
//! standby ─arm─► fly-back ──► armed ─trigger─► run-up ─at speed─► tracking ─first light─► exposing
//!                   ▲                                                 │                      │
//!                   └─────────────────────────────────────────────────┴───── last light ─────┘
//! armed ◄──► degraded(V/H lost, overload)      any ──► fault ──stage stands──► degraded(its fault)
//! ```
//!
//! Three machines, each with its own fields, take events and return their decisions: `readiness`
//! (the reply to a trigger), `frame` (the command of the shutter, the contents of the record) and
//! `stage` (the force on the stage, the judgement of its readings). The controller passes events
//! and decisions between them, in the order of `docs/integration.md`, section 2. The reported
//! [`State`] is the fault of `readiness`, or else the phase of a frame in flight, or else the state
//! of `readiness`.

mod aircraft;
mod checks;
mod commands;
mod error;
mod exchange;
mod faults;
mod flyable;
mod frame;
mod index_mark;
mod passing;
mod readiness;
#[cfg(feature = "link")]
mod resumption;
mod setup;
mod stage;
mod start;
pub mod state;
mod status;
pub mod timing;
mod ways;

use heapless::Vec;

use self::aircraft::{Aircraft, Said};
pub use self::error::ControllerError;
pub use self::exchange::NotExchanged;
use self::frame::FrameMachine;
use self::readiness::{Mode, Readiness};
#[cfg(feature = "link")]
pub(crate) use self::resumption::FlightState;
pub(super) use self::setup::{Preparation, Setup, checked};
use self::stage::StageMachine;
pub use self::start::Start;
use self::state::State;
pub use self::status::Counts;
use super::event::{Action, Event};
use super::fault::Fault;
use super::flown_calibrations::FlownCalibrations;
use super::lens_temperature::LensTemperature;
use super::stage_track::StagePlace;
use super::time::Time;

/// Largest number of actions that one event leads to.
pub const MAX_ACTIONS: usize = 6;

/// Actions that follow from an event, in order.
pub type Actions = Vec<Action, MAX_ACTIONS>;

/// The camera's state machine. It has no camera of its own:
/// [`PreparedCamera`](super::prepared_camera::PreparedCamera) and the decks hand it the one they
/// hold, with every event.
#[derive(Debug, Clone)]
pub struct Controller {
    aircraft: Aircraft,
    stage: StageMachine,
    frame: FrameMachine,
    readiness: Readiness,
    /// Exposure time of the frames to come, s.
    exposure_s: f32,
    /// Their Δz beyond the run-out of the stage and the focus table of the calibration, µm.
    focus_shift_um: f32,
    /// Temperature for the focus table.
    temperature: LensTemperature,
    /// Those of the camera, for the records.
    calibrations: FlownCalibrations,
    /// Number of the flight, for the records.
    flight: u32,
}

impl Controller {
    /// Takes an event and returns the actions that follow from it. Events come in order of their
    /// times; one that is older than the one before by more than [`timing::LATE_EVENT_S`], or later
    /// by more than [`timing::CLOCK_JUMP_S`], is a [`Fault::Clock`].
    pub(super) fn handle(&mut self, setup: &Setup, time: Time, event: Event) -> Actions {
        let mut actions = Actions::new();
        if self.readiness.has_jumped(time) {
            self.restart_clock(setup, time, &mut actions);
        }
        match event {
            Event::Command(command) => self.obey(setup, time, command, &mut actions),
            Event::Vh(sample) => self.aircraft.hear(time, Said::Vh(sample)),
            Event::Attitude(sample) => self.aircraft.hear(time, Said::Attitude(sample)),
            Event::TimePulse => self.aircraft.hear(time, Said::TimePulse),
            Event::GnssTime(unix_us) => self.aircraft.hear(time, Said::GnssTime(unix_us)),
            Event::Trigger => self.trigger(setup, time, &mut actions),
            Event::Shutter(edge) => self.shutter_edge(setup, time, edge, &mut actions),
            Event::Stage(reading) => self.stage_reading(setup, time, reading, &mut actions),
            Event::IndexMark(reading_mm) => self.index_mark(setup, time, reading_mm),
            Event::Latched(reading) => self.stage.latch(setup, reading),
            Event::LimitSwitch => self.fail(setup, Fault::LimitSwitch, &mut actions),
            Event::Drive(fault) => self.fail(setup, fault, &mut actions),
            Event::Supply(supply) => self.supply(setup, supply, &mut actions),
            Event::Tick => self.tick(setup, time, &mut actions),
            Event::Lost(events) => {
                self.readiness.lose(events);
                self.report(Fault::Overload, &mut actions);
            }
        }
        actions
    }

    /// The camera's state.
    #[must_use]
    pub const fn state(&self) -> State {
        self.readiness.state(self.frame.state())
    }

    /// Returns `true` from first light on, until the exposure is recorded.
    pub(super) const fn is_in_exposure(&self) -> bool {
        self.stage.track().is_kept()
    }

    /// The last place of the stage.
    pub(super) fn last_place(&self) -> Option<StagePlace> {
        self.stage.track().last()
    }

    /// Runs a round of the control loop.
    fn tick(&mut self, setup: &Setup, now: Time, actions: &mut Actions) {
        if self.readiness.is_before_first_round()
            && self.readiness.mode() == Mode::Fault(Fault::Watchdog)
        {
            // The shutter may still hold a command from before the reset.
            act(actions, Action::CloseShutter);
        }
        self.come_round(setup, now, actions);
        if let Some(began) = self.frame.start(now) {
            self.stage.begin(began);
        }
        if self.stage.is_unread(now) {
            self.fail(setup, Fault::Encoder, actions);
        }
        if self.frame.is_in_flight() {
            self.look_after_frame(setup, now, actions);
        }
        if !self.frame.is_in_flight() {
            self.look_after_readiness(setup, now, actions);
        }
        if let Some(setpoint) = self.stage.setpoint(now) {
            act(actions, Action::MoveStage(setpoint));
        }
    }
}

/// Adds an action; there is room for those of one event.
fn act(actions: &mut Actions, action: Action) {
    let _ = actions.push(action);
}
