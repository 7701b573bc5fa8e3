//! The camera of a board: its drive moves a stage, its events come from wires and from the link.

use super::deck::FlightDeck;
use super::message::{Refusal, Start};
use crate::flight::camera::{CameraRecord, Mechanism};
use crate::flight::controller::state::State;
use crate::flight::controller::{self, Controller};
use crate::flight::drive::flown_drive::FlownDrive;
use crate::flight::event::{Command, Event, Supply};
use crate::flight::event_queue::EventQueue;
use crate::flight::input_levels::InputLevels;
use crate::flight::rig::{RigAnswer, RigStep};
use crate::flight::settings::FlightSettings;
use crate::flight::time::Time;
use crate::flight::unit::{self, RoundActions};

/// A camera that moves a stage, with one drive for all the flights it is prepared for.
///
/// It has no clock: the board says what time it is, with every round and, so that what it is told gets the time of its
/// arrival, before bytes of the link go to the [`Station`](super::station::Station).
///
/// Every millisecond: what the interrupts have stamped goes to [`Self::capture`], what the lines say to
/// [`Self::see`], and then comes [`Self::round`]. Until it is prepared it does nothing but read the stage, and forgets
/// what it is given.
#[derive(Debug)]
pub struct FlownDeck<Drive> {
    start: controller::Start,
    drive: Drive,
    controller: Option<Controller>,
    events: EventQueue,
    /// What the controller knows of the lines.
    known: InputLevels,
    /// What the lines said in the last round.
    seen: InputLevels,
    /// Where the stage was in the last round.
    offset_mm: Option<f32>,
    now: Time,
    has_row_clock: bool,
}

impl<Drive: FlownDrive> FlownDeck<Drive> {
    /// A camera that has not been prepared. Its encoder counts from wherever the stage stands: before it compensates
    /// somebody has to say where that is ([`Command::Referenced`]).
    #[must_use]
    pub const fn new(drive: Drive, start: Start) -> Self {
        Self {
            start: match start {
                Start::PowerOn | Start::Requested => controller::Start::Unreferenced,
                Start::Watchdog | Start::Fault => controller::Start::AfterWatchdog,
            },
            drive,
            controller: None,
            events: EventQueue::new(),
            known: InputLevels::GOOD,
            seen: InputLevels::GOOD,
            offset_mm: None,
            now: Time::START,
            has_row_clock: false,
        }
    }

    /// The same, on a board that does as [`Action::ClockRows`](crate::flight::event::Action::ClockRows) says; on any
    /// other a TDI camera is refused.
    #[must_use]
    pub fn with_row_clock(self) -> Self {
        Self {
            has_row_clock: true,
            ..self
        }
    }

    /// It is so late now; time does not go back.
    pub fn set_now(&mut self, now: Time) {
        self.now = self.now.max(now);
    }

    /// Something has happened that a wire says, at a time that may be somewhat before now. Where there is no place for
    /// it, it is counted ([`EventQueue`]).
    pub fn capture(&mut self, time: Time, event: Event) {
        if self.controller.is_some() {
            self.events.push(time, event);
        }
    }

    /// So many edges were lost before they could be handed over.
    pub const fn count_lost(&mut self, edges: u32) {
        if self.controller.is_some() {
            self.events.count_lost(edges);
        }
    }

    /// What the lines say now, once a round: changes become events, and what is wrong when a camera is prepared does,
    /// too. So does a limit switch that is closed when faults are cleared: it has not been left yet.
    ///
    /// A switch has closed, or opened, where two rounds on end say so: a spike on its line does not end a flight. The
    /// second round is 50 µm more of the stage's way at 50 mm/s.
    pub fn see(&mut self, levels: InputLevels) {
        let before = core::mem::replace(&mut self.seen, levels);
        if self.controller.is_none() {
            return;
        }
        let levels = levels.with_steady_limits(&before, &self.known);
        if levels.has_closed_since(&self.known)
            && self.events.offer(self.now, Event::LimitSwitch).is_err()
        {
            // Once more in the next round.
            return;
        }
        let supply = if levels.supply_low {
            Supply::Low
        } else {
            Supply::Good
        };
        let supply_low = if levels.supply_low == self.known.supply_low
            || self.events.offer(self.now, Event::Supply(supply)).is_ok()
        {
            levels.supply_low
        } else {
            self.known.supply_low
        };
        self.known = InputLevels {
            supply_low,
            ..levels
        };
    }

    /// The control loop comes round. What the stage is to do has been done on return; the rest is the board's.
    pub fn round(&mut self, now: Time) -> RoundActions {
        self.set_now(now);
        let Some(controller) = &mut self.controller else {
            // To be looked at; and a counter of 16 bits must be asked now and then.
            let reading = self.drive.position(now);
            self.offset_mm = reading.ok().map(|reading| reading.offset_mm);
            return RoundActions::new();
        };
        let events = self.events.take(now);
        // It is the first, or not among them.
        if let Some((_, Event::Command(Command::Referenced))) = events.first()
            && controller.state() == State::Standby
        {
            self.drive.set_reference();
        }
        if events
            .iter()
            .any(|(_, event)| *event == Event::Command(Command::ClearFault))
        {
            // A switch that is still closed, or whose wire is broken, says so again.
            self.known = InputLevels {
                supply_low: self.known.supply_low,
                ..InputLevels::GOOD
            };
        }
        let reading = self.drive.position(now);
        self.offset_mm = reading.ok().map(|reading| reading.offset_mm);
        unit::round(controller, &mut self.drive, now, reading, &events)
    }

    /// The drive.
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The drive.
    pub const fn drive_mut(&mut self) -> &mut Drive {
        &mut self.drive
    }
}

impl<Drive: FlownDrive> FlightDeck for FlownDeck<Drive> {
    fn prepare(
        &mut self,
        camera: &CameraRecord,
        calibration_crc: u32,
        settings: &FlightSettings,
    ) -> Result<(), Refusal> {
        if let Mechanism::Tdi { .. } = camera.mechanism
            && !self.has_row_clock
        {
            return Err(Refusal::NoRowClock);
        }
        // A fault that nobody has cleared is not forgotten.
        if let Some(controller) = &self.controller {
            self.start = controller.next_start();
        }
        match Controller::new(camera, calibration_crc, settings, self.start) {
            Ok(controller) => {
                self.drive
                    .set_settings(settings.drive)
                    .map_err(Refusal::Settings)?;
                self.controller = Some(controller);
            }
            Err(error) => return Err(error.into()),
        }
        self.events.clear();
        self.known = InputLevels::GOOD;
        Ok(())
    }

    fn controller(&self) -> Option<&Controller> {
        self.controller.as_ref()
    }

    fn controller_mut(&mut self) -> Option<&mut Controller> {
        self.controller.as_mut()
    }

    fn offset_mm(&self) -> Option<f32> {
        self.offset_mm
    }

    /// Its time is its own.
    fn step(&mut self, _: &RigStep) -> Option<Result<RigAnswer, Refusal>> {
        None
    }

    fn tell(&mut self, event: Event) -> Result<(), Refusal> {
        if self.controller.is_none() {
            return Err(Refusal::NotPrepared);
        }
        if !event.is_told() {
            return Err(Refusal::NotTold);
        }
        self.events
            .offer(self.now, event)
            .map_err(|_| Refusal::QueueFull)
    }
}
