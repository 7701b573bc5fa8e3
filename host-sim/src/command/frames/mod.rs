//! Frames of a flight, in place of one exposure.

mod active_frame;
mod coordinate_sigma;
mod evaluator;
pub(super) mod list;
pub(super) mod meshes;
pub(super) mod points;

use std::sync::Arc;

use fmc_camera_file::CameraFile;
use fmc_frames::table::{self, GivenExposure};
use fmc_frames::{FrameCamera, FrameTable, ImageMap, Images, records};

use crate::cli::{DeviceArgs, ExposureArgs, FramesArgs};
use crate::device::DeviceName;
use crate::failure::Failure;

/// The frames of a flight, and their camera.
pub(super) struct Flight {
    pub(super) file: CameraFile,
    pub(super) camera: FrameCamera,
    pub(super) table: Arc<FrameTable>,
    /// Name of the file of frames in messages.
    pub(super) name: String,
}

impl Flight {
    /// Reads the frames that are asked for.
    ///
    /// # Errors
    /// [`Failure`] of the camera file, of the frames, or for a device: frames are computed here.
    pub(super) fn read(
        exposure: &ExposureArgs,
        frames: &FramesArgs,
        device: &DeviceArgs,
    ) -> Result<Self, Failure> {
        check_device(device)?;
        let file = exposure.read_camera()?;
        let camera = FrameCamera::new(&exposure.camera.display().to_string(), &file)?;
        let map = frames.images.as_deref().map(ImageMap::read).transpose()?;
        let images = map.as_ref().map_or(Images::OfFrames, Images::Map);
        let (table, name) = match (&frames.records, &frames.frames) {
            (Some(path), _) => {
                let table = FrameTable::collect(images, |each| records::read(path, &camera, each));
                (table?, path.display().to_string())
            }
            (None, Some(path)) => {
                let given = exposure.given();
                let table =
                    FrameTable::collect(images, |each| table::read(path, &camera, &given, each));
                (table?, path.display().to_string())
            }
            (None, None) => return Err(Failure::bad_input("--records or --frames is missing")),
        };
        if let Some(map) = map {
            let unknown = map
                .sequences()
                .into_iter()
                .find(|one| table.find(*one).is_none());
            if let (Some(sequence), Some(path)) = (unknown, &frames.images) {
                return Err(Failure::bad_input(format!(
                    "{}: sequence {sequence} is not in {name}",
                    path.display()
                )));
            }
        }
        Ok(Self {
            file,
            camera,
            table: Arc::new(table),
            name,
        })
    }
}

fn check_device(device: &DeviceArgs) -> Result<(), Failure> {
    match &device.device {
        None | Some(DeviceName::Sil) => Ok(()),
        Some(_) => Err(Failure::bad_input(
            "--device: frames of a flight are computed in this program, with the bits of the camera; only sil is possible",
        )),
    }
}

impl ExposureArgs {
    /// What the options say of the exposures of a table.
    fn given(&self) -> GivenExposure {
        let exposure = self.exposure();
        GivenExposure {
            vh_per_s: self.vh.given(),
            exposure_s: self.exposure,
            opening_offset_mm: self.opening_offset_mm,
            focus_shift_um: self.focus_shift_um,
            focus_sign: exposure.focus_sign,
            model: exposure.model,
            direction: exposure.direction,
        }
    }
}
