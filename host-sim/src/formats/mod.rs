//! File formats: flight settings, observations, points, output files.

pub mod frame_points;
pub mod npy_header;
pub mod observations;
pub mod output;
pub mod points;
