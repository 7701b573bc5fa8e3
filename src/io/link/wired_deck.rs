//! The camera of a board to which wires of receiver and autopilot lead.

use super::deck::FlightDeck;
use super::message::{Inputs, Refusal};
use crate::flight::bring_up::Trial;
use crate::flight::calibration_id::CalibrationId;
use crate::flight::camera::Camera;
use crate::flight::clock_drift::ClockDrift;
use crate::flight::control_loop::RoundActions;
use crate::flight::controller::{Controller, NotExchanged};
use crate::flight::drive::flown_drive::FlownDrive;
use crate::flight::event::Event;
use crate::flight::flown_deck::FlownDeck;
use crate::flight::rig::{RigAnswer, RigStep};
use crate::flight::settings::FlightSettings;
use crate::flight::time::Time;
use crate::io::instruments::{Instruments, Wire, WireBytes};

/// Events of the instruments in one round, as many as the queue of events keeps samples of V/H.
const EVENTS_OF_A_ROUND: usize = 4;

/// A [`FlownDeck`] with its instruments.
#[derive(Debug)]
pub struct WiredDeck<Drive> {
    flown: FlownDeck<Drive>,
    instruments: Instruments,
}

impl<Drive: FlownDrive> WiredDeck<Drive> {
    /// Returns a camera that has not been prepared, its wires silent.
    #[must_use]
    pub const fn new(flown: FlownDeck<Drive>, instruments: Instruments) -> Self {
        Self { flown, instruments }
    }

    /// The camera without its wires, for the handover of edges and levels.
    pub const fn flown_mut(&mut self) -> &mut FlownDeck<Drive> {
        &mut self.flown
    }

    /// Takes a byte that has come on a wire of the aircraft.
    pub fn hear(&mut self, wire: Wire, byte: u8) {
        self.instruments.push(wire, byte);
    }

    /// Counts bytes of a wire that were lost before they could be handed over.
    pub const fn count_lost(&mut self, wire: Wire, bytes: u32) {
        self.instruments.count_lost(wire, bytes);
    }

    /// Runs one round of the control loop, as [`FlownDeck::round`], with the events of the wires.
    pub fn round(&mut self, now: Time) -> RoundActions {
        let reading = self.flown.read_stage(now);
        for &(time, event) in &self.instruments.round(now, EVENTS_OF_A_ROUND) {
            if self.flown.controller().is_some() && self.flown.tell_at(time, event).is_err() {
                self.instruments.count_crowded_out();
            }
        }
        self.flown.round_from(now, reading)
    }
}

impl<Drive: FlownDrive> FlightDeck for WiredDeck<Drive> {
    fn load(&mut self, camera: Camera) {
        FlightDeck::load(&mut self.flown, camera);
    }

    fn check_exchange(&self, camera: &Camera) -> Result<(), NotExchanged> {
        self.flown.check_exchange(camera)
    }

    fn exchange(&mut self, camera: Camera) {
        self.flown.exchange(camera);
    }

    fn camera(&self) -> Option<&Camera> {
        FlightDeck::camera(&self.flown)
    }

    fn prepare(&mut self, settings: &FlightSettings) -> Result<(), Refusal> {
        FlightDeck::prepare(&mut self.flown, settings)?;
        self.instruments.clear();
        Ok(())
    }

    fn prepare_after_reset(
        &mut self,
        settings: &FlightSettings,
        flies_on: bool,
    ) -> Result<(), Refusal> {
        FlightDeck::prepare_after_reset(&mut self.flown, settings, flies_on)?;
        self.instruments.clear();
        Ok(())
    }

    fn count_from(&mut self, boot: u32, flight: u32) {
        self.flown.count_from(boot, flight);
    }

    fn hold_records(&mut self, calibration: CalibrationId) {
        self.flown.hold_records(calibration);
    }

    fn record_holder(&self) -> Option<&Controller> {
        self.flown.record_holder()
    }

    fn record_holder_mut(&mut self) -> Option<&mut Controller> {
        self.flown.record_holder_mut()
    }

    fn controller(&self) -> Option<&Controller> {
        self.flown.controller()
    }

    fn offset_mm(&self) -> Option<f32> {
        self.flown.offset_mm()
    }

    fn is_supply_good(&self) -> bool {
        self.flown.is_supply_good()
    }

    fn clock_drift(&self) -> Option<ClockDrift> {
        self.flown.clock_drift()
    }

    /// Returns `None`: the camera has its own time.
    fn step(
        &mut self,
        _: &RigStep,
        _: Option<WireBytes>,
        _: &mut RigAnswer,
    ) -> Option<Result<(), Refusal>> {
        None
    }

    fn instruments(&self) -> Option<&Instruments> {
        Some(&self.instruments)
    }

    fn inputs(&self) -> Option<Inputs> {
        FlightDeck::inputs(&self.flown)
    }

    fn try_out(&mut self, trial: Trial) -> Result<(), Refusal> {
        FlightDeck::try_out(&mut self.flown, trial)
    }

    fn tell(&mut self, event: Event) -> Result<(), Refusal> {
        FlightDeck::tell(&mut self.flown, event)
    }
}
