//! Rectification of frames: images of one ideal camera, without distortion and with the principal
//! point at one place, from images whose principal point moved during the exposure.
//!
//! A [`Rectification`] holds the places of all output pixels of one frame in its source image, as a
//! [mesh](mesh::Mesh) with a stated bound, and resamples them row by row from the few source rows
//! that a row needs.

#![forbid(unsafe_code)]

mod bound;
pub mod comparison;
mod fixed_point;
mod form;
mod matrix;
pub mod mesh;
mod mesh_error;
pub mod pattern;
mod placed_spline;
mod rectification;
mod spacing;
pub mod streaming;
pub mod truth;
mod vertices;
pub mod window;

pub use fmc_camera_kernel::resampling::{Band as SourceBand, Kernel as Resampling, Sample};
pub use rectification::{Rectification, RectificationError, Request, RowError};
pub use window::{Centre, Window, WindowError};
