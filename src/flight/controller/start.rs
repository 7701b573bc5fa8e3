//! The start of a controller.

use super::Controller;
use super::aircraft::Aircraft;
use super::frame::FrameMachine;
use super::readiness::{Mode, Readiness};
use super::setup::Setup;
use super::stage::StageMachine;
use crate::flight::exposure::Limits;
use crate::flight::fault::{Fault, Faults};
use crate::flight::flown_calibrations::FlownCalibrations;
use crate::flight::lens_temperature::LensTemperature;
use crate::flight::vh::VhSettings;

/// Manner in which the camera came to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Start {
    /// The camera was switched on, or asked to start again.
    Orderly,
    /// The watchdog was not fed, or the processor failed.
    AfterWatchdog,
    /// As [`Self::Orderly`], but the encoder has lost its place.
    Unreferenced,
    /// A reset has ended the flight that is prepared now, and it goes on: as
    /// [`Self::AfterWatchdog`], but the fault ends by itself after a while, and triggers
    /// are obeyed without force on the stage.
    FliesOn,
}

impl Controller {
    /// Returns a controller that waits for its first flight.
    #[inline]
    pub(in crate::flight) const fn new() -> Self {
        Self {
            aircraft: Aircraft::new(VhSettings::DEFAULT, 0.0, 0.0, Limits::DEFAULT.vh_per_s),
            stage: StageMachine::new(false),
            frame: FrameMachine::new(),
            readiness: Readiness::new(Mode::Standby),
            exposure_s: 0.0,
            focus_shift_um: 0.0,
            temperature: LensTemperature::UNKNOWN,
            calibrations: FlownCalibrations::new(None),
            flight: 1,
        }
    }

    /// Sets the number of the flight that begins.
    pub(in crate::flight) const fn set_flight(&mut self, flight: u32) {
        self.flight = flight;
    }

    /// Begins a flight, in standby. After a bite of the watchdog it begins with that fault. The
    /// state of an earlier flight is overwritten in place: a controller is large, and a copy would
    /// take as much of the stack.
    #[inline(never)]
    pub(in crate::flight) fn restart(&mut self, setup: &Setup, start: Start) {
        let (mode, faults) = match start {
            Start::Orderly | Start::Unreferenced => (Mode::Standby, Faults::NONE),
            Start::AfterWatchdog | Start::FliesOn => {
                let mut faults = Faults::NONE;
                faults.insert(Fault::Watchdog);
                (Mode::Fault(Fault::Watchdog), faults)
            }
        };
        let Self {
            aircraft,
            stage,
            frame,
            readiness,
            exposure_s,
            focus_shift_um,
            temperature,
            calibrations,
            flight: _,
        } = self;
        restart_aircraft(aircraft, setup);
        restart_stage(stage, setup, start);
        frame.restart(faults);
        *readiness = Readiness::new(mode);
        if start == Start::FliesOn {
            readiness.fly_on();
        }
        *exposure_s = setup.settings.exposure_s;
        *focus_shift_um = 0.0;
        *temperature = LensTemperature::UNKNOWN;
        *calibrations = FlownCalibrations::new(setup.camera.id());
    }

    /// Returns the start of the controller that replaces this one; faults that have not been
    /// cleared are kept.
    #[must_use]
    pub fn next_start(&self) -> Start {
        match self.readiness.mode() {
            Mode::Fault(Fault::Watchdog) => Start::AfterWatchdog,
            _ if self.stage.is_place_lost() => Start::Unreferenced,
            _ => Start::Orderly,
        }
    }
}

/// Forgets the instruments. As with the stage, what takes its place is on the stack no longer than
/// this.
#[inline(never)]
fn restart_aircraft(aircraft: &mut Aircraft, setup: &Setup) {
    let settings = setup.settings;
    *aircraft = Aircraft::new(
        settings.vh,
        settings.time_pulse_sigma_s,
        settings.rate_sigma_deg_s,
        setup.camera.limits().vh_per_s,
    );
}

/// Forgets the stage. The encoder's count is lost with the processor. A camera without a stage
/// keeps that for the next one, whose stage may be on the same encoder.
#[inline(never)]
fn restart_stage(stage: &mut StageMachine, setup: &Setup, start: Start) {
    *stage = StageMachine::new(start != Start::Orderly);
    if setup.camera.has_stage() && setup.settings.drive.is_absolute() {
        stage.show_place(start == Start::FliesOn);
    }
}
