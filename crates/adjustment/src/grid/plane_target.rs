//! Residual grid of what the polynomial leaves of a plane target's distortion table.

use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::InputError;

use super::calibration::{GridCalibration, grid_calibration};
use super::polynomial::COEFFICIENTS;
use super::request::GridCalibrationRequest;
use super::table::TableObservation;
use crate::calibration::dlt2d::distortion_table::Dlt2d;

impl Dlt2d {
    /// Determines the residual grid of a part from the table.
    ///
    /// # Model
    /// The table about the f and the principal point of the camera file (`TableRow::of_camera_mm`)
    /// goes to [`grid_calibration`] with the polynomial of this result, which is held: the
    /// homography took eight parameters of the table together with that polynomial, and the grid
    /// takes what both leave. A plane target stands before one position of the stage, so that the
    /// table cannot tell lens and sensor apart.
    ///
    /// # Errors
    /// As [`grid_calibration`].
    pub fn leftover_grid(
        &self,
        carrier: GridCarrier,
        pitch_mm: f64,
    ) -> Result<GridCalibration, InputError> {
        let accepted = self
            .result
            .image_residuals
            .iter()
            .filter(|residual| !residual.is_rejected);
        let observations: Vec<TableObservation> = self
            .rows
            .iter()
            .zip(accepted)
            .map(|(row, residual)| TableObservation {
                line: residual.line,
                measured_mm: row.measured_mm,
                distortion_mm: row.of_camera_mm,
                stage_offset_mm: 0.0,
            })
            .collect();
        let mut camera = self.result.camera.clone();
        camera.distortion = self.result.calibrated.distortion.clone();
        let input = self.result.inputs.first().cloned();
        grid_calibration(&GridCalibrationRequest {
            input: input.ok_or_else(|| InputError::invalid("no file of targets"))?,
            observations: &observations,
            camera: &camera,
            carriers: &[carrier],
            pitch_mm,
            is_estimated: [false; COEFFICIENTS],
        })
    }
}
