//! Simulated strip over ground control: Yuan et al. 2012, section 4.2, and beyond it.
//!
//! Ground and camera frames are those of [`fmc_adjustment`].

pub mod experiment;
pub mod ground_error;
pub mod image_truth;
pub mod outcome;
pub mod scenario;
pub mod scenario_file;
mod scenario_range;
pub mod strip;
pub mod survey;
pub mod terrain;
