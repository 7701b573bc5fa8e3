//! The counterpart of `fmc-camera` on the PC: strict reference solver, verification,
//! calibration, and the client of the camera.

pub mod budget;
pub mod cli;
pub mod command;
pub mod device;
pub mod failure;
pub mod flight;
pub mod formats;
pub mod mechanics;
pub mod mission;
pub mod noise;
pub mod report;
pub mod scene;
pub mod smear;
pub mod sweep;
