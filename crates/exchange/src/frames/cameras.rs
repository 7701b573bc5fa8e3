//! Cameras of all images of a flight, for the writers of the files.

use std::io;

use super::image_camera::ImageCamera;
use super::image_names::ImageNames;
use crate::calibrated::Calibrated;
use crate::correction::Correction;
use crate::pinhole::Pinhole;

/// Cameras of the images as a program needs them: what the writers of the files share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cameras<'a> {
    pub(super) camera: &'a Calibrated,
    pub(super) model: &'static str,
    pub(super) frames: &'a [ImageCamera],
    pub(super) images: &'a ImageNames,
    /// The calibrated camera, for programs that distort rays.
    pub(super) at_rest: Pinhole,
    /// The calibrated camera without K0, for programs that correct measured points.
    pub(super) without_k0: Correction,
}

impl Cameras<'_> {
    pub(super) fn count(&self) -> u64 {
        self.frames.len() as u64
    }

    pub(super) fn pinhole(&self, frame: &ImageCamera) -> Pinhole {
        frame.pinhole(self.camera, &self.at_rest)
    }

    pub(super) fn correction(&self, frame: &ImageCamera) -> Correction {
        frame.correction(&self.without_k0)
    }

    /// Calls `each` with every frame and the name of its image.
    pub(super) fn each(
        &self,
        each: impl FnMut(&ImageCamera, &str) -> io::Result<()>,
    ) -> io::Result<()> {
        self.images.each(self.frames, each)
    }
}
