//! What is read and written: scenarios, observations, points, output files.

pub mod flight_settings;
mod mission_fault;
pub mod mission_file;
mod mission_range;
pub mod mission_scenario;
pub mod npy_header;
pub mod observations;
pub mod output;
pub mod points;
pub mod scenario;
mod scenario_range;
