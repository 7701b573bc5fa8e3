//! A simulated flight over ground control: Yuan et al. 2012, section 4.2, and beyond it.
//!
//! # Frames
//! Ground frame: X east, Y north, Z up, metres. Camera frame: x right, y forward, optical axis -z,
//! origin in the projection centre. Angles in radians unless a name says otherwise. The order of the
//! rotations is stated at [`ExteriorOrientation`](exterior_orientation::ExteriorOrientation).

pub mod adjustment;
pub mod collinearity;
pub mod correction;
pub mod experiment;
pub mod exterior_orientation;
pub mod ground_error;
pub mod image_truth;
pub mod interior_orientation;
pub mod model;
pub mod normal_equations;
pub mod outcome;
pub mod separability;
pub mod statistics;
pub mod strip;
pub mod survey;
pub mod terrain;
