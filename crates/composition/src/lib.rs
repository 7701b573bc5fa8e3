//! Virtual images of a camera of several detectors behind one lens: radiometry, calibration of the
//! rig from control and ties, seams, registration to a camera of one detector, and a stereo check.
//!
//! The way is that of Zhao et al. 2013 for the DMZ camera, beside one that keeps relief out of the
//! camera: `docs/composition.md` has both. A [`Scene`](scene::Scene) is a synthetic camera whose
//! truth is known.
//!
//! # Frames
//! Sub-images, virtual image: columns to the right, rows downwards, the centre of the first pixel
//! at (0, 0). Ground: X east, Y north, Z up, metres. Orientations as in [`fmc_adjustment`].

#![forbid(unsafe_code)]

pub mod image;
pub mod mosaic;
mod number;
pub mod radiometry;
pub mod rig;
pub mod scene;
pub mod stereo;

pub use number::{grey, median, real, rms};
