//! The sweep for programs: `summary.json`.

use fmc_camera::geometry::estimation::fit::Fit;
use fmc_reference::exposure::FocusFormula;
use fmc_reference::strict::{Reading, Weight};
use fmc_simulation::sweep::result::{CaseResult, Sweep};
use serde::Serialize;

use super::results::{COEFFICIENTS, PAPER_UM};

/// The numbers of a sweep. Keys are only ever added. σ is per coordinate with divisor 2n - u unless
/// the key says otherwise, µm. A number that does not exist is null.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the camera.
    pub camera: String,
    /// Number of exposures.
    pub frames: usize,
    /// Number of points in all exposures.
    pub points: u64,
    /// Number of points in one exposure.
    pub points_per_frame: u32,
    /// Standard deviation of the noise.
    pub noise_um: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Focus shift in addition to the run-out.
    pub focus_shift_um: f64,
    /// Formula that turns it into distortion.
    pub focus_sign: &'static str,
    /// Strategy of the run-up.
    pub strategy: &'static str,
    /// Weight of the exposure mean.
    pub weight: &'static str,
    /// Reading of eqs. 12-13.
    pub reading: &'static str,
    /// `true` if `K_d1` = 2`P_m1` was imposed.
    pub tied: bool,
    /// Quantity that multiplies `K_d1` and `P_m1`.
    pub regress_on: &'static str,
    /// σ of the static calibration.
    pub sigma_static_um: f64,
    /// σ of the five coefficients, from all exposures together.
    pub sigma_dynamic_um: Option<f64>,
    /// σ of the exact model with the focus shift known.
    pub sigma_exact_um: f64,
    /// `sigma_static_um` with the paper's divisor.
    pub sigma_static_um_n_minus_5: f64,
    /// `sigma_dynamic_um` with the paper's divisor.
    pub sigma_dynamic_um_n_minus_5: Option<f64>,
    /// `sigma_exact_um` with the paper's divisor.
    pub sigma_exact_um_n_minus_5: f64,
    /// σ of the five coefficients, exposure by exposure.
    pub sigma_dynamic_per_frame_um: Option<f64>,
    /// σ of the static model in the paper.
    pub paper_static_um: f64,
    /// σ of the five coefficients in the paper.
    pub paper_dynamic_um: f64,
    /// Share of the focus shift in the gain by the five coefficients.
    pub gain_share_focus: Option<f64>,
    /// Share of the motion in that gain.
    pub gain_share_motion: Option<f64>,
    /// σ(`K_d1`) of one exposure over 2|K1| where it is multiplied by 15 µm.
    pub kd1_sigma_over_2k1_at_15_um: Option<f64>,
    /// The coefficients from all exposures together.
    pub coefficients: Option<Vec<Coefficient>>,
    /// Reason why there are none.
    pub no_coefficients: Option<String>,
    /// Condition number of that adjustment.
    pub condition: Option<f64>,
    /// Results for motion and focus shift together, and for each alone.
    pub cases: Vec<CaseSummary>,
}

/// One coefficient, in powers of mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coefficient {
    /// Symbol of the coefficient.
    pub symbol: &'static str,
    /// Value of the coefficient.
    pub value: f64,
    /// Standard deviation of the coefficient.
    pub sigma: f64,
}

/// Results of one case.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CaseSummary {
    /// Name of the case.
    pub case: &'static str,
    /// σ of the static calibration.
    pub sigma_static_um: f64,
    /// σ of the five coefficients, from all exposures together.
    pub sigma_dynamic_um: Option<f64>,
    /// σ of the exact model with the focus shift known.
    pub sigma_exact_um: f64,
    /// Residuals of the static calibration without noise.
    pub noise_free_static_um: f64,
    /// Residuals of five coefficients fitted to data without noise.
    pub noise_free_dynamic_um: Option<f64>,
    /// Residuals of the exact model without noise.
    pub noise_free_exact_um: f64,
}

impl Summary {
    /// Returns the summary of a sweep.
    #[must_use]
    pub fn of(sweep: &Sweep) -> Self {
        let both = sweep.both();
        let options = &sweep.options;
        let fit = both.whole.as_ref().ok();
        let [paper_dynamic_um, paper_static_um] = PAPER_UM;
        let shares = sweep.shares();
        let frames = both.frames.len();
        Self {
            camera: sweep.camera.clone(),
            frames,
            points: frames as u64 * u64::from(sweep.points_per_frame),
            points_per_frame: sweep.points_per_frame,
            noise_um: 1e3 * options.noise_mm,
            seed: options.seed,
            focus_shift_um: 1e3 * options.focus_shift_mm,
            focus_sign: match options.focus_formula {
                FocusFormula::Physical => "physical",
                FocusFormula::Printed => "printed",
            },
            strategy: sweep.strategy,
            weight: match options.weight {
                Weight::Exposure => "exposure",
                Weight::ArcLength => "arc-length",
            },
            reading: match options.reading {
                Reading::Consistent => "consistent",
                Reading::Literal => "literal",
            },
            tied: options.tied,
            regress_on: options.regressor.name(),
            sigma_static_um: both.fixed.noisy.rms_um(),
            sigma_dynamic_um: fit.map(|fit| fit.sigma0),
            sigma_exact_um: both.exact.noisy.rms_um(),
            sigma_static_um_n_minus_5: both.fixed.noisy.n_minus_5_um(),
            sigma_dynamic_um_n_minus_5: fit.and_then(|fit| fit.sigma0_as_printed),
            sigma_exact_um_n_minus_5: both.exact.noisy.n_minus_5_um(),
            sigma_dynamic_per_frame_um: both.per_frame_sigma_um(),
            paper_static_um,
            paper_dynamic_um,
            gain_share_focus: shares.map(|[focus, _]| focus),
            gain_share_motion: shares.map(|[_, motion]| motion),
            kd1_sigma_over_2k1_at_15_um: sweep.kd1_scatter_at_15_um(),
            coefficients: fit.map(coefficients),
            no_coefficients: both.whole.as_ref().err().map(ToString::to_string),
            condition: fit.map(|fit| fit.condition),
            cases: sweep.cases.iter().map(CaseSummary::of).collect(),
        }
    }
}

fn coefficients(fit: &Fit<f64>) -> Vec<Coefficient> {
    COEFFICIENTS
        .iter()
        .map(|(parameter, _)| Coefficient {
            symbol: parameter.symbol(),
            value: fit.value(*parameter),
            sigma: fit.standard_deviation(*parameter),
        })
        .collect()
}

impl CaseSummary {
    fn of(result: &CaseResult) -> Self {
        let sigma0 = |fit: &Result<Fit<f64>, _>| fit.as_ref().ok().map(|fit| fit.sigma0);
        Self {
            case: result.case.name(),
            sigma_static_um: result.fixed.noisy.rms_um(),
            sigma_dynamic_um: sigma0(&result.whole),
            sigma_exact_um: result.exact.noisy.rms_um(),
            noise_free_static_um: result.fixed.noise_free.rms_um(),
            noise_free_dynamic_um: sigma0(&result.noise_free),
            noise_free_exact_um: result.exact.noise_free.rms_um(),
        }
    }
}
