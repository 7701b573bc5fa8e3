//! The camera of a board: its drive moves a stage, its events come from wires and from messages.

use core::fmt;

use super::bring_up::trials::Trials;
use super::bring_up::{EdgeCounts, LineLevels, NotTried, Trial, TrialEnd, TrialReport};
#[cfg(feature = "link")]
use super::calibration_id::CalibrationId;
use super::camera::Camera;
use super::camera_slot::CameraSlot;
pub use super::camera_slot::NotFlyable;
use super::clock_drift::ClockDrift;
use super::control_loop::{self, RoundActions};
use super::controller::state::State;
use super::controller::{Controller, NotExchanged, Start};
use super::drive::StageReading;
use super::drive::flown_drive::FlownDrive;
use super::event::{Action, Command, Event, Supply};
use super::event_queue::EventQueue;
use super::fault::Fault;
use super::input_levels::InputLevels;
use super::input_settings::InputSettings;
use super::settings::FlightSettings;
use super::time::Time;
use crate::geometry::range::{OutOfRange, Quantity};

/// A camera that moves a stage, with one drive for all cameras that are loaded and all flights they
/// are prepared for.
///
/// It has no clock: the board sets the time, with every round and before [`Self::tell`], so that an
/// event that it is told gets the time of its arrival.
///
/// Every millisecond the board passes the stamps of the interrupts to [`Self::capture`] and the
/// levels of the lines to [`Self::see`], and then calls [`Self::round`]. Until the camera is
/// prepared it only reads the stage, and drops all events.
#[derive(Debug)]
pub struct FlownDeck<Drive> {
    drive: Drive,
    camera: CameraSlot,
    events: EventQueue,
    /// Levels of the lines that the controller knows of.
    known: InputLevels,
    /// Levels of the lines in the last round.
    seen: InputLevels,
    /// Position of the stage in the last round.
    offset_mm: Option<f32>,
    now: Time,
    /// Drift of the board's clock, by the board.
    clock_drift: Option<ClockDrift>,
    /// Settings of the board's lines that it has not taken yet.
    inputs: Option<InputSettings>,
    has_row_clock: bool,
    /// Levels of all lines, by the board; `None` for one that does not tell them.
    lines: Option<LineLevels>,
    edges: EdgeCounts,
    trials: Trials,
}

impl<Drive: FlownDrive> FlownDeck<Drive> {
    /// A board without a camera. After [`Start::Unreferenced`] its encoder counts from wherever the
    /// stage stands: before it compensates the operator has to refer it
    /// ([`Command::Referenced`]).
    #[must_use]
    pub const fn new(drive: Drive, start: Start) -> Self {
        Self {
            drive,
            camera: CameraSlot::new(start),
            events: EventQueue::new(),
            known: InputLevels::GOOD,
            seen: InputLevels::GOOD,
            offset_mm: None,
            now: Time::START,
            clock_drift: None,
            inputs: None,
            has_row_clock: false,
            lines: None,
            edges: EdgeCounts {
                trigger: 0,
                time_pulse: 0,
                shutter_opened: 0,
                shutter_closed: 0,
                index: 0,
                lost: 0,
            },
            trials: Trials::NONE,
        }
    }

    /// Returns the same camera, for a board that carries out [`Action::ClockRows`]; any other board
    /// refuses a TDI camera.
    #[must_use]
    pub fn with_row_clock(self) -> Self {
        Self {
            has_row_clock: true,
            ..self
        }
    }

    /// Sets the time; it never goes back.
    pub fn set_now(&mut self, now: Time) {
        self.now = self.now.max(now);
    }

    /// Adds an event of a wire, at a time that may be somewhat before now. If there is no place for
    /// it, it is counted ([`EventQueue`]).
    pub fn capture(&mut self, time: Time, event: Event) {
        self.edges.count(event);
        if self.controller().is_some() {
            self.events.push(time, event);
        }
    }

    /// Takes the drift of the clock by which the board stamps, from which the time it sets is
    /// corrected already.
    pub const fn note_clock(&mut self, drift: Option<ClockDrift>) {
        self.clock_drift = drift;
    }

    /// Counts edges that were lost before they could be handed over.
    pub fn count_lost(&mut self, edges: u32) {
        self.edges.lost = self.edges.lost.saturating_add(edges);
        if self.controller().is_some() {
            self.events.count_lost(edges);
        }
    }

    /// Takes the present levels of the lines, once a round. Changes become events, and so does
    /// everything that is wrong when a camera is prepared. When faults are cleared, a limit switch
    /// that is still closed becomes an event again.
    ///
    /// A switch counts as closed, or open, after two rounds in a row say so, so that a spike on its
    /// line does not end a flight. By the second round the stage is 50 µm farther at 50 mm/s.
    pub fn see(&mut self, levels: InputLevels) {
        let before = core::mem::replace(&mut self.seen, levels);
        if self.controller().is_none() {
            return;
        }
        let levels = levels.with_steady_limits(&before, &self.known);
        if levels.has_closed_since(&self.known)
            && self.events.offer(self.now, Event::LimitSwitch).is_err()
        {
            // The event is offered again in the next round.
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

    /// Returns `false` if the supply was low in the last round, or is by the events of a prepared
    /// camera.
    #[must_use]
    pub fn is_supply_good(&self) -> bool {
        let is_told_good = self.controller().is_none_or(Controller::is_supply_good);
        !self.seen.supply_low && is_told_good
    }

    /// Runs a round of the control loop. On return the stage has its command; the other actions are
    /// left to the board.
    pub fn round(&mut self, now: Time) -> RoundActions {
        let reading = self.read_stage(now);
        self.round_from(now, reading)
    }

    /// As [`Self::round`], after the stage has been read at `now`: the stage moves on while other
    /// work of the round is done.
    pub(crate) fn round_from(
        &mut self,
        now: Time,
        mut reading: Result<StageReading, Fault>,
    ) -> RoundActions {
        self.set_now(now);
        self.offset_mm = reading.ok().map(|reading| reading.offset_mm);
        let mut outside = RoundActions::new();
        if self.trials.take_close() {
            // There is room for it, as for that of a trial.
            let _ = outside.push(Action::CloseShutter);
        }
        let Some((setup, controller)) = self.camera.flown() else {
            // The position is for display.
            if self.drive.take_index().is_some() {
                self.edges.index = self.edges.index.saturating_add(1);
            }
            let action = self.trials.round(&mut self.drive, now, reading, &self.seen);
            if let Some(action) = action {
                let _ = outside.push(action);
            }
            return outside;
        };
        let events = self.events.take(now);
        // The command is the first event of a round, or not among them.
        if let Some((_, Event::Command(Command::Referenced))) = events.first()
            && controller.state() == State::Standby
        {
            self.drive.set_reference();
            reading = self.drive.position(now);
            self.offset_mm = reading.ok().map(|reading| reading.offset_mm);
        }
        if events
            .iter()
            .any(|(_, event)| *event == Event::Command(Command::ClearFault))
        {
            // A switch that is still closed, or whose wire is broken, becomes an event again.
            self.known = InputLevels {
                supply_low: self.known.supply_low,
                ..InputLevels::GOOD
            };
        }
        let flown = (&setup, controller);
        control_loop::round(flown, &mut self.drive, now, reading, &events, &mut outside);
        outside
    }

    /// Reads the stage, for [`Self::round_from`].
    pub(crate) fn read_stage(&mut self, now: Time) -> Result<StageReading, Fault> {
        self.drive.position(now)
    }

    /// Takes the levels of all lines, for their display alone.
    pub const fn note_lines(&mut self, lines: LineLevels) {
        self.lines = Some(lines);
    }

    /// Levels of all lines by the last [note](Self::note_lines); `None` without.
    #[must_use]
    pub const fn lines(&self) -> Option<LineLevels> {
        self.lines
    }

    /// Counts of the edges since the start.
    #[must_use]
    pub const fn edges(&self) -> EdgeCounts {
        self.edges
    }

    /// Levels of switches and supply in the last round.
    #[must_use]
    pub const fn seen(&self) -> InputLevels {
        self.seen
    }

    /// Begins a trial of mechanism or shutter with the next round, on a camera that is not
    /// prepared. For jog and duty the drive takes its default settings, with
    /// [`MAX_DUTY`](super::bring_up::MAX_DUTY), until a camera is prepared.
    ///
    /// # Errors
    /// [`NotTried`]; nothing moves then.
    pub fn try_out(&mut self, trial: Trial) -> Result<(), NotTried> {
        if self.controller().is_some() {
            return Err(NotTried::Prepared);
        }
        self.trials
            .begin(trial, &mut self.drive, self.offset_mm, &self.seen)
    }

    /// The last trial, which may be under way; `None` before the first.
    #[must_use]
    pub const fn trial(&self) -> Option<TrialReport> {
        self.trials.report()
    }

    /// The drive.
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The drive.
    pub const fn drive_mut(&mut self) -> &mut Drive {
        &mut self.drive
    }

    /// Puts a camera in place of the one before, with the force off the stage. It has to be
    /// prepared before it flies; an earlier flight has ended, and its records are gone.
    pub fn load(&mut self, camera: Camera) {
        self.camera.load(camera);
        self.trials.end(TrialEnd::Loaded);
        self.drive.release();
        self.events.clear();
    }

    /// Checks that a camera may take the place of the one before in its flight
    /// ([`Self::exchange`]); without a flight it may.
    ///
    /// # Errors
    /// [`NotExchanged`].
    pub fn check_exchange(&self, camera: &Camera) -> Result<(), NotExchanged> {
        self.camera.check_exchange(camera)
    }

    /// Puts a camera that has been [checked](Self::check_exchange) in place of the one before,
    /// between two frames. The flight goes on: samples, UTC, counts and records stay, and each
    /// record names the calibration it was made with. Without a flight as [`Self::load`].
    pub fn exchange(&mut self, camera: Camera) {
        if self.controller().is_some() {
            self.camera.exchange(camera);
        } else {
            self.load(camera);
        }
    }

    /// The camera; `None` before one is loaded.
    #[must_use]
    pub fn camera(&self) -> Option<&Camera> {
        self.camera.camera()
    }

    /// Prepares the loaded camera for flight. An earlier flight ends, and its records are gone.
    ///
    /// # Errors
    /// [`NotFlyable`]; an earlier flight goes on then.
    pub fn prepare(&mut self, settings: &FlightSettings) -> Result<(), NotFlyable> {
        self.check_board(settings)?;
        let drive = &mut self.drive;
        self.camera
            .prepare(settings, |settings| drive.set_settings(settings))?;
        self.begin(settings);
        Ok(())
    }

    /// As [`Self::prepare`], for the flight that a reset has ended.
    #[cfg(feature = "link")]
    pub(crate) fn prepare_after_reset(
        &mut self,
        settings: &FlightSettings,
        flies_on: bool,
    ) -> Result<(), NotFlyable> {
        self.check_board(settings)?;
        let drive = &mut self.drive;
        let set_drive = |settings| drive.set_settings(settings);
        let camera = &mut self.camera;
        camera.prepare_after_reset(settings, flies_on, set_drive)?;
        self.begin(settings);
        Ok(())
    }

    /// Checks that the board can clock the rows of a TDI sensor, or move the stage's mechanism,
    /// whichever the camera has.
    fn check_board(&self, settings: &FlightSettings) -> Result<(), NotFlyable> {
        let Some(camera) = self.camera() else {
            return Ok(());
        };
        let kind = settings.drive.kind;
        if camera.has_stage() {
            if !self.drive.is_of(kind) {
                return Err(NotFlyable::OtherDrive(kind));
            }
        } else if !self.has_row_clock {
            return Err(NotFlyable::NoRowClock);
        }
        Ok(())
    }

    /// Begins a flight.
    fn begin(&mut self, settings: &FlightSettings) {
        self.trials.end(TrialEnd::Loaded);
        self.events.clear();
        self.known = InputLevels::GOOD;
        self.inputs = Some(settings.inputs);
    }

    /// Sets the number of the camera's start and of its last flight.
    #[cfg(feature = "link")]
    pub(crate) const fn count_from(&mut self, boot: u32, flight: u32) {
        self.camera.count_from(boot, flight);
    }

    /// Makes room for the records of a flight that a reset has ended, in a camera that cannot be
    /// prepared for it again.
    #[cfg(feature = "link")]
    pub(crate) fn hold_records(&mut self, calibration: CalibrationId) {
        self.camera.hold_records(calibration);
    }

    /// The controller that has records, of a camera that is prepared or not.
    #[cfg(feature = "link")]
    pub(crate) fn record_holder(&self) -> Option<&Controller> {
        self.camera.record_holder()
    }

    /// The same, to acknowledge records.
    #[cfg(feature = "link")]
    pub(crate) fn record_holder_mut(&mut self) -> Option<&mut Controller> {
        self.camera.record_holder_mut()
    }

    /// Returns the settings of the board's lines after each [`Self::prepare`], once: the board
    /// takes them over before the next round.
    #[must_use]
    pub const fn take_inputs(&mut self) -> Option<InputSettings> {
        self.inputs.take()
    }

    /// The camera's controller; `None` before it is prepared.
    #[must_use]
    pub fn controller(&self) -> Option<&Controller> {
        self.camera.controller()
    }

    /// The camera's controller, for the acknowledgement of records.
    pub fn controller_mut(&mut self) -> Option<&mut Controller> {
        self.camera.controller_mut()
    }

    /// Drift of the board's clock; `None` before it is [noted](Self::note_clock).
    #[must_use]
    pub const fn clock_drift(&self) -> Option<ClockDrift> {
        self.clock_drift
    }

    /// Position of the stage in the last round, mm along the FMC axis from the encoder's zero;
    /// `None` without a reading.
    #[must_use]
    pub const fn offset_mm(&self) -> Option<f32> {
        self.offset_mm
    }

    /// Takes an event from a message, now: a command, or the measurement of another instrument.
    ///
    /// # Errors
    /// [`NotTaken`]; the event is dropped then.
    pub fn tell(&mut self, event: Event) -> Result<(), NotTaken> {
        self.tell_at(self.now, event)
    }

    /// Takes an event that an instrument has measured shortly before now.
    ///
    /// # Errors
    /// As [`Self::tell`].
    pub fn tell_at(&mut self, time: Time, event: Event) -> Result<(), NotTaken> {
        if self.controller().is_none() {
            return Err(NotTaken::NotPrepared);
        }
        if !event.is_told() {
            return Err(NotTaken::NotTold);
        }
        if let Event::Command(Command::Temperature(celsius)) = event {
            let checked = Quantity::TemperatureC.check(celsius);
            checked.map_err(NotTaken::OutOfRange)?;
        }
        self.events
            .offer(time, event)
            .map_err(|_| NotTaken::QueueFull)
    }
}

/// The reason why a camera does not take an event from a message.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotTaken {
    /// The camera has not been prepared for flight.
    NotPrepared,
    /// The camera takes such an event from its own inputs alone ([`Event::is_told`]).
    NotTold,
    /// The queue of the control loop has no place for another event of this kind.
    QueueFull,
    /// A temperature is not a number or out of range.
    OutOfRange(OutOfRange),
}

impl fmt::Display for NotTaken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotPrepared => "the camera has not been prepared for flight",
            Self::NotTold => "the camera takes such an event from its own inputs alone",
            Self::QueueFull => "too many events wait for the control loop",
            Self::OutOfRange(error) => return error.fmt(f),
        })
    }
}

impl core::error::Error for NotTaken {}
