//! Images with known truth, and the differences of images: the proof of `rectify`.

pub(super) mod compare;
mod image_difference;
pub(super) mod render;
mod scaled_camera;
mod scene;
pub(super) mod verification;
pub(super) mod written;
