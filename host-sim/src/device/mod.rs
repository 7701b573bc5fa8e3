//! The camera as host-sim uses it, on every kind of device.

mod batch;
pub mod block_port;
pub mod client;
mod client_bring_up;
mod client_flight;
mod client_frame;
mod client_store;
pub mod error;
pub mod flown_camera;
mod flying;
mod held_grids;
pub mod image;
pub mod keeping_camera;
pub mod link_error;
pub mod log;
pub mod machine;
mod name;
mod open;
pub mod port;
pub mod qemu;
pub mod record_source;
pub mod remote;
mod remote_flight;
pub mod serial;
pub mod serial_line;
pub mod served;
pub mod shared_memory;
mod sil;
pub mod tcp;
mod wires;

#[cfg(test)]
mod faulty_port;
#[cfg(test)]
mod link_tests;

use fmc_camera::geometry::frame_correction::{Corrected, FrameCorrection};
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;

pub use fmc_reference::verification::device::{CorrectingDevice, Evidence};
pub use fmc_simulation::mission::device::FlyingDevice;

pub(crate) use batch::PointBatch;
pub use error::DeviceError;
pub use flown_camera::FlownCamera;
pub use keeping_camera::{KeepingCamera, LinkedCamera};
pub use name::{DeviceName, Machine};
pub use open::{OpenError, Opener};
pub use record_source::RecordSource;
pub use sil::InProcess;

/// A camera that can be given a calibration, exposed, and asked for results that depend on the
/// exposure.
pub trait Device: CorrectingDevice<Error = DeviceError> {
    /// Distorts ideal points of the current frame, in order.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::Distort`] for the first
    /// point that has no measured point.
    fn distort(&mut self, ideal: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError>;

    /// Returns a row of a warp engine's mesh for the current frame, as the engine stores it; at
    /// most [`MAX_POINTS`](fmc_camera::io::link::MAX_POINTS) vertices.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::Mesh`] for the first
    /// vertex without a source, or with one that the format does not hold.
    fn mesh(&mut self, row: &VertexRow, format: MeshFormat) -> Result<Vec<u8>, DeviceError>;

    /// Returns the displacements with which the vertices of a row of the recorded image are to be
    /// drawn, corrected - recorded, for the current frame; at most
    /// [`MAX_POINTS`](fmc_camera::io::link::MAX_POINTS).
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::Mesh`] for the first
    /// vertex off the image.
    fn corrections(&mut self, row: &VertexRow) -> Result<Vec<PixelCorrection>, DeviceError>;

    /// Returns the correction of the current frame if the camera is in this process, where several
    /// threads may compute with it; `None` for others, before the first exposure,
    /// and for a camera with residual grids.
    fn correction_here(&self) -> Option<&FrameCorrection> {
        None
    }
}
