//! A source of the records of a camera that has flown.

use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::io::link::message::Status;

use super::DeviceError;
use super::flown_camera::FlownCamera;
use super::port::Port;
use super::qemu::Qemu;
use super::remote::Remote;

/// A camera with records.
pub trait RecordSource {
    /// Returns the oldest record with at least that number that has not been acknowledged.
    ///
    /// # Errors
    /// [`DeviceError`] where the link fails, and for a record that does not have its CRC.
    fn fetch(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError>;

    /// Returns the status of the camera: its calibration, and exposures in doubt.
    ///
    /// # Errors
    /// [`DeviceError`] where the link fails, or before the camera is prepared.
    fn flight_status(&mut self) -> Result<Status, DeviceError>;

    /// Tells the camera that records up to that number are stored, so that it may forget them.
    /// Returns how many are left.
    ///
    /// # Errors
    /// [`DeviceError`] where the link fails, and for a record that was not fetched.
    fn are_safe(&mut self, through: u32) -> Result<u32, DeviceError>;
}

impl<P: Port> RecordSource for Remote<P> {
    fn fetch(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        self.fetch_record(from_sequence)
    }

    fn flight_status(&mut self) -> Result<Status, DeviceError> {
        self.status()
    }

    fn are_safe(&mut self, through: u32) -> Result<u32, DeviceError> {
        self.acknowledge_records(through)
    }
}

impl RecordSource for Qemu {
    fn fetch(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        self.remote_mut().fetch(from_sequence)
    }

    fn flight_status(&mut self) -> Result<Status, DeviceError> {
        self.remote_mut().flight_status()
    }

    fn are_safe(&mut self, through: u32) -> Result<u32, DeviceError> {
        self.remote_mut().are_safe(through)
    }
}
