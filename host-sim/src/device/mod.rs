//! The camera as host-sim sees it, wherever it runs.

mod batch;
pub mod client;
mod client_flight;
pub mod error;
pub mod flown_camera;
pub mod flying;
pub mod image;
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
mod sil;

#[cfg(test)]
mod faulty_port;
#[cfg(test)]
mod link_tests;

use fmc_camera::flight::camera::CameraRecord;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::message::{Counters, Grid};

pub use error::DeviceError;
pub use flown_camera::FlownCamera;
pub use flying::FlyingDevice;
pub use name::{DeviceName, Machine};
pub use open::{OpenError, Opener};
pub use record_source::RecordSource;
pub use sil::InProcess;

/// A camera that can be given a calibration, exposed, and asked to correct points.
pub trait Device: Send {
    /// What it is, for the first line of a report.
    fn description(&self) -> String;

    /// Replaces the camera's calibration, mechanism, shutter and limits.
    ///
    /// # Errors
    /// [`DeviceError::Calibration`] where the camera refuses it; the previous one stays.
    fn load(&mut self, camera: &CameraRecord) -> Result<(), DeviceError>;

    /// Predicts a frame; the points that follow belong to it.
    ///
    /// # Errors
    /// [`DeviceError::Frame`] where the camera refuses the exposure.
    fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, DeviceError>;

    /// Corrects measured points of the current frame, in order.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::OffSensor`] for the first
    /// point that is.
    fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError>;

    /// Distorts ideal points of the current frame, in order.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::Distort`] for the first
    /// point that has no measured point.
    fn distort(&mut self, ideal: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError>;

    /// Corrects a whole grid of measured points of the current frame. Over a link a digest shows
    /// that every point has the bits which the same code computes on this PC, and a sample of them
    /// is compared by value.
    ///
    /// # Errors
    /// As [`Self::correct`]; [`DeviceError::Different`] where a point has other bits.
    fn correct_grid(&mut self, grid: &Grid) -> Result<Vec<Corrected>, DeviceError> {
        self.correct(&grid.points().collect::<Vec<_>>())
    }

    /// A row of a warp engine's mesh for the current frame, as the engine stores it; at most
    /// [`MAX_POINTS`](fmc_camera::io::link::MAX_POINTS) vertices.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::Mesh`] for the first vertex without a
    /// source, or with one that the format does not hold.
    fn mesh(&mut self, row: &VertexRow, format: MeshFormat) -> Result<Vec<u8>, DeviceError>;

    /// Where the vertices of a row of the recorded image are to be drawn, corrected - recorded, for the current frame; at
    /// most [`MAX_POINTS`](fmc_camera::io::link::MAX_POINTS).
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::Mesh`] for the first vertex off the image.
    fn corrections(&mut self, row: &VertexRow) -> Result<Vec<PixelCorrection>, DeviceError>;

    /// How the points answered so far are known to be the camera's.
    fn evidence(&self) -> Evidence;

    /// What the camera's end of the link has seen since it started; nothing where there is no link.
    ///
    /// # Errors
    /// [`DeviceError::Link`].
    fn counters(&mut self) -> Result<Option<Counters>, DeviceError> {
        Ok(None)
    }
}

/// How points are known to be the camera's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Evidence {
    /// Points shown by a digest of the camera to have the bits computed here.
    pub by_digest: u64,
    /// Points that the camera itself answered.
    pub by_value: u64,
}
