//! Residual grids that a camera in this process holds, in the memory that the firmware has.

use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::grid_memory::GridMemory;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera::io::link::digest;
use fmc_camera_file::{GridFiles, GridRefusal};

use super::DeviceError;

/// Memory for residual grids.
#[derive(Debug)]
pub(super) struct HeldGrids(Box<GridMemory>);

impl Default for HeldGrids {
    fn default() -> Self {
        Self(Box::new(GridMemory::EMPTY))
    }
}

impl HeldGrids {
    /// Takes the grids of the camera that is loaded next.
    pub(super) fn load(&mut self, grids: &GridFiles) -> Result<(), DeviceError> {
        for carrier in [GridCarrier::Lens, GridCarrier::Sensor] {
            let Some(file) = grids.bytes(carrier) else {
                continue;
            };
            let buffer = self.0.spare_mut(carrier);
            buffer.clear();
            buffer
                .add(file)
                .and_then(|()| buffer.check())
                .map_err(|error| DeviceError::Grids(GridRefusal::File { carrier, error }))?;
        }
        Ok(())
    }

    /// Validates a camera, and puts the grids that it states into use.
    pub(super) fn identify(&mut self, camera: &CameraParameters) -> Result<Camera, DeviceError> {
        let crc = digest::of_camera(camera);
        let camera =
            Camera::identified(camera, crc, Storage::Volatile).map_err(DeviceError::Calibration)?;
        self.0.put_into_use(&camera)?;
        Ok(match self.in_use() {
            Some(grids) => camera.bounded_by(&grids),
            None => camera,
        })
    }

    /// Grids of the camera in use; `None` if it has none.
    pub(super) fn in_use(&self) -> Option<CameraGrids<'_>> {
        self.0.in_use()
    }
}
