//! File formats: flight settings, observations, points, output files.

pub mod calibration_points;
pub mod flight_records;
pub mod frame_points;
pub mod named_columns;
pub mod network_tables;
pub mod npy_header;
pub mod observations;
pub mod orientation;
pub mod output;
pub mod points;
