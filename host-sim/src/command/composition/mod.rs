//! Cameras of several detectors: a synthetic one, radiometry, rig and virtual image.

pub(super) mod dmz;
mod files;
mod preview;
pub(super) mod radiometry;
pub(super) mod rig;
pub(super) mod scene;
pub(super) mod stereo;
pub(super) mod virtual_image;
