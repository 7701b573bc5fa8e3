//! The results of a sweep in words, for terminal and page alike.

use fmc_camera::geometry::estimation::fit::{Fit, FitError};
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_camera_file::Per;
use fmc_reference::exposure::FocusFormula;
use fmc_reference::strict::{Reading, Weight};
use fmc_simulation::sweep::result::{CaseResult, Sweep};

use super::power;
use crate::wording;

/// Results of Yuan et al. 2012, section 4.1: five coefficients and static model, µm.
pub(super) const PAPER_UM: [f64; 2] = [1.2, 2.3];

/// The five coefficients, and the unit of each.
pub(super) const COEFFICIENTS: [(Parameter, &str); 5] = [
    (Parameter::Km0, ""),
    (Parameter::Km1, "mm⁻²"),
    (Parameter::Km2, "mm⁻⁴"),
    (Parameter::Kd1, "mm⁻²"),
    (Parameter::Pm1, "mm⁻²"),
];

/// σ of a model with the correct and with the paper's divisor, and the residuals without noise, µm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Cell {
    pub(super) sigma: String,
    pub(super) as_printed: String,
    pub(super) noise_free: String,
}

impl Cell {
    fn of(sigma_um: f64, as_printed_um: f64, noise_free_um: f64) -> Self {
        Self {
            sigma: micrometres(sigma_um),
            as_printed: micrometres(as_printed_um),
            noise_free: fine_micrometres(noise_free_um),
        }
    }

    fn none() -> Self {
        let dash = || "–".to_owned();
        Self {
            sigma: dash(),
            as_printed: dash(),
            noise_free: dash(),
        }
    }
}

/// Table row of one case: static, five coefficients, exact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) case: &'static str,
    pub(super) cells: [Cell; 3],
}

impl Row {
    fn of(result: &CaseResult) -> Self {
        let fixed = &result.fixed;
        let exact = &result.exact;
        Self {
            case: result.case.label(),
            cells: [
                Cell::of(
                    fixed.noisy.rms_um(),
                    fixed.noisy.n_minus_5_um(),
                    fixed.noise_free.rms_um(),
                ),
                match (&result.whole, &result.noise_free) {
                    (Ok(fit), Ok(noise_free)) => Cell::of(
                        fit.sigma0,
                        fit.sigma0_as_printed.unwrap_or(f64::NAN),
                        noise_free.sigma0,
                    ),
                    _ => Cell::none(),
                },
                Cell::of(
                    exact.noisy.rms_um(),
                    exact.noisy.n_minus_5_um(),
                    exact.noise_free.rms_um(),
                ),
            ],
        }
    }
}

/// A coefficient from all exposures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Estimate {
    pub(super) symbol: &'static str,
    pub(super) value: String,
    pub(super) unit: &'static str,
}

/// Limit of the exact model's residuals by rounding alone, µm rms.
const ROUNDING_UM: f64 = 1e-5;

/// Results of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct SweepResults {
    /// Description of the simulation, in a line.
    pub(super) simulated: String,
    pub(super) rows: Vec<Row>,
    pub(super) estimates: Vec<Estimate>,
    pub(super) sentences: Vec<String>,
}

impl SweepResults {
    pub(super) fn of(sweep: &Sweep) -> Self {
        let both = sweep.both();
        let mut sentences = vec![divisors(sweep)];
        sentences.extend(shares(sweep));
        match &both.whole {
            Ok(fit) => sentences.extend(motion_terms(sweep, fit)),
            Err(error) => sentences.push(no_fit(*error)),
        }
        sentences.push(format!(
            "The exact model has nothing fitted: it evaluates the calibration where the principal point was and takes the focus shift as known. What it leaves without noise is {} µm: {}{}.",
            fine_micrometres(both.exact.noise_free.rms_um()),
            if both.exact.noise_free.rms_um() < ROUNDING_UM {
                "rounding in single precision"
            } else {
                "what its fold leaves out"
            },
            match (sweep.options.weight, sweep.options.reading) {
                (_, Reading::Literal) => " and, in the literal reading, the static distortion counted once too often",
                (Weight::ArcLength, _) => " and the printed weight, which is not the sensor's",
                _ => "",
            }
        ));
        Self {
            simulated: simulated(sweep),
            rows: sweep.cases.iter().map(Row::of).collect(),
            estimates: both.whole.as_ref().map(estimates).unwrap_or_default(),
            sentences,
        }
    }
}

fn simulated(sweep: &Sweep) -> String {
    let options = &sweep.options;
    let frames = sweep.both().frames.len();
    format!(
        "{}: {} of {} points, f = {} mm, {}, noise {} µm on dx and dy (seed {}), focus shift {} µm ({}), weight: {}, K_d1 and P_m1 per mm of {}{}{}",
        sweep.camera,
        wording::counted(frames, "exposure"),
        sweep.points_per_frame,
        wording::decimals(sweep.principal_distance_mm, 4),
        wording::strategy(sweep.strategy),
        wording::decimals(1e3 * options.noise_mm, 4),
        options.seed,
        wording::decimals(1e3 * options.focus_shift_mm, 4),
        match options.focus_formula {
            FocusFormula::Physical => "physical sign",
            FocusFormula::Printed => "as printed",
        },
        match options.weight {
            Weight::Exposure => "exposure",
            Weight::ArcLength => "arc length",
        },
        per(options.regressor),
        if options.tied { ", tied" } else { "" },
        match options.reading {
            Reading::Consistent => "",
            Reading::Literal =>
                "; eqs. 12-13 read literally, which counts the static distortion twice",
        },
    )
}

/// Returns the name of the quantity that multiplies `K_d1` and `P_m1`.
pub(super) const fn per(regressor: Per) -> &'static str {
    match regressor {
        Per::Travel => "the travel δ",
        Per::Centroid => "the centroid's offset",
    }
}

/// Compares the paper's numbers, its divisor and the correct one.
fn divisors(sweep: &Sweep) -> String {
    let both = sweep.both();
    let [paper_five, paper_static] = PAPER_UM;
    let fixed = both.fixed.noisy;
    let noise = wording::decimals(1e3 * sweep.options.noise_mm, 4);
    let paper = format!(
        "Yuan et al. 2012 report {paper_five} µm with five coefficients and {paper_static} µm with the static model; eq. 28 divides by n - 5, n the number of points, where there are 2n observations."
    );
    match &both.whole {
        Ok(fit) => format!(
            "{paper} Here that divisor gives {:.1} and {:.1} µm; the honest one, 2n - u, gives {:.2} and {:.2} µm per coordinate, where {noise} µm of noise was put in.",
            fit.sigma0_as_printed.unwrap_or(f64::NAN),
            fixed.n_minus_5_um(),
            fit.sigma0,
            fixed.rms_um(),
        ),
        Err(_) => format!(
            "{paper} Here that divisor gives {:.1} µm for the static model; the honest one {:.2} µm per coordinate, where {noise} µm of noise was put in.",
            fixed.n_minus_5_um(),
            fixed.rms_um(),
        ),
    }
}

/// Describes the shares of focus shift and motion in the gain.
fn shares(sweep: &Sweep) -> Option<String> {
    let [focus, motion] = sweep.shares()?;
    Some(format!(
        "Of what the five coefficients gain over the static model (mean square, without noise), the focus shift alone accounts for {} and the motion of the principal point alone for {}.",
        percent(focus),
        percent(motion),
    ))
}

/// Describes the significance of `K_d1` and `P_m1`.
fn motion_terms(sweep: &Sweep, fit: &Fit<f64>) -> Vec<String> {
    let significance = |parameter| fit.value(parameter) / fit.standard_deviation(parameter);
    let mut sentences = vec![format!(
        "From all exposures together K_d1 is {} and P_m1 {} times its standard deviation{}.",
        two_digits(significance(Parameter::Kd1)),
        two_digits(significance(Parameter::Pm1)),
        if sweep.strategy == "centred" {
            "; with a centred run-up the offset of the exposure centroid is zero, and both should be zero"
        } else {
            ""
        }
    )];
    // Without noise the coefficients do not scatter, and the differences are errors of the model.
    if let Some(scatter) = sweep.kd1_scatter_at_15_um()
        && sweep.options.noise_mm > 0.0
    {
        let frames = sweep.both().frames.iter();
        let longest = frames.map(|f| f.regressor_mm.abs()).fold(0.0, f64::max);
        sentences.push(format!(
            "From one exposure alone the standard deviation of K_d1 is {} times 2|K1| where it is multiplied by 15 µm, and {} times where by {:.0} µm, the most in this sweep: hence the scatter where it is small.",
            two_digits(scatter),
            two_digits(scatter * 0.015 / longest),
            1e3 * longest,
        ));
    }
    if let Ok(left) = &sweep.both().noise_free
        && left.sigma0 >= 1e-3
    {
        sentences.push(format!(
            "Five coefficients cannot follow everything: without noise they leave {:.3} µm. The model has neither the constant shift K_m0·s nor what the motion makes of K2, K3 and P, nor a principal distance that differs from exposure to exposure{}{}.",
            left.sigma0,
            if sweep.options.regressor == Per::Travel && sweep.strategy == "from-rest" {
                "; and after a run-up from rest the offset of the centroid is not proportional to δ (--regress-on centroid)"
            } else {
                ""
            },
            if sweep.options.tied {
                "; and K_d1 = 2 P_m1 holds for a lens of K1 alone"
            } else {
                ""
            }
        ));
    }
    sentences
}

fn no_fit(error: FitError) -> String {
    match error {
        FitError::NoMotion { .. } => "Five coefficients: none. With a centred run-up the exposure centroid falls on the calibrated principal point in every exposure, so K_d1 and P_m1, regressed on its offset, are multiplied by zero: they do not exist, and no number is given for them. The first-order effect of the motion is absent, too; --regress-on travel gives numbers that should be zero, --strategy from-rest an effect to find.".to_owned(),
        other => format!("Five coefficients: none; {other}."),
    }
}

fn estimates(fit: &Fit<f64>) -> Vec<Estimate> {
    COEFFICIENTS
        .iter()
        .map(|(parameter, unit)| Estimate {
            symbol: parameter.symbol(),
            value: power::with_deviation(fit.value(*parameter), fit.standard_deviation(*parameter)),
            unit,
        })
        .collect()
}

fn micrometres(um: f64) -> String {
    format!("{um:.3}")
}

/// Writes four decimals, so that residuals of nanometres show.
fn fine_micrometres(um: f64) -> String {
    if um > 0.0 && um < 5e-5 {
        "<0.0001".to_owned()
    } else {
        format!("{um:.4}")
    }
}

fn percent(share: f64) -> String {
    format!("{} %", wording::decimals(100.0 * share, 2))
}

fn two_digits(number: f64) -> String {
    let decimals = usize::try_from(1 - power::exponent(number)).unwrap_or(0);
    format!("{number:.*}", decimals.min(4))
}
