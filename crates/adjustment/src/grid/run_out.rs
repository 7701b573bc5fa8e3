//! Enlargement of the image by the run-out of the stage.

use fmc_camera_file::CameraFile;

/// Run-out of the stage, as an enlargement of the image.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunOut {
    /// κ per power of the stage offset in mm, lowest power first.
    coefficients: Vec<f64>,
}

impl RunOut {
    /// Returns the run-out of a camera file.
    ///
    /// # Model
    /// κ = Δz/L, Δz the polynomial `flatness_um` of the stage offset, L `exit_pupil_mm`.
    #[must_use]
    pub fn of(camera: &CameraFile) -> Self {
        let lever_um = 1e3 * camera.exit_pupil_mm();
        let terms = camera.fmc.flatness_um.iter();
        Self {
            coefficients: terms.map(|um| um / lever_um).collect(),
        }
    }

    /// Returns κ, the relative enlargement at an offset of the stage in mm.
    #[must_use]
    pub fn enlargement(&self, offset_mm: f64) -> f64 {
        let terms = self.coefficients.iter().rev();
        terms.fold(0.0, |sum, term| sum * offset_mm + term)
    }
}
