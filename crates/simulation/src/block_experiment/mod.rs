//! Simulated block of aerial images with the records of a camera whose detector moves, adjusted
//! with and without them.
//!
//! A run exposes every frame physically ([`crate::scene`]), with its run-up, light and wind, and
//! observes positions, attitudes and image points with errors. Ground frame: x along the strips, y
//! across, z up.

pub mod experiment;

pub mod flight_plan;
pub mod flown_block;
pub mod flown_image;
mod ground_points;
pub mod outcome;
mod planned_exposure;
pub mod scenario;
pub mod scenario_file;
mod scenario_range;
pub mod variant;
