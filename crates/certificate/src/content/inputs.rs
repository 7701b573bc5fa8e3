//! Inputs of a certificate.

use fmc_camera::flight::camera::Camera;
use fmc_camera_file::{CameraFile, GridFiles};
use fmc_reference::verification::result::CameraResult;

use crate::calibration_summary::CalibrationSummary;
use crate::details::Details;

/// Everything that a certificate is made of.
#[derive(Debug, Clone, Copy)]
pub struct Inputs<'a> {
    /// Name of the camera file, without folders.
    pub file_name: &'a str,
    /// Bytes of the camera file.
    pub bytes: &'a [u8],
    /// The camera file, read.
    pub camera: &'a CameraFile,
    /// Its residual grids.
    pub grids: &'a GridFiles,
    /// The same camera, validated, with the bounds of its grids.
    pub checked: &'a Camera,
    /// Details that no camera file has.
    pub details: &'a Details,
    /// Calibrations by which parameters were found.
    pub calibrations: &'a [CalibrationSummary],
    /// The camera's verification against the strict solver.
    pub verification: &'a CameraResult,
    /// Number of exposures of the verification that the camera refuses, and that are left out.
    pub forbidden: u64,
    /// Name and version of the program.
    pub software: &'a str,
    /// Device that computed the verification.
    pub device: &'a str,
    /// SHA-256 of the public key that signs; `None` without a signature.
    pub signing_key: Option<&'a str>,
}
