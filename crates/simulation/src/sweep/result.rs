//! What a sweep finds.

use fmc_camera::geometry::estimation::fit::{Fit, FitError};
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_reference::strict::Reading;
use fmc_reference::verification::grid::GridExposure;

use super::options::{Case, SweepOptions};

/// Root mean square of residuals, with either divisor.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Residuals {
    squares_mm2: f64,
    points: u32,
}

impl Residuals {
    /// Adds the residual of one point.
    pub fn add(&mut self, [dx, dy]: [f64; 2]) {
        self.squares_mm2 += dx * dx + dy * dy;
        self.points += 1;
    }

    /// √(ΣΔ²/2n), µm: nothing was estimated.
    #[must_use]
    pub fn rms_um(&self) -> f64 {
        1e3 * (self.squares_mm2 / (2.0 * f64::from(self.points))).sqrt()
    }

    /// √(ΣΔ²/(n - 5)), µm: the divisor of Yuan et al. 2012, eq. 28.
    #[must_use]
    pub fn n_minus_5_um(&self) -> f64 {
        1e3 * (self.squares_mm2 / (f64::from(self.points) - 5.0)).sqrt()
    }
}

/// Residuals of one model.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ModelResiduals {
    /// Against the simulated observations.
    pub noisy: Residuals,
    /// Against the strict solver.
    pub noise_free: Residuals,
}

/// Five coefficients of one exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFit {
    /// V/H, exposure time and run-up.
    pub exposure: GridExposure,
    /// δ, mm.
    pub travel_mm: f64,
    /// c̄, mm.
    pub centroid_mm: f64,
    /// δ or c̄, as the options say.
    pub regressor_mm: f64,
    /// σ0 in µm, or why there is no fit.
    pub fit: Result<Fit<f64>, FitError>,
}

/// One case, all exposures.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseResult {
    /// Which.
    pub case: Case,
    /// Exposure by exposure.
    pub frames: Vec<FrameFit>,
    /// All exposures together; σ0 in µm.
    pub whole: Result<Fit<f64>, FitError>,
    /// The same without noise: σ0 is what the model cannot follow.
    pub noise_free: Result<Fit<f64>, FitError>,
    /// Of the static calibration.
    pub fixed: ModelResiduals,
    /// Of the exact model as the camera computes it, with the focus shift known.
    pub exact: ModelResiduals,
}

impl CaseResult {
    /// σ of the five-coefficient model fitted to each exposure by itself, all together, µm.
    #[must_use]
    pub fn per_frame_sigma_um(&self) -> Option<f64> {
        let (mut squares, mut redundancy) = (0.0, 0.0);
        for frame in &self.frames {
            let fit = frame.fit.as_ref().ok()?;
            let freedom = f64::from(fit.redundancy());
            squares += freedom * fit.sigma0.powi(2);
            redundancy += freedom;
        }
        (redundancy > 0.0).then(|| (squares / redundancy).sqrt())
    }

    /// By how much the five coefficients lower the mean square residual of the static calibration,
    /// µm², without noise.
    #[must_use]
    pub fn gain_um2(&self) -> Option<f64> {
        let fit = self.noise_free.as_ref().ok()?;
        let unknowns = f64::from(fit.unknowns);
        let observations = 2.0 * f64::from(fit.points);
        let left = fit.sigma0.powi(2) * (observations - unknowns) / observations;
        Some(self.fixed.noise_free.rms_um().powi(2) - left)
    }
}

/// A whole sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Name of the camera.
    pub camera: String,
    /// Its principal distance, mm.
    pub principal_distance_mm: f64,
    /// K1 of its lens, mm⁻².
    pub k1: f64,
    /// How the run-up puts the exposures.
    pub strategy: &'static str,
    /// What was asked for.
    pub options: SweepOptions,
    /// Points in an exposure.
    pub points_per_frame: u32,
    /// In the order of [`Case::ALL`].
    pub cases: [CaseResult; 3],
}

impl Sweep {
    /// Focus shift and motion together.
    #[must_use]
    pub const fn both(&self) -> &CaseResult {
        let [both, _, _] = &self.cases;
        both
    }

    /// Shares of focus shift and motion in the gain of the five coefficients; none in the literal
    /// reading, whose gain is another.
    #[must_use]
    pub fn shares(&self) -> Option<[f64; 2]> {
        if self.options.reading == Reading::Literal {
            return None;
        }
        let [both, focus, motion] = &self.cases;
        let whole = both.gain_um2().filter(|gain| *gain > 0.0)?;
        Some([focus.gain_um2()? / whole, motion.gain_um2()? / whole])
    }

    /// σ(`K_d1`) of one exposure that travels 15 µm, over 2|K1|.
    #[must_use]
    pub fn kd1_scatter_at_15_um(&self) -> Option<f64> {
        // σ(K_d1) falls with the regressor; the design is otherwise the same in every exposure.
        let (mut squares, mut count) = (0.0, 0.0);
        for frame in &self.both().frames {
            let fit = frame.fit.as_ref().ok()?;
            let sigma = fit.standard_deviation(Parameter::Kd1);
            squares += (sigma * frame.regressor_mm / 0.015).powi(2);
            count += 1.0;
        }
        let scatter: f64 = (squares / count).sqrt() / (2.0 * self.k1.abs());
        scatter.is_finite().then_some(scatter)
    }
}
