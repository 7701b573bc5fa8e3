//! Strict reference solver: the physics of the camera in double precision, by quadrature, without
//! code of the camera; and the comparison of a camera with it.
//!
//! Lengths are in mm in the sensor frame, distortions are measured - ideal.
//!
//! # Examples
//! ```
//! use fmc_camera_file::CameraFile;
//! use fmc_reference::exposure::ExposureRequest;
//! use fmc_reference::strict::{StrictSolver, Weight};
//!
//! let text = "name = \"bare\"\nprincipal_distance_mm = 100.0\n\
//!             [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 10.0\n\
//!             [distortion]\nk0 = 1e-4\n";
//! let (camera, _) = CameraFile::parse("bare.toml", text).unwrap();
//! // 100 mm x 0.1 1/s x 1/100 s: the principal point travels 100 µm, from -50 to 50 µm.
//! let solver = StrictSolver::new(&camera, &ExposureRequest::planned(0.1, 0.01), Weight::Exposure);
//! assert!((solver.path().travel_mm - 0.1).abs() < 1e-12);
//! // k0 alone is linear: the mean is the distortion at the mean position.
//! let mean = solver.mean([10.0, 20.0]);
//! assert!((mean.distortion_mm[0] - 1e-3).abs() < 1e-11 && (mean.distortion_mm[1] - 2e-3).abs() < 1e-11);
//! ```

#![forbid(unsafe_code)]

pub mod exposure;
pub mod fitted;
pub mod lens;
pub mod model_reference;
pub mod residual_spline;
pub mod residual_splines;
pub mod strict;
pub mod verification;
