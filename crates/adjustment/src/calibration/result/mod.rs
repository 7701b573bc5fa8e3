//! Result of a calibration, independent of its method.

pub mod coverage;
pub mod network;
pub mod parameter_estimate;
pub mod residual;

use fmc_camera_file::CameraFile;
use fmc_camera_file::static_block::StaticCalibration;
use nalgebra::DMatrix;

use coverage::Coverage;
use network::{ImageStation, ObjectPoint};
use parameter_estimate::ParameterEstimate;
use residual::{ImageResidual, ObservationGroup, ObservationResidual};

/// |correlation| above which two parameters are warned of.
pub const HIGH_CORRELATION: f64 = 0.95;

/// A file of observations.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputFile {
    /// Name that messages use.
    pub file: String,
    /// CRC-32 (ISO-HDLC) of its bytes.
    pub crc32: u32,
}

/// Outcome of a calibration, with the data by which a reader can judge it.
///
/// # Units and frames
/// Sensor frame and distortion as in `docs/conventions.md`: measured - ideal, a function of the
/// measured point. Residuals are those of the corrected point.
#[derive(Debug, Clone)]
pub struct CalibrationResult {
    /// Name of the method as the command spells it, such as `dlt3d`.
    pub method: &'static str,
    /// Camera file from which the calibration started.
    pub camera: CameraFile,
    /// Static calibration that replaces that of the camera file.
    pub calibrated: StaticCalibration,
    /// Files of observations.
    pub inputs: Vec<InputFile>,
    /// Parameters, estimated and held, by their names in the camera file; then others.
    pub parameters: Vec<ParameterEstimate>,
    /// Cofactor matrix (covariance for σ0 = 1) of the parameters with
    /// [`is_estimated`](ParameterEstimate::is_estimated), in their order.
    pub cofactors: DMatrix<f64>,
    /// σ0: in µm if `has_sigma` is false, otherwise a factor of the given σ. 1 without redundancy.
    pub sigma0: f64,
    /// `true` if the observations came with σ.
    pub has_sigma: bool,
    /// Groups of observations: image, control, GNSS, attitude, scale bars.
    pub groups: Vec<ObservationGroup>,
    /// Observations or constraints that fix position, orientation and scale, in words.
    pub datum: String,
    /// Number of observations: two for an image point.
    pub observations: usize,
    /// Number of unknowns, eliminated ones included.
    pub unknowns: usize,
    /// Number of constraints between unknowns.
    pub constraints: usize,
    /// Iterations until convergence; 0 for a direct solution.
    pub iterations: usize,
    /// Critical value of the test of residuals; `None` without a test.
    pub critical_value: Option<f64>,
    /// Doubts that a reader must know of.
    pub warnings: Vec<String>,
    /// Statements that are no doubts: gauge, what the method cannot give.
    pub notes: Vec<String>,
    /// Residuals of image points.
    pub image_residuals: Vec<ImageResidual>,
    /// Residuals of all other observations.
    pub other_residuals: Vec<ObservationResidual>,
    /// Projection centres and attitudes.
    pub images: Vec<ImageStation>,
    /// Object points.
    pub points: Vec<ObjectPoint>,
}

impl CalibrationResult {
    /// Redundancy: observations - unknowns + constraints.
    #[must_use]
    pub fn redundancy(&self) -> usize {
        (self.observations + self.constraints).saturating_sub(self.unknowns)
    }

    /// Returns the parameter of a name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&ParameterEstimate> {
        self.parameters.iter().find(|one| one.name == name)
    }

    /// Returns the estimated parameters, in the order of the cofactor matrix.
    pub fn estimated(&self) -> impl Iterator<Item = &ParameterEstimate> {
        self.parameters.iter().filter(|one| one.is_estimated)
    }

    /// Standard deviation of a parameter for the given σ of the observations, not multiplied by
    /// σ0; `None` if it was not estimated.
    #[must_use]
    pub fn sigma_a_priori(&self, name: &str) -> Option<f64> {
        let index = self.index(name)?;
        Some(self.cofactor(index, index).max(0.0).sqrt())
    }

    /// Standard deviation of a parameter: [`Self::sigma_a_priori`] times σ0.
    #[must_use]
    pub fn sigma(&self, name: &str) -> Option<f64> {
        Some(self.sigma_a_priori(name)? * self.sigma0)
    }

    /// Covariance of two parameters, multiplied by σ0²; 0 for one that was not estimated.
    #[must_use]
    pub fn covariance(&self, a: &str, b: &str) -> f64 {
        match (self.index(a), self.index(b)) {
            (Some(a), Some(b)) => self.cofactor(a, b) * self.sigma0.powi(2),
            _ => 0.0,
        }
    }

    /// Correlation of two parameters; `None` for one that was not estimated.
    #[must_use]
    pub fn correlation(&self, a: &str, b: &str) -> Option<f64> {
        let (a, b) = (self.index(a)?, self.index(b)?);
        let scale = (self.cofactor(a, a) * self.cofactor(b, b)).sqrt();
        (scale > 0.0).then(|| (self.cofactor(a, b) / scale).clamp(-1.0, 1.0))
    }

    /// Returns the pairs of parameters whose correlation exceeds [`HIGH_CORRELATION`], without
    /// those for which that is normal: K1 to K3 among themselves, x0 with P1, y0 with P2.
    #[must_use]
    pub fn high_correlations(&self) -> Vec<(&str, &str, f64)> {
        let names: Vec<&str> = self.estimated().map(|one| one.name.as_str()).collect();
        let mut found = Vec::new();
        for (index, a) in names.iter().enumerate() {
            for b in names.iter().skip(index + 1) {
                if let Some(value) = self.correlation(a, b)
                    && value.abs() > HIGH_CORRELATION
                    && !is_normal(a, b)
                {
                    found.push((*a, *b, value));
                }
            }
        }
        found
    }

    /// Returns a warning for each of [`Self::high_correlations`].
    #[must_use]
    pub fn correlation_warnings(&self) -> Vec<String> {
        let found = self.high_correlations().into_iter();
        found
            .map(|(a, b, value)| format!("{a} and {b} are correlated by {value:+.3}"))
            .collect()
    }

    /// Returns the part of the format that accepted image points cover.
    #[must_use]
    pub fn coverage(&self) -> Coverage {
        let points = self.image_residuals.iter().filter(|one| !one.is_rejected);
        Coverage::new(
            self.calibrated.principal_point_mm,
            self.camera.half_format_mm(),
            points.map(|one| one.measured_mm),
        )
    }

    /// Root of the mean square and largest absolute residual along an axis, over accepted image
    /// points, mm; `None` without any.
    #[must_use]
    pub fn residual_size_mm(&self) -> Option<(f64, f64)> {
        let mut count = 0.0;
        let (mut squares, mut largest) = (0.0, 0.0_f64);
        for one in self.image_residuals.iter().filter(|one| !one.is_rejected) {
            for tested in one.components.iter().filter(|one| one.sigma > 0.0) {
                count += 1.0;
                squares += tested.residual.powi(2);
                largest = largest.max(tested.residual.abs());
            }
        }
        (count > 0.0).then(|| (f64::sqrt(squares / count), largest))
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.estimated().position(|one| one.name == name)
    }

    fn cofactor(&self, row: usize, column: usize) -> f64 {
        self.cofactors.get((row, column)).copied().unwrap_or(0.0)
    }
}

fn is_normal(a: &str, b: &str) -> bool {
    let radial = |name: &str| matches!(name, "k1" | "k2" | "k3");
    let pair = |x: &str, y: &str| (a == x && b == y) || (a == y && b == x);
    (radial(a) && radial(b)) || pair("x0_mm", "p1") || pair("y0_mm", "p2")
}
