//! Frames of a flight: what their records, or a table of exposures, say of each of them.
//!
//! A [`FlightFrame`] is one trigger: its interior orientation with the times and σ that belong to
//! it, or the reason why it was refused. Records are read as a stream ([`records::read`]), from
//! `records.csv` and `records.json` alike; a table of exposures ([`table::read`]) stands for them
//! where no camera flew. [`Exposed::correction`] returns the correction of a frame's points, with
//! the bits that the camera itself computed.
//!
//! A [`trajectory::Trajectory`] adds the exterior orientation at the centroid of each exposure.
//!
//! Inputs are checked against the camera file: a record of another calibration, a number outside
//! its range or a sequence that comes twice is an error that names file, line, column, value and
//! allowed range.

#![forbid(unsafe_code)]

mod calibration_covariance;
mod check;
mod columns;
mod frame;
mod frame_camera;
mod frame_table;
mod image_map;
mod lens_parameter;
mod lines;
mod pixel_covariance;
mod placed_frame;
pub mod record_files;
pub mod records;
pub mod row;
mod sequences;
pub mod source;
pub mod table;
pub mod time;
pub mod trajectory;

pub use calibration_covariance::CalibrationCovariance;
pub use frame::{Exposed, FlightFrame, Outcome};
pub use frame_camera::FrameCamera;
pub use frame_table::{FrameRow, FrameTable};
pub use image_map::ImageMap;
pub use lines::Lines;
pub use placed_frame::PlacedFrame;
