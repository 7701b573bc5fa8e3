//! Frames of a flight for programs that take a camera per image.
//!
//! A frame is the calibrated camera with the principal point of its record and, by the focus shift,
//! with F(1 + κ): lens and distortion move together over the detector. So the calibrated camera is
//! fitted once, and every frame is that fit, moved ([`ImageCamera::pinhole`]).

mod cameras;
mod colmap;
mod export;
mod flight;
mod image_camera;
mod image_names;
mod json;
mod metashape;
mod pose;
mod tables;

pub use export::FlightExport;
pub use flight::{Flight, ONE_CAMERA_PX, OneCamera, Refused};
pub use image_camera::ImageCamera;
pub use image_names::{ImageNames, PATTERN, Pattern};
pub use pose::{ImagePose, PoseSigma};
