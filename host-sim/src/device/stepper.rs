//! The camera in this process, with a stepper in place of a motor with an encoder.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::control_loop::ControlLoop;
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::drive::step_dir::{StepDir, StepPins};
use fmc_camera::flight::drive::step_settings::StepSettings;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::io::instruments::Instruments;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera_file::number::single;
use fmc_camera_file::{GridFiles, InputError};
use fmc_simulation::mission::clock::ROUND_US;
use fmc_simulation::mission::rig_camera::wired;
use fmc_simulation::mission::scenario::MissionScenario;
use fmc_simulation::mission::wire::WireTraffic;

use super::flying::not_prepared;
use super::held_grids::HeldGrids;
use super::{DeviceError, FlyingDevice};

/// A pin that others can see.
#[derive(Debug, Clone, Default)]
struct Wire(Rc<Cell<bool>>);

impl ErrorType for Wire {
    type Error = Infallible;
}

impl OutputPin for Wire {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set(true);
        Ok(())
    }
}

/// Limit switch that is never closed: the mission reports closed ones as events.
#[derive(Debug, Clone, Copy, Default)]
struct OpenSwitch;

impl ErrorType for OpenSwitch {
    type Error = Infallible;
}

impl InputPin for OpenSwitch {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(true)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(false)
    }
}

type Drive = StepDir<Wire, Wire, OpenSwitch, OpenSwitch>;

/// A camera whose stage is driven by a stepper.
#[derive(Debug)]
pub struct StepperCamera {
    settings: StepSettings,
    /// Pulses of the drive's timer in a round.
    pulses: u32,
    step: Wire,
    direction: Wire,
    control: Option<ControlLoop<Drive>>,
    steps: Vec<(f64, i8)>,
    grids: HeldGrids,
    instruments: Instruments,
}

impl StepperCamera {
    /// Creates the camera of a scenario; `None` if its stage has a motor with an encoder.
    ///
    /// # Errors
    /// [`InputError`] if the drive refuses the scenario's stepper.
    pub fn of(scenario: &MissionScenario) -> Result<Option<Self>, InputError> {
        let Some(stepper) = &scenario.written.mechanics.stepper else {
            return Ok(None);
        };
        let settings = StepSettings {
            steps_per_mm: single(stepper.steps_per_mm),
            pulse_rate_hz: single(stepper.pulse_rate_hz),
            max_step_rate_hz: single(stepper.max_step_rate_hz),
            ..StepSettings::default()
        };
        let settings = settings
            .checked()
            .map_err(|error| scenario.fault("mechanics.stepper", error))?;
        Ok(Some(Self {
            settings,
            pulses: pulses_of_round(stepper.pulse_rate_hz),
            step: Wire::default(),
            direction: Wire::default(),
            control: None,
            steps: Vec::new(),
            grids: HeldGrids::default(),
            instruments: Instruments::new(),
        }))
    }

    fn control(&mut self) -> Result<&mut ControlLoop<Drive>, DeviceError> {
        self.control.as_mut().ok_or(DeviceError::NotPrepared)
    }
}

/// Returns the number of pulses in a round of the control loop.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 1 to 1000"
)]
fn pulses_of_round(rate_hz: f64) -> u32 {
    (rate_hz * round_s()).round() as u32
}

#[expect(clippy::cast_precision_loss, reason = "a millisecond")]
fn round_s() -> f64 {
    ROUND_US as f64 * 1e-6
}

impl FlyingDevice for StepperCamera {
    type Error = DeviceError;

    fn description(&self) -> String {
        "sil with a stepper (the camera's code in this process)".to_owned()
    }

    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        let pins = StepPins {
            step: self.step.clone(),
            direction: self.direction.clone(),
            low: OpenSwitch,
            high: OpenSwitch,
        };
        let drive = StepDir::new(self.settings, pins).map_err(DeviceError::Settings)?;
        let camera = self.grids.identify(camera)?;
        let prepared =
            PreparedCamera::new(camera, settings, Start::Orderly).map_err(not_prepared)?;
        self.control = Some(ControlLoop::new(prepared, drive));
        self.instruments.clear();
        Ok(())
    }

    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), DeviceError> {
        self.grids.load(grids)
    }

    fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.control.as_ref()?.controller().setpoint(now)
    }

    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, DeviceError> {
        let pulses = self.pulses;
        let (step_pin, direction) = (self.step.clone(), self.direction.clone());
        let control = self.control()?;
        let actions = control.round(step.time, &step.events);
        let state = control.controller().state();
        let mut steps = Vec::new();
        for pulse in 0..pulses {
            let was_high = step_pin.0.get();
            control.drive_mut().pulse();
            if !was_high && step_pin.0.get() {
                let after_s = round_s() * f64::from(pulse) / f64::from(pulses);
                // Low is along the FMC axis.
                steps.push((after_s, if direction.0.get() { -1 } else { 1 }));
            }
        }
        self.steps.append(&mut steps);
        Ok(RigAnswer {
            duty: 0.0,
            powered: true,
            actions,
            state,
        })
    }

    fn step_with_wires(
        &mut self,
        step: &RigStep,
        traffic: &WireTraffic,
    ) -> Result<RigAnswer, DeviceError> {
        let step = wired(&mut self.instruments, step, traffic);
        self.step(&step)
    }

    fn instruments(&mut self) -> Result<InstrumentCounters, DeviceError> {
        Ok(self.instruments.counters())
    }

    fn steps(&mut self) -> Vec<(f64, i8)> {
        std::mem::take(&mut self.steps)
    }

    fn frame_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        Ok(self.control()?.controller().record(from_sequence))
    }

    fn acknowledge(&mut self, through: u32) -> Result<u32, DeviceError> {
        Ok(self.control()?.controller_mut().acknowledge(through))
    }
}
