//! The counterpart of `fmc-camera` on the PC: strict reference solver, verification,
//! calibration, and the client of the camera.

pub mod cli;
pub mod command;
pub mod device;
pub mod failure;
pub mod formats;
