//! A camera that moves a stage of its own: its time and its events are not this program's.

use fmc_camera::flight::camera::CameraRecord;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::link::message::Status;

use super::port::Port;
use super::remote::Remote;
use super::{CorrectingDevice, DeviceError};

/// A camera on a board.
pub trait FlownCamera {
    /// Gives it calibration and settings; it is in standby.
    ///
    /// # Errors
    /// [`DeviceError`] where it refuses them, or still has records that nobody has fetched.
    fn prepare(
        &mut self,
        camera: &CameraRecord,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError>;

    /// Something happens, now.
    ///
    /// # Errors
    /// [`DeviceError`] where it refuses to be told, as one on a test rig does.
    fn tell(&mut self, event: Event) -> Result<(), DeviceError>;

    /// What it is doing.
    ///
    /// # Errors
    /// [`DeviceError::NotPrepared`] before it is.
    fn status(&mut self) -> Result<Status, DeviceError>;
}

impl<P: Port> FlownCamera for Remote<P> {
    fn prepare(
        &mut self,
        camera: &CameraRecord,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        CorrectingDevice::load(self, camera)?;
        self.client
            .prepare(settings)
            .map_err(|error| self.failed(error, 0))
    }

    fn tell(&mut self, event: Event) -> Result<(), DeviceError> {
        self.client
            .tell(event)
            .map_err(|error| self.failed(error, 0))
    }

    fn status(&mut self) -> Result<Status, DeviceError> {
        self.client.status().map_err(|error| self.failed(error, 0))
    }
}
