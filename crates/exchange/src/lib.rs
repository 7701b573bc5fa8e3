//! The calibration in the camera files of other programs, with the residual that each leaves.
//!
//! A file is written from the static interior orientation of a camera ([`calibrated::Calibrated`])
//! and read back before it is called written ([`export::export`]); a file that a program has
//! written becomes such an orientation again ([`import::import`]). Programs that correct measured
//! points hold the calibration exactly. Those that distort rays hold a least-squares fit
//! ([`fit::pinhole`]), whose residual over the sensor is stated.
//!
//! # Examples
//! ```
//! use fmc_camera_file::CameraFile;
//! use fmc_exchange::calibrated::Calibrated;
//! use fmc_exchange::export::{Choices, export};
//! use fmc_exchange::program::Program;
//!
//! let text = "name = \"K1 alone\"\nprincipal_distance_mm = 100.0\n\
//!             [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 10.0\n\
//!             [distortion]\nk1 = 1e-7\n";
//! let (file, _) = CameraFile::parse("k1.toml", text).unwrap();
//! let exported = export(&Calibrated::of(&file), Program::Colmap, &Choices::default()).unwrap();
//! assert_eq!(exported.files[0].0, "cameras.txt");
//! // 0.04 % of distortion: one coefficient suffices.
//! assert_eq!(exported.model, "SIMPLE_RADIAL");
//! assert!(exported.residual.largest_um < 0.1);
//! ```

#![forbid(unsafe_code)]

pub mod calibrated;
pub mod coefficient;
pub mod comparison;
pub mod correction;
pub mod decimal;
mod elements;
pub mod export;
mod fields;
pub mod fit;
pub mod found;
pub mod frames;
pub mod hand_over;
pub mod import;
mod inverse;
mod least_squares;
mod lines;
mod one_to_one;
pub mod pinhole;
pub mod program;
pub mod residual;
mod scalar;
pub mod source;
pub mod uncertainty;
