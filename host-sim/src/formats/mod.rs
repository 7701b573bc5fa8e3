//! What is read and written: camera files, points, numbers, output files.

pub mod camera_error;
pub mod camera_file;
pub mod fitted_block;
pub mod flight_settings;
mod mission_fault;
pub mod mission_file;
mod mission_range;
pub mod mission_scenario;
pub mod npy_header;
pub mod number;
pub mod observations;
pub mod output;
pub mod points;
pub mod published;
pub mod scenario;
mod scenario_range;
