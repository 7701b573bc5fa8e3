//! Content of a certificate: what `certificate.json` has, and what the pages are set from.

pub mod distortion;
pub mod exchange;
pub mod identity;
pub mod motion;
pub mod observed;
pub mod parameters;
pub mod proof;
pub mod radial;

use fmc_camera::flight::camera::Camera;
use fmc_camera_file::{CameraFile, InputError};
use fmc_reference::verification::result::CameraResult;
use serde::Serialize;

use crate::calibration_summary::CalibrationSummary;
use crate::details::Details;
use distortion::StaticDistortion;
use exchange::ExchangeLine;
use identity::Identity;
use motion::Motion;
use parameters::ParameterSection;
use proof::Proof;

/// Everything that a certificate is made of.
#[derive(Debug, Clone, Copy)]
pub struct Inputs<'a> {
    /// Name of the camera file, without folders.
    pub file_name: &'a str,
    /// Bytes of the camera file.
    pub bytes: &'a [u8],
    /// The camera file, read.
    pub camera: &'a CameraFile,
    /// The same, validated by the camera.
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

/// The content. What is not known is `null`, and printed as "not stated"; keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// Format of this file.
    pub format: &'static str,
    /// Who, what and when.
    pub identity: Identity,
    /// Conventions of the numbers, in sentences.
    pub conventions: [String; 4],
    /// Parameters and how they were found.
    pub parameters: ParameterSection,
    /// Distortion of the camera at rest.
    pub static_distortion: StaticDistortion,
    /// Motion of the principal point, and what it does.
    pub motion: Motion,
    /// Comparison of the camera with the strict solver.
    pub proof: Proof,
    /// Residual in the files of other programs.
    pub exchange: Vec<ExchangeLine>,
}

impl Certificate {
    /// Computes the content.
    ///
    /// # Errors
    /// [`InputError`] for details or calibrations that contradict the camera file.
    pub fn new(inputs: &Inputs<'_>) -> Result<Self, InputError> {
        let parameters = ParameterSection::new(inputs)?;
        Ok(Self {
            format: "fmc-certificate 1",
            identity: Identity::new(inputs)?,
            conventions: identity::conventions(inputs.camera),
            static_distortion: StaticDistortion::new(inputs),
            motion: Motion::new(inputs),
            proof: Proof::new(inputs),
            exchange: exchange::lines(inputs.camera),
            parameters,
        })
    }
}
