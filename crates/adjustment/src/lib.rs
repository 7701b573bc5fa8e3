//! Least squares of photogrammetry: exterior orientations and self-calibration of frames over
//! ground control, and the [`calibration`] of the five-coefficient model from observed distortions.
//!
//! # Frames
//! Ground frame: X east, Y north, Z up, metres. Camera frame: x right, y forward, optical axis -z,
//! origin in the projection centre. Angles in radians unless a name says otherwise. The order of
//! the rotations is stated at [`ExteriorOrientation`](exterior_orientation::ExteriorOrientation).

#![forbid(unsafe_code)]

pub mod adjustment;
pub mod bundle;
pub mod calibration;
pub mod collinearity;
pub mod correction;
pub mod exterior_orientation;
pub mod field_angles;
pub mod frame_observation;
pub mod grid;
pub mod interior_orientation;
pub mod linear;
pub mod model;
pub mod observation;
pub mod separability;
pub mod statistics;
