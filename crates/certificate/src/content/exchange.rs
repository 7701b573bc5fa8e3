//! Residual that the camera leaves in the files of other programs.

use fmc_camera_file::CameraFile;
use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::{self, Choices};
use fmc_exchange::program::Program;
use fmc_reference::residual_splines::ResidualSplines;
use serde::Serialize;

use crate::stated::Stated;

/// One program.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExchangeLine {
    /// Format, as the command line names it.
    pub format: &'static str,
    /// Model of the program; `None` if the camera cannot be written.
    pub model: Option<&'static str>,
    /// Largest residual along an axis, µm.
    pub residual_max_um: Option<Stated>,
    /// Root mean square of the residual, µm.
    pub residual_rms_um: Option<Stated>,
    /// Largest residual, px.
    pub residual_max_px: Option<Stated>,
    /// Terms of the calibration without a place in the file.
    pub not_held: Vec<&'static str>,
    /// Reason for which the camera cannot be written.
    pub refused: Option<String>,
}

/// Returns a line per program, with the model that an export takes without further choice.
pub(super) fn lines(camera: &CameraFile, splines: ResidualSplines) -> Vec<ExchangeLine> {
    let calibrated = Calibrated::of(camera).with_residual(splines);
    Program::WRITTEN
        .map(|program| line(&calibrated, program))
        .into()
}

fn line(camera: &Calibrated, program: Program) -> ExchangeLine {
    let format = program.name();
    match export::export(camera, program, &Choices::default()) {
        Ok(exported) => {
            let largest_um = exported.residual.largest_um;
            ExchangeLine {
                format,
                model: Some(exported.model),
                residual_max_um: Stated::decimals(largest_um, 4),
                residual_rms_um: Stated::decimals(exported.residual.rms_um, 4),
                residual_max_px: Stated::decimals(largest_um / (1e3 * camera.pixel_mm), 4),
                not_held: exported.not_held.iter().map(|term| term.term).collect(),
                refused: None,
            }
        }
        Err(error) => ExchangeLine {
            format,
            model: None,
            residual_max_um: None,
            residual_rms_um: None,
            residual_max_px: None,
            not_held: Vec::new(),
            refused: Some(error.to_string()),
        },
    }
}
