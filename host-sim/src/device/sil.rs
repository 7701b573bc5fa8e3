//! The camera's own code in this process.

use fmc_camera::flight::calibration_id::CalibrationId;
use fmc_camera::flight::camera::{Camera, CameraParameters, Frame};
use fmc_camera::flight::controller::{Controller, Start};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::gridded_frame::GriddedFrame;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::flight::rig::Rig;
use fmc_camera::geometry::exposure_distortion::ExposureDistortion;
use fmc_camera::geometry::frame_correction::{Corrected, FrameCorrection};
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::inverse::DistortSliceError;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::{CorrectionMesh, PixelCorrection};
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::instruments::Instruments;
use fmc_camera::io::link::digest;
use fmc_camera::io::link::message::Grid;

use fmc_camera_file::GridFiles;

use super::batch::PointBatch;
use super::held_grids::HeldGrids;
use super::{CorrectingDevice, Device, DeviceError, Evidence};

/// The camera in this process: the library that the firmware runs, called directly.
#[derive(Debug)]
pub struct InProcess {
    /// The camera, in flight or not.
    pub(super) rig: Rig,
    correction: Option<FrameCorrection>,
    /// Interior orientation of the current frame, if it was exposed here.
    interior: Option<InteriorOrientation>,
    grids: HeldGrids,
    evidence: Evidence,
    pub(super) instruments: Instruments,
}

impl Default for InProcess {
    fn default() -> Self {
        Self {
            rig: Rig::new(Start::Orderly),
            correction: None,
            interior: None,
            grids: HeldGrids::default(),
            evidence: Evidence::default(),
            instruments: Instruments::new(),
        }
    }
}

impl InProcess {
    /// Returns the digest of a grid of corrected points, as the link carries it.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::OffSensor`] for the first
    /// point off the sensor.
    pub fn digest(&self, grid: &Grid) -> Result<u32, DeviceError> {
        on_sensor(self.correction()?, grid.points())?;
        let gridded = self.gridded(|gridded| Ok(digest::of_grid(gridded, grid)));
        gridded.unwrap_or_else(|| Ok(digest::of_grid(self.correction()?, grid)))
    }

    /// Returns the identity of the camera that is loaded.
    pub(super) fn calibration(&self) -> Option<CalibrationId> {
        self.rig.camera().and_then(Camera::id)
    }

    /// Takes a frame that the camera computed before.
    pub(crate) fn correct_by(&mut self, frame: Frame) {
        self.correction = Some(frame.correction);
        self.interior = Some(frame.interior);
    }

    fn correction(&self) -> Result<&FrameCorrection, DeviceError> {
        self.correction.as_ref().ok_or(DeviceError::NoFrame)
    }

    /// Returns the answer of the frame with its grids; `None` for a camera without grids.
    fn gridded<T>(
        &self,
        answer: impl FnOnce(&GriddedCorrection<'_>) -> Result<T, DeviceError>,
    ) -> Option<Result<T, DeviceError>> {
        let grids = self.grids.in_use()?;
        let frame = || {
            Ok(Frame {
                interior: self.interior.ok_or(DeviceError::NoFrame)?,
                correction: *self.correction()?,
            })
        };
        Some(frame().and_then(|frame| answer(&GriddedFrame::new(&frame, &grids).correction)))
    }
}

impl CorrectingDevice for InProcess {
    type Error = DeviceError;

    fn description(&self) -> String {
        "sil (the camera's code in this process)".to_owned()
    }

    fn load(&mut self, camera: &CameraParameters) -> Result<(), DeviceError> {
        match self.rig.controller().map_or(0, Controller::kept) {
            0 => {}
            kept => return Err(DeviceError::RecordsKept(kept)),
        }
        let camera = self.grids.identify(camera)?;
        self.rig.load(camera);
        self.correction = None;
        Ok(())
    }

    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), DeviceError> {
        self.grids.load(grids)
    }

    fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, DeviceError> {
        let camera = self.rig.camera().ok_or(DeviceError::NoFrame)?;
        // Points that follow a refused exposure must not be corrected with the frame before it.
        self.correction = None;
        let frame = camera.frame(exposure).map_err(DeviceError::Frame)?;
        self.correction = Some(frame.correction);
        self.interior = Some(frame.interior);
        Ok(frame.interior)
    }

    fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError> {
        let correction = self.correction()?;
        if !PointBatch::all_on_sensor(correction, measured) {
            on_sensor(correction, measured.iter().copied())?;
        }
        let gridded = self.gridded(|gridded| {
            Ok(measured
                .iter()
                .map(|point| gridded.correct(*point))
                .collect::<Vec<_>>())
        });
        let corrected = match gridded {
            Some(corrected) => corrected?,
            None => PointBatch::new(correction).corrected(measured),
        };
        self.evidence.by_value += corrected.len() as u64;
        Ok(corrected)
    }

    fn evidence(&self) -> Evidence {
        self.evidence
    }
}

impl Device for InProcess {
    fn distort(&mut self, ideal: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError> {
        let gridded = self.gridded(|gridded| {
            let distort = |(index, point): (usize, &SensorPoint)| {
                let measured = gridded.distort(*point);
                measured.map_err(|error| DeviceError::Distort { index, error })
            };
            ideal.iter().enumerate().map(distort).collect()
        });
        if let Some(measured) = gridded {
            return measured;
        }
        let correction = self.correction()?;
        PointBatch::new(correction)
            .distorted(correction, ideal)
            .map_err(|DistortSliceError { index, error }| DeviceError::Distort { index, error })
    }

    fn mesh(&mut self, row: &VertexRow, format: MeshFormat) -> Result<Vec<u8>, DeviceError> {
        let gridded = self.gridded(|gridded| words(gridded, row, format));
        gridded.unwrap_or_else(|| words(self.correction()?, row, format))
    }

    fn corrections(&mut self, row: &VertexRow) -> Result<Vec<PixelCorrection>, DeviceError> {
        if self.grids.in_use().is_some() {
            return Err(DeviceError::PolynomialMesh);
        }
        let mesh = CorrectionMesh::new(self.correction()?, row.spacing_px);
        let mut corrections = vec![PixelCorrection::default(); usize::from(row.count)];
        row.corrections(&mesh, &mut corrections)
            .map_err(DeviceError::Mesh)?;
        Ok(corrections)
    }

    fn correction_here(&self) -> Option<&FrameCorrection> {
        self.correction
            .as_ref()
            .filter(|_| self.grids.in_use().is_none())
    }
}

/// Returns a row of sources as an engine stores it.
fn words<D: ExposureDistortion>(
    correction: &D,
    row: &VertexRow,
    format: MeshFormat,
) -> Result<Vec<u8>, DeviceError> {
    let mesh = SourceMesh::new(correction, row.spacing_px);
    let mut bytes = vec![0; usize::from(row.count) * format.bytes()];
    row.write_words(&mesh, format, &mut bytes)
        .map_err(DeviceError::Mesh)?;
    Ok(bytes)
}

/// Checks that all points are on the sensor, outside of which a correction has no meaning.
fn on_sensor(
    correction: &FrameCorrection,
    mut points: impl Iterator<Item = SensorPoint>,
) -> Result<(), DeviceError> {
    match points.position(|point| !correction.contains(point)) {
        Some(index) => Err(DeviceError::OffSensor { index }),
        None => Ok(()),
    }
}
