//! Frames of a flight, in place of one exposure.

mod active_frame;
mod coordinate_sigma;
mod evaluator;
pub(super) mod frame_file;
pub(super) mod list;
pub(super) mod meshes;
mod orientation_columns;
pub(super) mod orientations;
pub(super) mod points;

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use fmc_camera_file::{CameraFile, InputError};
use fmc_frames::table::{self, GivenExposure};
use fmc_frames::{FlightFrame, FrameCamera, FrameTable, ImageMap, records};

use crate::cli::{DeviceArgs, ExposureArgs, FramesArgs, TrajectoryArgs};
use crate::device::DeviceName;
use crate::failure::Failure;
use crate::formats::output;

/// The file of the frames of a flight, and their camera.
pub(super) struct FlightFile<'a> {
    pub(super) file: CameraFile,
    pub(super) camera: FrameCamera,
    exposure: &'a ExposureArgs,
    frames: &'a FramesArgs,
    images: Option<ImageMap>,
    /// False if answers go to a terminal while the frames are read: no bar may stand there then.
    answers_elsewhere: bool,
}

impl<'a> FlightFile<'a> {
    /// Reads camera file and images.
    ///
    /// # Errors
    /// [`Failure`] of the camera file and of the images, or for a device: frames are computed here.
    pub(super) fn open(
        exposure: &'a ExposureArgs,
        frames: &'a FramesArgs,
        device: &DeviceArgs,
    ) -> Result<Self, Failure> {
        check_device(device)?;
        let (file, grids) = exposure.read_camera_with_grids()?;
        let name = exposure.camera.display().to_string();
        Ok(Self {
            camera: FrameCamera::with_grids(&name, &file, grids)?,
            images: frames.images.as_deref().map(ImageMap::read).transpose()?,
            file,
            exposure,
            frames,
            answers_elsewhere: true,
        })
    }

    /// Name of the file of frames in messages.
    pub(super) fn name(&self) -> String {
        let path = self.frames.records.as_ref().or(self.frames.frames.as_ref());
        path.map(|path| path.display().to_string())
            .unwrap_or_default()
    }

    /// Refuses to replace a file of frames by an answer.
    fn check_out(&self, out: Option<&Path>) -> Result<(), Failure> {
        output::check_not_the_input(out, &self.exposure.camera)?;
        self.frames.check_out(out)
    }

    /// Reads the frames, with their images.
    ///
    /// # Errors
    /// Those of the file of frames and of `each`, and [`InputError`] for an image whose frame does
    /// not exist.
    pub(super) fn read<E: From<InputError>>(
        &self,
        mut each: impl FnMut(FlightFrame) -> Result<(), E>,
    ) -> Result<(), E> {
        let images = self.images.as_ref();
        let mut unnamed: BTreeSet<u32> =
            images.map_or_else(BTreeSet::new, |map| map.sequences().into_iter().collect());
        let with_image = |mut frame: FlightFrame| {
            if let Some(images) = images {
                frame.image = images.image(frame.sequence).map(str::to_owned);
                unnamed.remove(&frame.sequence);
            }
            each(frame)
        };
        match (&self.frames.records, &self.frames.frames) {
            (Some(path), _) => {
                frame_file::with_bar(path, self.answers_elsewhere, |name, source| {
                    records::read_from(name, source, &self.camera, with_image)
                })
            }
            (None, Some(path)) => {
                let given = self.exposure.given();
                frame_file::with_bar(path, self.answers_elsewhere, |name, source| {
                    table::read_from(name, source, &self.camera, &given, with_image)
                })
            }
            (None, None) => Ok(()),
        }?;
        match (unnamed.first(), &self.frames.images) {
            (Some(sequence), Some(path)) => Err(InputError::invalid(format!(
                "{}: sequence {sequence} is not in {}",
                path.display(),
                self.name()
            ))
            .into()),
            _ => Ok(()),
        }
    }
}

/// The frames of a flight in memory, and their camera.
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
    /// Those of [`FlightFile`].
    fn read(flight: FlightFile) -> Result<Self, Failure> {
        let table = FrameTable::collect(|each| flight.read(each))?;
        Ok(Self {
            table: Arc::new(table),
            name: flight.name(),
            file: flight.file,
            camera: flight.camera,
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
    /// Returns the values of the options, for the exposures of a table.
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

impl TrajectoryArgs {
    /// Refuses to replace a file of the trajectory by an answer, and both answers by each other.
    fn check_out(&self, out: Option<&Path>) -> Result<(), Failure> {
        let table = self.orientation.as_deref();
        for answer in [out, table].into_iter().flatten() {
            let inputs = [&self.trajectory, &self.trajectory_accuracy];
            inputs
                .into_iter()
                .flatten()
                .try_for_each(|input| output::check_not_an_input(answer, input))?;
        }
        if out
            .zip(table)
            .is_some_and(|(out, table)| output::name_the_same(out, table))
        {
            return Err(Failure::bad_input(
                "--orientation and --out name the same file",
            ));
        }
        Ok(())
    }
}

impl FramesArgs {
    /// Refuses to replace a file of frames by an answer.
    fn check_out(&self, out: Option<&Path>) -> Result<(), Failure> {
        let inputs = [&self.records, &self.frames, &self.images];
        match out {
            Some(out) => inputs
                .into_iter()
                .flatten()
                .try_for_each(|input| output::check_not_an_input(out, input)),
            None => Ok(()),
        }
    }
}
