//! The rig: places of the sub-images in the virtual image, and their calibration.

pub mod calibration;
pub mod control;
mod description;
pub(crate) mod gauge;
mod green;
mod normals;
pub mod polynomial;
pub(crate) mod start;

pub use description::{CalibrationTable, Heights, Rig, SubImage, VirtualSize};
pub use gauge::Movement;
pub use green::{Distortion, Green};
