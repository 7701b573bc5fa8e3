//! What is read and written: camera files, points, numbers, output files.

pub mod camera_error;
pub mod camera_file;
pub mod number;
pub mod output;
pub mod points;
pub mod published;
