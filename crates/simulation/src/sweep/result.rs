//! Results of a sweep.

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

    /// √(ΣΔ²/2n), µm: the divisor for residuals of a model without estimated parameters.
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
    /// Residuals against the simulated observations.
    pub noisy: Residuals,
    /// Residuals against the strict solver.
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
    /// Result of the fit, with σ0 in µm.
    pub fit: Result<Fit<f64>, FitError>,
}

/// Result of one case for all exposures.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseResult {
    /// The case.
    pub case: Case,
    /// Fit of each exposure.
    pub frames: Vec<FrameFit>,
    /// Fit of all exposures together; σ0 in µm.
    pub whole: Result<Fit<f64>, FitError>,
    /// The same without noise: σ0 is then the part that the model cannot follow.
    pub noise_free: Result<Fit<f64>, FitError>,
    /// Residuals of the static calibration.
    pub fixed: ModelResiduals,
    /// Residuals of the exact model as the camera computes it, with the focus shift known.
    pub exact: ModelResiduals,
}

impl CaseResult {
    /// Returns the pooled σ0 of the five-coefficient model fitted to each exposure separately, µm.
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

    /// Returns the reduction of the static calibration's mean square residual by the five
    /// coefficients, µm², without noise.
    #[must_use]
    pub fn gain_um2(&self) -> Option<f64> {
        let fit = self.noise_free.as_ref().ok()?;
        let unknowns = f64::from(fit.unknowns);
        let observations = 2.0 * f64::from(fit.points);
        let left = fit.sigma0.powi(2) * (observations - unknowns) / observations;
        Some(self.fixed.noise_free.rms_um().powi(2) - left)
    }
}

/// Result of a whole sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Name of the camera.
    pub camera: String,
    /// Its principal distance, mm.
    pub principal_distance_mm: f64,
    /// K1 of its lens, mm⁻².
    pub k1: f64,
    /// K2 of its lens, mm⁻⁴.
    pub k2: f64,
    /// True `K_m0`, which is K0 with the enlargement by the focus shift; `None` with the printed
    /// formula of the focus shift and for a stage with run-out.
    pub true_km0: Option<f64>,
    /// Run-up strategy of the stage, or `tdi`.
    pub strategy: &'static str,
    /// Options of the sweep.
    pub options: SweepOptions,
    /// Points in an exposure.
    pub points_per_frame: u32,
    /// Results in the order of [`Case::ALL`].
    pub cases: [CaseResult; 3],
}

impl Sweep {
    /// Returns the true value of a coefficient in one exposure of focus shift and motion; `None`
    /// where there is none.
    ///
    /// # Model
    /// `K_m1` = K1, `K_m2` = K2, `K_d1` = -2·K1·c̄/s and `P_m1` = -K1·c̄/s, where s is δ or c̄
    /// (docs/conventions.md, section 7); the last two are those of a lens of K1 alone.
    #[must_use]
    pub fn truth(&self, frame: &FrameFit, parameter: Parameter) -> Option<f64> {
        if self.options.reading == Reading::Literal {
            return None;
        }
        let dynamic = -self.k1 * frame.centroid_mm / frame.regressor_mm;
        let truth = match parameter {
            Parameter::Km0 => self.true_km0?,
            Parameter::Km1 => self.k1,
            Parameter::Km2 => self.k2,
            Parameter::Kd1 => 2.0 * dynamic,
            Parameter::Pm1 => dynamic,
            Parameter::Decentring => return None,
        };
        truth.is_finite().then_some(truth)
    }

    /// Returns the result with focus shift and motion together.
    #[must_use]
    pub const fn both(&self) -> &CaseResult {
        let [both, _, _] = &self.cases;
        both
    }

    /// Returns the shares of focus shift and motion in the gain of the five coefficients; `None` in
    /// the literal reading, whose gain is another.
    #[must_use]
    pub fn shares(&self) -> Option<[f64; 2]> {
        if self.options.reading == Reading::Literal {
            return None;
        }
        let [both, focus, motion] = &self.cases;
        let whole = both.gain_um2().filter(|gain| *gain > 0.0)?;
        Some([focus.gain_um2()? / whole, motion.gain_um2()? / whole])
    }

    /// Returns σ(`K_d1`) of one exposure that travels 15 µm, over 2|K1|.
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
