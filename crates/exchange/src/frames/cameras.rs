//! Cameras of all images of a flight, for the writers of the files.

use std::io;

use super::image_camera::ImageCamera;
use super::image_names::ImageNames;
use super::pose::ImagePose;
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
    /// Poses by sequence number; `None` without a trajectory.
    pub(super) poses: Option<&'a [(u32, ImagePose)]>,
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

    /// Returns the pose of a frame, if it has one.
    pub(super) fn pose(&self, frame: &ImageCamera) -> Option<&ImagePose> {
        let poses = self.poses?;
        let place = poses.binary_search_by_key(&frame.sequence, |(sequence, _)| *sequence);
        poses.get(place.ok()?).map(|(_, pose)| pose)
    }

    /// Number of frames that have a place in a file of poses: without a trajectory all of them.
    pub(super) fn posed(&self) -> u64 {
        self.poses.map_or(self.count(), |poses| poses.len() as u64)
    }

    /// Calls `each` with every frame and the name of its image.
    pub(super) fn each(
        &self,
        each: impl FnMut(&ImageCamera, &str) -> io::Result<()>,
    ) -> io::Result<()> {
        self.images.each(self.frames, each)
    }
}
