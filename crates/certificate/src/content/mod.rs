//! Content of a certificate: what `certificate.json` has, and what the pages are set from.

pub mod distortion;
pub mod exchange;
pub mod identity;
pub mod inputs;
pub mod motion;
pub mod observed;
pub mod parameters;
pub mod proof;
pub mod radial;
pub mod residual;

use fmc_camera_file::InputError;
use fmc_reference::residual_splines::ResidualSplines;
use serde::Serialize;

use distortion::StaticDistortion;
use exchange::ExchangeLine;
use identity::Identity;
use inputs::Inputs;
use motion::Motion;
use parameters::ParameterSection;
use proof::Proof;
use residual::ResidualSection;

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
    /// Residual grids beside the polynomial.
    pub residual_grids: ResidualSection,
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
    /// [`InputError`] for details or calibrations that contradict the camera file, and for residual
    /// grids that do not fit it or lie in another folder.
    pub fn new(inputs: &Inputs<'_>) -> Result<Self, InputError> {
        let parameters = ParameterSection::new(inputs)?;
        let grids = inputs
            .grids
            .grids(inputs.checked.calibration())
            .map_err(|error| InputError::invalid(format!("{}: {error}", inputs.file_name)))?;
        let splines = ResidualSplines::of(&grids);
        Ok(Self {
            format: "fmc-certificate 1",
            identity: Identity::new(inputs)?,
            conventions: identity::conventions(inputs.camera),
            static_distortion: StaticDistortion::new(inputs, &splines),
            residual_grids: ResidualSection::new(inputs, &grids)?,
            motion: Motion::new(inputs, &splines),
            proof: Proof::new(inputs, &grids),
            exchange: exchange::lines(inputs.camera, splines),
            parameters,
        })
    }
}
