//! Description of a camera in its file: calibration, mechanism, shutter and limits in TOML.
//!
//! [`CameraFile`] holds the numbers as they are written, in double precision and in the units of
//! the file's keys. The validated [`Camera`](fmc_camera::flight::camera::Camera) that comes with it
//! has them in the camera's precision. An error names file, line, field, value and allowed range
//! ([`InputError`]); readers of other TOML files and of other formats can report errors in the same
//! words ([`toml_text`]).
//!
//! # Examples
//! ```
//! use fmc_camera_file::CameraFile;
//!
//! let text = "name = \"bare\"\nprincipal_distance_mm = 100.0\n\
//!             [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 10.0\n";
//! let (file, _) = CameraFile::parse("bare.toml", text).unwrap();
//! assert_eq!(file.sensor_from_pixel([9215.5, -0.5]), [46.08, 46.08]);
//! let error = CameraFile::parse("bare.toml", &text.replace("100.0", "-1.0")).unwrap_err();
//! assert!(error.to_string().starts_with("bare.toml, line 2: principal_distance_mm = -1.0"));
//! ```

#![forbid(unsafe_code)]

mod calibration_error;
mod camera;
#[cfg(test)]
mod document;
pub mod fitted_block;
pub mod flight_settings;
pub mod grid_block;
mod grid_files;
mod input_error;
mod insertion;
pub mod interior_text;
mod limits_table;
pub mod number;
pub mod published;
pub mod static_block;
mod strong_distortion;
mod tables;
pub mod text_file;
pub mod toml_text;

pub use camera::CameraFile;
pub use grid_files::{GridFiles, GridRefusal};
pub use input_error::{InputError, InputErrorKind, Place};
pub use limits_table::LimitsTable;
pub use tables::{
    Axis, DistortionTable, FittedTable, FmcTable, FocusTable, GridTable, MechanismName, Per,
    Profile, SensorTable, ShutterTable, Sign, Strategy,
};
