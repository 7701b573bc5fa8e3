//! Controller and drive together, for one round of the control loop.

use heapless::Vec;

use super::controller::{Actions, Controller, MAX_ACTIONS};
use super::drive::{FmcDrive, StageReading};
use super::event::{Action, Event};
use super::fault::Fault;
use super::time::Time;

/// Largest number of events in one round.
pub const MAX_EVENTS: usize = 6;

/// Largest number of actions of one round: those of its events, of the stage's reading, of the
/// tick, and of a drive that fails.
pub const MAX_ROUND_ACTIONS: usize = MAX_ACTIONS * (MAX_EVENTS + 3);

/// Events with their times, in order of time.
pub type Events = Vec<(Time, Event), MAX_EVENTS>;

/// Actions of a round, besides the drive's motion.
pub type RoundActions = Vec<Action, MAX_ROUND_ACTIONS>;

/// A camera that moves a stage.
#[derive(Debug)]
pub struct ControlLoop<Drive> {
    controller: Controller,
    drive: Drive,
}

impl<Drive: FmcDrive> ControlLoop<Drive> {
    /// Returns a camera with its drive, which is released.
    #[must_use]
    pub const fn new(controller: Controller, drive: Drive) -> Self {
        Self { controller, drive }
    }

    /// Runs one round of the control loop with the events since the last. The stage is read first,
    /// at `now`.
    ///
    /// [`Action::MoveStage`] and [`Action::ReleaseStage`] have been done on return; the caller
    /// carries out the others.
    pub fn round(&mut self, now: Time, events: &Events) -> RoundActions {
        let reading = self.drive.position(now);
        round(&mut self.controller, &mut self.drive, now, reading, events)
    }

    /// The state machine.
    #[must_use]
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The state machine, for the acknowledgement of its records.
    pub const fn controller_mut(&mut self) -> &mut Controller {
        &mut self.controller
    }

    /// The drive.
    #[must_use]
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The drive.
    pub const fn drive_mut(&mut self) -> &mut Drive {
        &mut self.drive
    }
}

/// Runs a round of the control loop as [`ControlLoop::round`], after the stage has been read, so
/// that the time spent on the events does not make the reading late.
pub(crate) fn round(
    controller: &mut Controller,
    drive: &mut impl FmcDrive,
    now: Time,
    reading: Result<StageReading, Fault>,
    events: &Events,
) -> RoundActions {
    let mut outside = RoundActions::new();
    let reading = match reading {
        Ok(reading) => Event::Stage(reading),
        Err(fault) => Event::Drive(fault),
    };
    for (time, event) in events {
        let actions = controller.handle(*time, *event);
        take(controller, drive, now, &actions, &mut outside);
    }
    let actions = controller.handle(now, reading);
    take(controller, drive, now, &actions, &mut outside);
    let actions = controller.handle(now, Event::Tick);
    take(controller, drive, now, &actions, &mut outside);
    outside
}

fn take(
    controller: &mut Controller,
    drive: &mut impl FmcDrive,
    now: Time,
    actions: &Actions,
    outside: &mut RoundActions,
) {
    let mut failed = None;
    for action in actions {
        match *action {
            Action::MoveStage(setpoint) => failed = drive.follow(now, setpoint).err(),
            Action::ReleaseStage => drive.release(),
            // There is room for all.
            other => {
                let _ = outside.push(other);
            }
        }
    }
    if let Some(fault) = failed {
        for action in &controller.handle(now, Event::Drive(fault)) {
            if *action == Action::ReleaseStage {
                drive.release();
            } else {
                let _ = outside.push(*action);
            }
        }
    }
}
