//! Controller and drive together, for one round of the control loop.

use heapless::Vec;

use super::controller::{Actions, Controller, MAX_ACTIONS, Setup};
use super::drive::{FmcDrive, StageReading};
use super::event::{Action, Event, ShutterEdge};
use super::fault::Fault;
use super::prepared_camera::PreparedCamera;
use super::settings::FlightSettings;
use super::time::Time;

/// Largest number of events in one round.
pub const MAX_EVENTS: usize = 6;

/// Largest number of actions of one round: those of its events, of the stage's reading with the
/// index mark (one of the two at most leads to a fault), of the tick, and of a drive that fails.
pub const MAX_ROUND_ACTIONS: usize = MAX_ACTIONS * (MAX_EVENTS + 3);

/// Events with their times, in order of time.
pub type Events = Vec<(Time, Event), MAX_EVENTS>;

/// Actions of a round, besides the drive's motion.
pub type RoundActions = Vec<Action, MAX_ROUND_ACTIONS>;

/// A camera that moves a stage.
#[derive(Debug)]
pub struct ControlLoop<Drive> {
    camera: PreparedCamera,
    drive: Drive,
}

impl<Drive: FmcDrive> ControlLoop<Drive> {
    /// Returns a camera with its drive, which is released.
    #[must_use]
    pub const fn new(camera: PreparedCamera, drive: Drive) -> Self {
        Self { camera, drive }
    }

    /// Runs one round of the control loop with the events since the last. The stage is read first,
    /// at `now`.
    ///
    /// [`Action::MoveStage`] and [`Action::ReleaseStage`] have been done on return; the caller
    /// carries out the others.
    pub fn round(&mut self, now: Time, events: &Events) -> RoundActions {
        let reading = self.drive.position(now);
        let (setup, controller) = self.camera.flown();
        let mut outside = RoundActions::new();
        let flown = (&setup, controller);
        round(flown, &mut self.drive, now, reading, events, &mut outside);
        outside
    }

    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> &FlightSettings {
        self.camera.settings()
    }

    /// The state machine.
    #[must_use]
    pub const fn controller(&self) -> &Controller {
        self.camera.controller()
    }

    /// The state machine, for the acknowledgement of its records.
    pub const fn controller_mut(&mut self) -> &mut Controller {
        self.camera.controller_mut()
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
/// that the time spent on the events does not make the reading late. The actions are added to
/// `outside`, which is empty: the list is long, and is not moved.
pub(super) fn round(
    (setup, controller): (&Setup, &mut Controller),
    drive: &mut impl FmcDrive,
    now: Time,
    reading: Result<StageReading, Fault>,
    events: &Events,
    outside: &mut RoundActions,
) {
    let reading = match reading {
        Ok(reading) => Event::Stage(reading),
        Err(fault) => Event::Drive(fault),
    };
    let opens = |(_, event): &(Time, Event)| *event == Event::Shutter(ShutterEdge::Opened);
    if controller.is_in_exposure() || events.iter().any(opens) {
        let last = controller.last_place();
        for latched in drive.take_latches() {
            if last.is_none_or(|last| latched.time > last.time) {
                // It leads to no action.
                controller.handle(setup, latched.time, Event::Latched(latched));
            }
        }
    }
    for (time, event) in events {
        let actions = controller.handle(setup, *time, *event);
        take((setup, controller), drive, now, &actions, outside);
        if let Event::Shutter(edge) = *event
            && let Some(latched) = drive.take_latched(edge, *time)
        {
            controller.handle(setup, *time, Event::Latched(latched));
        }
    }
    let actions = controller.handle(setup, now, reading);
    take((setup, controller), drive, now, &actions, outside);
    if let Some(index_mm) = drive.take_index() {
        let actions = controller.handle(setup, now, Event::IndexMark(index_mm));
        take((setup, controller), drive, now, &actions, outside);
    }
    let actions = controller.handle(setup, now, Event::Tick);
    take((setup, controller), drive, now, &actions, outside);
}

/// Carries out what the drive does, and leaves the other actions to the board. An opening is looked
/// at once more.
fn take(
    (setup, controller): (&Setup, &mut Controller),
    drive: &mut impl FmcDrive,
    now: Time,
    actions: &Actions,
    outside: &mut RoundActions,
) {
    let (mut failed, mut is_refused) = (None, false);
    for action in actions {
        match *action {
            Action::OpenShutter { at, exposure_s }
                if !controller.may_open(setup, now, (at, exposure_s)) =>
            {
                is_refused = true;
            }
            Action::MoveStage(setpoint) => failed = drive.follow(now, setpoint).err(),
            other => hand_over(other, drive, outside),
        }
    }
    if is_refused {
        for action in &controller.refuse_opening(setup, now) {
            hand_over(*action, drive, outside);
        }
    }
    if let Some(fault) = failed {
        for action in &controller.handle(setup, now, Event::Drive(fault)) {
            hand_over(*action, drive, outside);
        }
    }
}

/// Releases the drive if that is the action, and leaves any other to the board.
fn hand_over(action: Action, drive: &mut impl FmcDrive, outside: &mut RoundActions) {
    if action == Action::ReleaseStage {
        drive.release();
    } else {
        // There is room for all.
        let _ = outside.push(action);
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::flight::controller::Start;
    use crate::flight::controller::state::State;
    use crate::flight::event::Command;
    use crate::flight::frame_record::{Outcome, Reason};
    use crate::flight::vh::VhSample;
    use crate::{CalibrationParameters, Camera, CameraParameters};

    /// Drive that is where it has been told to be.
    #[derive(Debug, Default)]
    struct Ideal {
        told: Option<(Time, f32, f32)>,
    }

    impl FmcDrive for Ideal {
        fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
            let offset_mm = self.told.map_or(0.0, |(time, offset_mm, speed_mm_s)| {
                offset_mm + speed_mm_s * now.seconds_since(time)
            });
            Ok(StageReading {
                time: now,
                offset_mm,
            })
        }

        fn follow(
            &mut self,
            now: Time,
            setpoint: crate::flight::stage::Setpoint,
        ) -> Result<(), Fault> {
            self.told = Some((now, setpoint.offset_mm, setpoint.speed_mm_s));
            Ok(())
        }

        fn release(&mut self) {
            self.told = None;
        }
    }

    /// Returns a camera in the run-up of a frame, with its time.
    fn running_up() -> (ControlLoop<Ideal>, Time) {
        let camera = CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75));
        let camera = Camera::new(camera).unwrap();
        let settings = FlightSettings::default();
        let camera = PreparedCamera::new(camera, &settings, Start::Orderly).unwrap();
        let mut control = ControlLoop::new(camera, Ideal::default());
        let mut now = Time::from_us(1_000_000);
        let mut round = |event: Option<Event>| {
            now = now.plus_s(1e-3);
            let events = [Some(Event::Vh(VhSample::Direct(0.1))), event];
            let events = events.into_iter().flatten().map(|event| (now, event));
            control.round(now, &events.collect());
            (control.controller().state(), now)
        };
        round(None);
        round(Some(Event::Command(Command::Arm)));
        while round(None).0 != State::Armed {}
        let (state, now) = round(Some(Event::Trigger));
        assert_eq!(state, State::RunUp);
        (control, now)
    }

    #[test]
    fn opening_that_comes_out_of_turn_does_not_leave_and_ends_its_frame() {
        // At a time to come, and over a stage that has not been read for 7 ms.
        for [after_s, later_s] in [[0.001, 0.5], [0.007, 0.0]] {
            let (mut control, now) = running_up();
            let now = now.plus_s(after_s);
            let at = now.plus_s(later_s);
            let exposure_s = control.settings().exposure_s;
            let (setup, controller) = control.camera.flown();
            let actions = Actions::from_iter([Action::OpenShutter { at, exposure_s }]);
            let mut outside = RoundActions::new();
            let flown = (&setup, &mut *controller);
            take(flown, &mut control.drive, now, &actions, &mut outside);
            assert_eq!(outside, [Action::FrameReady(1)]);
            let record = controller.record(0).unwrap();
            assert_eq!(record.outcome, Outcome::Refused(Reason::NotAtSpeed));
            assert_eq!(controller.state(), State::FlyBack);
            assert!(control.drive().told.is_some(), "the stage is led back");
        }
    }

    #[test]
    fn opening_over_a_stage_at_speed_leaves() {
        let (mut control, mut now) = running_up();
        let mut opened = Vec::new();
        while opened.is_empty() {
            now = now.plus_s(1e-3);
            let actions = control.round(now, &Events::new());
            opened.extend(actions.into_iter().filter_map(|action| match action {
                Action::OpenShutter { at, .. } => Some(at),
                _ => None,
            }));
        }
        assert_eq!(control.controller().state(), State::Tracking);
        assert!(opened[0].seconds_since(now) <= 1e-3);
    }
}
