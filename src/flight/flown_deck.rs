//! The camera of a board: its drive moves a stage, its events come from wires and from what it is told.

use core::fmt;

use super::camera::{CameraParameters, Mechanism};
use super::control_loop::{self, RoundActions};
use super::controller::state::State;
use super::controller::{Controller, ControllerError, Start};
use super::drive::flown_drive::FlownDrive;
use super::event::{Command, Event, Supply};
use super::event_queue::EventQueue;
use super::input_levels::InputLevels;
use super::settings::FlightSettings;
use super::time::Time;

/// A camera that moves a stage, with one drive for all the flights it is prepared for.
///
/// It has no clock: the board says what time it is, with every round and before [`Self::tell`], so that what it is told
/// gets the time of its arrival.
///
/// Every millisecond: what the interrupts have stamped goes to [`Self::capture`], what the lines say to
/// [`Self::see`], and then comes [`Self::round`]. Until it is prepared it does nothing but read the stage, and forgets
/// what it is given.
#[derive(Debug)]
pub struct FlownDeck<Drive> {
    start: Start,
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
    /// A camera that has not been prepared. After [`Start::Unreferenced`] its encoder counts from wherever the stage
    /// stands: before it compensates somebody has to say where that is ([`Command::Referenced`]).
    #[must_use]
    pub const fn new(drive: Drive, start: Start) -> Self {
        Self {
            start,
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
        control_loop::round(controller, &mut self.drive, now, reading, &events)
    }

    /// The drive.
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The drive.
    pub const fn drive_mut(&mut self) -> &mut Drive {
        &mut self.drive
    }

    /// Makes it ready to be flown, in place of the camera before.
    ///
    /// # Errors
    /// [`NotFlyable`]; the camera before stays as it was.
    pub fn prepare(
        &mut self,
        camera: &CameraParameters,
        calibration_crc: u32,
        settings: &FlightSettings,
    ) -> Result<(), NotFlyable> {
        if let Mechanism::Tdi { .. } = camera.mechanism
            && !self.has_row_clock
        {
            return Err(NotFlyable::NoRowClock);
        }
        // A fault that nobody has cleared is not forgotten.
        if let Some(controller) = &self.controller {
            self.start = controller.next_start();
        }
        let controller = Controller::new(camera, calibration_crc, settings, self.start)
            .map_err(NotFlyable::Controller)?;
        self.drive
            .set_settings(settings.drive)
            .map_err(|error| NotFlyable::Controller(ControllerError::Settings(error)))?;
        self.controller = Some(controller);
        self.events.clear();
        self.known = InputLevels::GOOD;
        Ok(())
    }

    /// The camera's controller; `None` before it is prepared.
    #[must_use]
    pub const fn controller(&self) -> Option<&Controller> {
        self.controller.as_ref()
    }

    /// The same, to acknowledge records.
    pub const fn controller_mut(&mut self) -> Option<&mut Controller> {
        self.controller.as_mut()
    }

    /// Where the stage was in the last round, mm along the FMC axis from the encoder's zero; `None` without a reading.
    #[must_use]
    pub const fn offset_mm(&self) -> Option<f32> {
        self.offset_mm
    }

    /// Somebody says that something happens, now: a command, or what another instrument has measured.
    ///
    /// # Errors
    /// [`NotTaken`]; nothing has happened then.
    pub fn tell(&mut self, event: Event) -> Result<(), NotTaken> {
        if self.controller.is_none() {
            return Err(NotTaken::NotPrepared);
        }
        if !event.is_told() {
            return Err(NotTaken::NotTold);
        }
        self.events
            .offer(self.now, event)
            .map_err(|_| NotTaken::QueueFull)
    }
}

/// A board cannot fly a camera so.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotFlyable {
    /// The controller refuses calibration or settings, or the drive its settings.
    Controller(ControllerError),
    /// The sensor is TDI, and the board has no output that clocks its rows.
    NoRowClock,
}

impl fmt::Display for NotFlyable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Controller(error) => error.fmt(f),
            Self::NoRowClock => {
                f.write_str("the board has no output that clocks the rows of a TDI sensor")
            }
        }
    }
}

impl core::error::Error for NotFlyable {}

/// What a camera is told is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotTaken {
    /// It has not been prepared for flight.
    NotPrepared,
    /// It takes such an event from its own inputs alone ([`Event::is_told`]).
    NotTold,
    /// As many events wait for the control loop as can be kept.
    QueueFull,
}

impl fmt::Display for NotTaken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotPrepared => "the camera has not been prepared for flight",
            Self::NotTold => "the camera takes such an event from its own inputs alone",
            Self::QueueFull => "too many events wait for the control loop",
        })
    }
}

impl core::error::Error for NotTaken {}
