//! A camera that stores its calibration.

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::io::link::message::Refusal;
use fmc_camera::io::store::{NothingStored, StoreOrder, StoredIdentity};
use fmc_camera_file::GridFiles;

use super::link_error::LinkError;
use super::port::Port;
use super::remote::Remote;
use super::{CorrectingDevice, DeviceError, RecordSource};

/// A camera that may have a store for its calibration.
pub trait KeepingCamera: CorrectingDevice<Error = DeviceError> {
    /// Sends a calibration with its residual grids, which is in use afterwards, also in a flight
    /// that the camera is prepared for.
    ///
    /// # Errors
    /// [`DeviceError`] where the camera refuses it.
    fn put_into_use(
        &mut self,
        camera: &CameraParameters,
        grids: &GridFiles,
    ) -> Result<(), DeviceError>;

    /// Lets the camera store the calibration in use, which has to be signed.
    ///
    /// # Errors
    /// [`DeviceError::RecordsKept`]; [`DeviceError::Link`] with every other refusal.
    fn store(&mut self, order: &StoreOrder) -> Result<StoredIdentity, DeviceError>;

    /// Returns what the camera has stored.
    ///
    /// # Errors
    /// [`DeviceError::Link`] for a camera without a store.
    fn stored(&mut self) -> Result<Result<StoredIdentity, NothingStored>, DeviceError>;
}

/// A camera behind a link, which may keep records and a calibration.
pub trait LinkedCamera: RecordSource + KeepingCamera {}

impl<C: RecordSource + KeepingCamera> LinkedCamera for C {}

impl<P: Port> KeepingCamera for Remote<P> {
    fn put_into_use(
        &mut self,
        camera: &CameraParameters,
        grids: &GridFiles,
    ) -> Result<(), DeviceError> {
        CorrectingDevice::load_grids(self, grids)?;
        self.load_in_both(camera, true)
    }

    fn store(&mut self, order: &StoreOrder) -> Result<StoredIdentity, DeviceError> {
        self.client.store(order).map_err(|error| match error {
            // It has no calibration, and nobody has asked for a frame.
            LinkError::Refused {
                refusal: Refusal::NoCalibration,
                ..
            } => self.of_link(error),
            _ => self.failed(error, 0),
        })
    }

    fn stored(&mut self) -> Result<Result<StoredIdentity, NothingStored>, DeviceError> {
        let stored = self.client.stored();
        stored.map_err(|error| self.of_link(error))
    }
}
