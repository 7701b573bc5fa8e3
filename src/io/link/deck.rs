//! Deck of the link: a camera on a test rig, or that of a board ([`FlownDeck`]).

use super::after_reset::AfterReset;
use super::digest;
use super::message::{self, FetchedRecord, Inputs, Refusal, Status};
use super::records_in_flash::RecordsInFlash;
use crate::flight::bring_up::Trial;
use crate::flight::calibration_id::CalibrationId;
use crate::flight::camera::{self, Camera};
use crate::flight::clock_drift::ClockDrift;
use crate::flight::controller::{Controller, ControllerError, NotExchanged, Start};
use crate::flight::drive::flown_drive::FlownDrive;
use crate::flight::event::Event;
use crate::flight::flown_deck::{FlownDeck, NotFlyable, NotTaken};
use crate::flight::frame_record::{FrameRecord, Outcome, Reason};
use crate::flight::input_levels::InputLevels;
use crate::flight::rig::{Rig, RigAnswer, RigStep};
use crate::flight::settings::FlightSettings;
use crate::io::instruments::{Instruments, Wire, WireBytes};

/// A camera that can be prepared for flight.
pub trait FlightDeck {
    /// Puts a camera in place of the one before. It has to be prepared before it flies; an earlier
    /// flight has ended, and its records are gone.
    fn load(&mut self, camera: Camera);

    /// Checks that a camera may take the place of the one before in its flight; without a flight it
    /// may.
    ///
    /// # Errors
    /// [`NotExchanged`].
    fn check_exchange(&self, camera: &Camera) -> Result<(), NotExchanged>;

    /// Puts a camera that has been [checked](Self::check_exchange) in place of the one before,
    /// between two frames of a flight, which goes on; without a flight as [`Self::load`].
    fn exchange(&mut self, camera: Camera);

    /// The camera, for all its users; `None` before one is loaded.
    fn camera(&self) -> Option<&Camera>;

    /// Prepares the loaded camera for flight. An earlier flight ends, and its records are gone.
    ///
    /// # Errors
    /// [`Refusal::NoCalibration`], [`Refusal::Settings`], [`Refusal::Travel`], and what the deck
    /// itself cannot do.
    fn prepare(&mut self, settings: &FlightSettings) -> Result<(), Refusal>;

    /// Prepares the loaded camera for the flight that it was prepared for before a reset; with
    /// `flies_on` it arms itself without force on the stage
    /// ([`Start::FliesOn`]).
    ///
    /// # Errors
    /// As [`Self::prepare`].
    fn prepare_after_reset(
        &mut self,
        settings: &FlightSettings,
        flies_on: bool,
    ) -> Result<(), Refusal>;

    /// Sets the number of the camera's start, and that of the last flight, from which it counts on.
    /// It comes before the first preparation.
    fn count_from(&mut self, boot: u32, flight: u32);

    /// Makes room for the records of a flight with this calibration that a reset has ended, in a
    /// camera that cannot be prepared for it again.
    fn hold_records(&mut self, calibration: CalibrationId);

    /// The controller that has records: that of the prepared camera, or the one that
    /// [holds](Self::hold_records) those of an earlier flight.
    fn record_holder(&self) -> Option<&Controller>;

    /// The same, for the acknowledgement of records.
    fn record_holder_mut(&mut self) -> Option<&mut Controller>;

    /// The camera's controller; `None` before it is prepared.
    fn controller(&self) -> Option<&Controller>;

    /// Position of the stage at its last reading, mm along the FMC axis from the encoder's zero,
    /// also while its place is lost; `None` on a test rig, or without a reading.
    fn offset_mm(&self) -> Option<f32>;

    /// Runs one round of the control loop, with the bytes on the wires of receiver and autopilot if
    /// `sent` is the number of bytes sent on them since the camera was prepared, and writes its
    /// outputs into an answer without actions; `None` for a camera that is not on a test rig.
    ///
    /// # Errors
    /// [`Refusal::OtherBytes`] if another number of bytes has come; nothing changes then.
    fn step(
        &mut self,
        step: &RigStep,
        sent: Option<WireBytes>,
        answer: &mut RigAnswer,
    ) -> Option<Result<(), Refusal>>;

    /// Returns `false` while the supply is low, also of a camera that is not prepared. A test rig
    /// that is not prepared knows of none.
    fn is_supply_good(&self) -> bool {
        self.controller().is_none_or(Controller::is_supply_good)
    }

    /// Drift of the clock by which the camera stamps, where it is told apart from the camera's
    /// time; `None` on a test rig, or before it is measured.
    fn clock_drift(&self) -> Option<ClockDrift> {
        None
    }

    /// The wires of receiver and autopilot; `None` for a camera without them.
    fn instruments(&self) -> Option<&Instruments> {
        None
    }

    /// Lines of the board; `None` on a test rig.
    fn inputs(&self) -> Option<Inputs> {
        None
    }

    /// Begins a trial of mechanism or shutter.
    ///
    /// # Errors
    /// [`Refusal::OnRig`] on a test rig; [`Refusal::NotTried`].
    fn try_out(&mut self, trial: Trial) -> Result<(), Refusal> {
        let _ = trial;
        Err(Refusal::OnRig)
    }

    /// Takes an event from a message, now.
    ///
    /// # Errors
    /// [`Refusal::OnRig`] on a test rig; [`Refusal::NotPrepared`]; [`Refusal::NotTold`] for an
    /// event that may not come in a message; [`Refusal::QueueFull`]; [`Refusal::Settings`] for a
    /// temperature out of range.
    fn tell(&mut self, event: Event) -> Result<(), Refusal>;
}

/// A test rig, with a camera or without.
#[derive(Debug)]
pub struct RigDeck {
    rig: Rig,
    /// `None` until the first preparation: a deck without contents costs no copy when it is moved.
    instruments: Option<Instruments>,
}

impl RigDeck {
    /// Returns a rig without a camera.
    #[must_use]
    pub const fn new(start: Start) -> Self {
        Self {
            rig: Rig::new(start),
            instruments: None,
        }
    }

    /// Returns a rig without a camera, whose encoder counts on through an orderly start.
    #[must_use]
    pub const fn after(start: message::ResetCause) -> Self {
        Self::new(start.counting_on())
    }

    /// Takes a byte that has come on a wire of the aircraft; ignored until the camera is prepared.
    pub fn hear(&mut self, wire: Wire, byte: u8) {
        if let Some(instruments) = &mut self.instruments {
            instruments.push(wire, byte);
        }
    }

    /// Counts bytes of a wire that were lost before they could be handed over.
    pub const fn count_lost(&mut self, wire: Wire, bytes: u32) {
        if let Some(instruments) = &mut self.instruments {
            instruments.count_lost(wire, bytes);
        }
    }
}

impl FlightDeck for RigDeck {
    fn load(&mut self, camera: Camera) {
        self.rig.load(camera);
    }

    fn check_exchange(&self, camera: &Camera) -> Result<(), NotExchanged> {
        self.rig.check_exchange(camera)
    }

    fn exchange(&mut self, camera: Camera) {
        self.rig.exchange(camera);
    }

    fn camera(&self) -> Option<&Camera> {
        self.rig.camera()
    }

    fn prepare(&mut self, settings: &FlightSettings) -> Result<(), Refusal> {
        self.rig.prepare(settings)?;
        self.instruments.get_or_insert_default().clear();
        Ok(())
    }

    fn prepare_after_reset(
        &mut self,
        settings: &FlightSettings,
        flies_on: bool,
    ) -> Result<(), Refusal> {
        self.rig.prepare_after_reset(settings, flies_on)?;
        self.instruments.get_or_insert_default().clear();
        Ok(())
    }

    fn count_from(&mut self, boot: u32, flight: u32) {
        self.rig.count_from(boot, flight);
    }

    fn hold_records(&mut self, calibration: CalibrationId) {
        self.rig.hold_records(calibration);
    }

    fn record_holder(&self) -> Option<&Controller> {
        self.rig.record_holder()
    }

    fn record_holder_mut(&mut self) -> Option<&mut Controller> {
        self.rig.record_holder_mut()
    }

    fn controller(&self) -> Option<&Controller> {
        self.rig.controller()
    }

    fn offset_mm(&self) -> Option<f32> {
        None
    }

    fn step(
        &mut self,
        step: &RigStep,
        sent: Option<WireBytes>,
        answer: &mut RigAnswer,
    ) -> Option<Result<(), Refusal>> {
        let (Some(_), Some(instruments)) = (self.rig.controller(), &mut self.instruments) else {
            return Some(Err(Refusal::NotPrepared));
        };
        let wired;
        let step = if let Some(sent) = sent {
            let received = instruments.received();
            if received != sent {
                return Some(Err(Refusal::OtherBytes(received)));
            }
            wired = instruments.wired(step);
            &wired
        } else {
            step
        };
        let stepped = self.rig.step_into(step, answer);
        Some(stepped.ok_or(Refusal::NotPrepared))
    }

    fn instruments(&self) -> Option<&Instruments> {
        self.instruments.as_ref()
    }

    fn tell(&mut self, _: Event) -> Result<(), Refusal> {
        Err(Refusal::OnRig)
    }
}

impl<Drive: FlownDrive> FlightDeck for FlownDeck<Drive> {
    fn load(&mut self, camera: Camera) {
        Self::load(self, camera);
    }

    fn check_exchange(&self, camera: &Camera) -> Result<(), NotExchanged> {
        Self::check_exchange(self, camera)
    }

    fn exchange(&mut self, camera: Camera) {
        Self::exchange(self, camera);
    }

    fn camera(&self) -> Option<&Camera> {
        self.camera()
    }

    fn prepare(&mut self, settings: &FlightSettings) -> Result<(), Refusal> {
        Ok(Self::prepare(self, settings)?)
    }

    fn prepare_after_reset(
        &mut self,
        settings: &FlightSettings,
        flies_on: bool,
    ) -> Result<(), Refusal> {
        Ok(Self::prepare_after_reset(self, settings, flies_on)?)
    }

    fn count_from(&mut self, boot: u32, flight: u32) {
        Self::count_from(self, boot, flight);
    }

    fn hold_records(&mut self, calibration: CalibrationId) {
        Self::hold_records(self, calibration);
    }

    fn record_holder(&self) -> Option<&Controller> {
        self.record_holder()
    }

    fn record_holder_mut(&mut self) -> Option<&mut Controller> {
        self.record_holder_mut()
    }

    fn is_supply_good(&self) -> bool {
        Self::is_supply_good(self)
    }

    fn controller(&self) -> Option<&Controller> {
        self.controller()
    }

    fn offset_mm(&self) -> Option<f32> {
        self.offset_mm()
    }

    fn clock_drift(&self) -> Option<ClockDrift> {
        self.clock_drift()
    }

    /// Returns `None`: the board has the time.
    fn step(
        &mut self,
        _: &RigStep,
        _: Option<WireBytes>,
        _: &mut RigAnswer,
    ) -> Option<Result<(), Refusal>> {
        None
    }

    fn inputs(&self) -> Option<Inputs> {
        let InputLevels {
            limit_low,
            limit_high,
            supply_low,
        } = self.seen();
        Some(Inputs {
            lines: self.lines(),
            limit_low,
            limit_high,
            supply_low,
            edges: self.edges(),
            offset_mm: self.offset_mm(),
            clock_drift: self.clock_drift(),
            trial: self.trial(),
        })
    }

    fn try_out(&mut self, trial: Trial) -> Result<(), Refusal> {
        Self::try_out(self, trial).map_err(Refusal::NotTried)
    }

    fn tell(&mut self, event: Event) -> Result<(), Refusal> {
        Self::tell(self, event).map_err(|error| match error {
            NotTaken::NotPrepared => Refusal::NotPrepared,
            NotTaken::NotTold => Refusal::NotTold,
            NotTaken::QueueFull => Refusal::QueueFull,
            NotTaken::OutOfRange(error) => Refusal::Settings(error),
        })
    }
}

impl From<NotFlyable> for Refusal {
    fn from(error: NotFlyable) -> Self {
        match error {
            NotFlyable::NoCamera => Self::NoCalibration,
            NotFlyable::Controller(error) => error.into(),
            NotFlyable::NoRowClock => Self::NoRowClock,
            NotFlyable::OtherDrive(asked) => Self::OtherDrive(asked),
        }
    }
}

impl From<ControllerError> for Refusal {
    fn from(error: ControllerError) -> Self {
        match error {
            ControllerError::Settings(error) => Self::Settings(error),
            ControllerError::Travel(error) => Self::Travel(error),
        }
    }
}

impl From<NotExchanged> for Refusal {
    fn from(error: NotExchanged) -> Self {
        match error {
            NotExchanged::FrameInFlight => Self::FrameInFlight,
            NotExchanged::RecordsKept(kept) => Self::RecordsKept(kept),
            NotExchanged::OtherMechanism => Self::OtherMechanism,
            NotExchanged::NotFlyable(error) => error.into(),
        }
    }
}

/// Prepares a deck, with its errors as refusals.
pub(super) fn prepare(
    deck: &mut impl FlightDeck,
    settings: &FlightSettings,
) -> Result<(), Refusal> {
    check_over(deck)?;
    deck.prepare(settings)
}

/// Checks that a flight may end: it is idle, and none of its records would be lost.
pub(super) fn check_over(deck: &impl FlightDeck) -> Result<(), Refusal> {
    check_idle(deck)?;
    match deck.record_holder().map_or(0, Controller::kept) {
        0 => Ok(()),
        kept => Err(Refusal::RecordsKept(kept)),
    }
}

/// Checks that a calibration may be put into use now: in the flight that is under way, or for
/// another, for which the flight may end.
pub(super) fn check_load(deck: &impl FlightDeck, keeps_flight: bool) -> Result<(), Refusal> {
    match deck.controller() {
        Some(controller) if keeps_flight => Ok(controller.check_exchange()?),
        _ => check_over(deck),
    }
}

/// Checks that no frame is in flight and the camera is not armed: otherwise calibration and
/// settings stay, and nothing is begun that lasts longer than a round.
pub(super) fn check_idle(deck: &impl FlightDeck) -> Result<(), Refusal> {
    match deck.controller() {
        Some(controller) if controller.is_busy() => Err(Refusal::FrameInFlight),
        _ => Ok(()),
    }
}

pub(super) fn record(deck: &impl FlightDeck, from: u32) -> Result<Option<FrameRecord>, Refusal> {
    let controller = deck.record_holder().ok_or(Refusal::NotPrepared)?;
    Ok(controller.record(from))
}

/// Forgets the records up to one that has been fetched; returns the number of those left.
///
/// Triggers that were refused for want of room have no contents of their own: once all other
/// records are forgotten, their number suffices, as the record of the last of them changes with the
/// next.
pub(super) fn acknowledge(
    deck: &mut impl FlightDeck,
    fetched: FetchedRecord,
) -> Result<u32, Refusal> {
    let controller = deck.record_holder_mut().ok_or(Refusal::NotPrepared)?;
    let FetchedRecord { sequence, crc } = fetched;
    let oldest = controller.record(0).filter(|it| it.sequence <= sequence);
    if let Some(oldest) = oldest {
        let last = controller.record(sequence);
        let is_fetched = last.is_some_and(|last| {
            let has_no_contents =
                |it: &FrameRecord| it.outcome == Outcome::Refused(Reason::RecordsFull);
            last.sequence == sequence
                && (digest::of_frame_record(&last) == Some(crc)
                    || has_no_contents(&oldest) && has_no_contents(&last))
        });
        if !is_fetched {
            return Err(Refusal::NotFetched { sequence });
        }
    }
    Ok(controller.acknowledge(sequence))
}

/// Status of the flight, or of a camera that holds the records of one; after this start, with
/// copies of the records in flash.
pub(super) fn status(
    deck: &impl FlightDeck,
    after_reset: AfterReset,
    in_flash: impl FnOnce(&Controller) -> RecordsInFlash,
) -> Result<Status, Refusal> {
    let holder = || deck.record_holder().filter(|holder| holder.kept() > 0);
    let controller = deck.controller().or_else(holder);
    let controller = controller.ok_or(Refusal::NotPrepared)?;
    Ok(Status {
        state: controller.state(),
        counts: controller.counts(),
        kept: controller.kept(),
        is_place_lost: controller.is_place_lost(),
        offset_mm: deck.offset_mm(),
        following_rms_um: controller.following_rms_um(),
        findings: *controller.findings(),
        last_finding: controller.last_finding(),
        clock_drift: clock_drift(deck, controller),
        calibration: controller.calibration(),
        index_mm: controller.index_mm(),
        in_doubt: controller.in_doubt(),
        after_reset,
        in_flash: in_flash(controller),
    })
}

/// Drift of the camera's clock, by the mean of many time pulses once there is one.
fn clock_drift(deck: &impl FlightDeck, controller: &Controller) -> Option<ClockDrift> {
    let of_clock = deck.clock_drift();
    match controller.time_drift_ppm() {
        Some(left_ppm) => {
            let corrected_ppm = of_clock.map_or(0.0, |drift| drift.corrected_ppm);
            Some(ClockDrift::after_correction(corrected_ppm, left_ppm))
        }
        None => of_clock,
    }
}

/// Number and frame of the last recorded exposure, for the correction of its points.
pub(super) fn latest(deck: &impl FlightDeck) -> Option<(u32, camera::Frame)> {
    deck.controller()?.latest().copied()
}
