#![no_std]
#![forbid(unsafe_code)]
// rustdoc takes the first of two definitions of a link: here the README's links lead to modules.
#![doc = include_str!("readme_links.md")]
#![doc = include_str!("../README.md")]

#[cfg(test)]
extern crate std;

/// Compiles the code of the integration guide.
#[cfg(all(doctest, feature = "link"))]
#[doc = include_str!("../docs/integration.md")]
pub mod integration {}

#[cfg(doc)]
pub mod docs;
pub mod flight;
pub mod geometry;
pub mod io;

pub use flight::camera::{Camera, CameraParameters, Frame};
pub use flight::exposure::{CorrectionModel, Exposure};
pub use geometry::brown::Brown;
pub use geometry::calibration::{Calibration, CalibrationParameters};
pub use geometry::frame_correction::FrameCorrection;
pub use geometry::sensor::SensorPoint;
