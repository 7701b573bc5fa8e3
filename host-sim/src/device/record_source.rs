//! A camera that has recorded exposures, whoever flew it.

use fmc_camera::flight::frame_record::FrameRecord;

use super::DeviceError;
use super::port::Port;
use super::qemu::Qemu;
use super::remote::Remote;

/// A camera with records.
pub trait RecordSource {
    /// The oldest record with at least that number that has not been acknowledged.
    ///
    /// # Errors
    /// [`DeviceError`] where it cannot be talked to, and for a record that does not have its CRC.
    fn fetch(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError>;

    /// Records up to that number are safe; the camera may forget them. Says how many are left.
    ///
    /// # Errors
    /// [`DeviceError`] where it cannot be talked to.
    fn are_safe(&mut self, through: u32) -> Result<u32, DeviceError>;
}

impl<P: Port> RecordSource for Remote<P> {
    fn fetch(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        self.fetch_record(from_sequence)
    }

    fn are_safe(&mut self, through: u32) -> Result<u32, DeviceError> {
        self.acknowledge_records(through)
    }
}

impl RecordSource for Qemu {
    fn fetch(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        self.remote_mut().fetch(from_sequence)
    }

    fn are_safe(&mut self, through: u32) -> Result<u32, DeviceError> {
        self.remote_mut().are_safe(through)
    }
}
