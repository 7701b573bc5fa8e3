//! Controller and drive together: one round of the control loop.

use heapless::Vec;

use super::controller::{Actions, Controller, MAX_ACTIONS};
use super::drive::{FmcDrive, StageReading};
use super::event::{Action, Event};
use super::fault::Fault;
use super::time::Time;

/// Events in one round.
pub const MAX_EVENTS: usize = 6;

/// Most actions of one round: those of its events, of the stage's reading, of the tick, and of a drive that fails.
pub const MAX_ROUND_ACTIONS: usize = MAX_ACTIONS * (MAX_EVENTS + 3);

/// Events with their times, in order of time.
pub type Events = Vec<(Time, Event), MAX_EVENTS>;

/// What a round leads to, besides the drive's motion.
pub type RoundActions = Vec<Action, MAX_ROUND_ACTIONS>;

/// A camera that moves a stage.
#[derive(Debug)]
pub struct ControlLoop<Drive> {
    controller: Controller,
    drive: Drive,
}

impl<Drive: FmcDrive> ControlLoop<Drive> {
    /// A camera and its drive, which is released.
    #[must_use]
    pub const fn new(controller: Controller, drive: Drive) -> Self {
        Self { controller, drive }
    }

    /// One round of the control loop: what has happened since the last, a look at the stage, and what follows from
    /// both. The stage is read first, at `now`.
    ///
    /// [`Action::MoveStage`] and [`Action::ReleaseStage`] have been done on return; the others are the caller's.
    pub fn round(&mut self, now: Time, events: &Events) -> RoundActions {
        let reading = self.drive.position(now);
        round(&mut self.controller, &mut self.drive, now, reading, events)
    }

    /// The state machine.
    #[must_use]
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The state machine, to acknowledge its records.
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

/// A round of the control loop, as [`ControlLoop::round`], the stage having been read: what the events cost is no way of
/// it.
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
