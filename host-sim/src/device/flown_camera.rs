//! A camera that moves its own stage, in real time and with real events.

use fmc_camera::flight::bring_up::Trial;
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera::io::link::message::{Inputs, Refusal, Status};
use fmc_camera_file::GridFiles;

use super::link_error::LinkError;
use super::port::Port;
use super::remote::Remote;
use super::{CorrectingDevice, DeviceError};

/// A camera on a board.
pub trait FlownCamera {
    /// Gives the camera the residual grids of the calibration that is sent next.
    ///
    /// # Errors
    /// [`DeviceError`] for a damaged grid.
    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), DeviceError>;

    /// Sends calibration and settings; the camera is in standby afterwards.
    ///
    /// # Errors
    /// [`DeviceError`] where it refuses them, or still has records that have not been fetched.
    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError>;

    /// Sends another calibration for the flight that is under way, which goes on.
    ///
    /// # Errors
    /// [`DeviceError`] where the camera refuses it; the one before stays then.
    fn recalibrate(&mut self, camera: &CameraParameters) -> Result<(), DeviceError>;

    /// Tells the camera that something happens now.
    ///
    /// # Errors
    /// [`DeviceError`] where it refuses the event, as a camera on a test rig does.
    fn tell(&mut self, event: Event) -> Result<(), DeviceError>;

    /// Returns the camera's status.
    ///
    /// # Errors
    /// [`DeviceError::NotPrepared`] before the camera is prepared.
    fn status(&mut self) -> Result<Status, DeviceError>;

    /// Returns the counts of the camera's wires of receiver and autopilot; `None` for a camera
    /// without them.
    ///
    /// # Errors
    /// [`DeviceError`] if the link fails.
    fn instruments(&mut self) -> Result<Option<InstrumentCounters>, DeviceError>;

    /// Returns levels of the board's lines, counts of their edges, and the last trial.
    ///
    /// # Errors
    /// [`DeviceError::Link`] for a camera on a test rig.
    fn inputs(&mut self) -> Result<Inputs, DeviceError>;

    /// Begins a trial of mechanism or shutter.
    ///
    /// # Errors
    /// [`DeviceError::Link`] with the camera's refusal.
    fn try_out(&mut self, trial: Trial) -> Result<(), DeviceError>;
}

impl<P: Port> FlownCamera for Remote<P> {
    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), DeviceError> {
        CorrectingDevice::load_grids(self, grids)
    }

    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        CorrectingDevice::load(self, camera)?;
        self.client
            .prepare(settings)
            .map_err(|error| self.failed(error, 0))
    }

    fn recalibrate(&mut self, camera: &CameraParameters) -> Result<(), DeviceError> {
        self.load_in_both(camera, true)
    }

    fn tell(&mut self, event: Event) -> Result<(), DeviceError> {
        self.client
            .tell(event)
            .map_err(|error| self.failed(error, 0))
    }

    fn status(&mut self) -> Result<Status, DeviceError> {
        self.client.status().map_err(|error| self.failed(error, 0))
    }

    fn instruments(&mut self) -> Result<Option<InstrumentCounters>, DeviceError> {
        match self.client.instruments() {
            Ok(counters) => Ok(Some(counters)),
            // Unknown: its firmware is older than the request.
            Err(LinkError::Refused {
                refusal: Refusal::NoInstruments | Refusal::Unknown,
                ..
            }) => Ok(None),
            Err(error) => Err(self.failed(error, 0)),
        }
    }

    fn inputs(&mut self) -> Result<Inputs, DeviceError> {
        self.client.inputs().map_err(|error| self.of_link(error))
    }

    fn try_out(&mut self, trial: Trial) -> Result<(), DeviceError> {
        let begun = self.client.try_out(trial);
        begun.map_err(|error| self.of_link(error))
    }
}
