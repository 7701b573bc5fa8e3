//! Data snooping: the search for observations that disagree with the others.

use fmc_camera::geometry::estimation::fit::{Fit, FitError};
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::options::FitOptions;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::measurement::Measurement;
use super::residual::{Tested, adjusted, residual_variances, residuals_in_sigma};
use super::robust_start::RobustStart;

/// Probability that any observation is rejected although none is wrong.
pub(crate) const FAMILY_ERROR: f64 = 0.05;

/// Redundancy below which no observation is rejected: the others cannot tell which one is wrong.
pub(crate) const LEAST_REDUNDANCY: usize = 8;

/// Residuals smaller than this, mm, are due to rounding and never rejected.
pub(crate) const ROUNDING_MM: f64 = 2e-9;

/// Largest number of rounds of testing and fitting.
const ROUNDS: usize = 50;

/// A fit to the accepted observations, and the test of every observation.
#[derive(Debug, Clone)]
pub(super) struct Snooped {
    pub(super) fit: Fit<f64>,
    pub(super) tested: Vec<Tested>,
    pub(super) critical: f64,
}

/// Tests all observations against the fit of the accepted ones and fits again, until the accepted
/// ones stay the same.
///
/// # Model
/// Test value `|v|/(σ0·σ_v)` of each component, `σ_v² = σ²(1 - h)` for an observation in the fit
/// (Baarda's data snooping with σ0 estimated: Pope's τ) and σ²(1 + h) for one outside of it
/// (Student's t), h = aᵀQa. The critical values belong to the probability [`FAMILY_ERROR`], shared
/// by all 2n components.
///
/// # Errors
/// [`FitError`] if the accepted observations do not determine the coefficients.
pub(super) fn snoop(
    lens: &KnownLens<f64>,
    options: FitOptions,
    measurements: &[Measurement],
    start: &RobustStart,
) -> Result<Snooped, FitError> {
    let components = 2.0 * count(measurements.len());
    let quantile = |freedom: f64| student(1.0 - FAMILY_ERROR / (2.0 * components), freedom);
    let first = quantile(components);
    let mut accepted: Vec<bool> = measurements
        .iter()
        .map(|measurement| {
            let residuals = residuals_in_sigma(lens, &start.fit, measurement);
            is_below(measurement, residuals, start.scale, first)
        })
        .collect();
    let mut round = 0;
    loop {
        round += 1;
        let good = measurements
            .iter()
            .zip(&accepted)
            .filter(|(_, accepted)| **accepted)
            .map(|(measurement, _)| measurement);
        let fit = adjusted(lens, options, good).fit()?;
        let freedom = f64::from(fit.redundancy()).max(2.0);
        let outside = quantile(freedom - 1.0);
        let inside = pope(outside, freedom);
        let tested: Vec<Tested> = measurements
            .iter()
            .zip(&accepted)
            .map(|(measurement, accepted)| {
                test(lens, &fit, measurement, *accepted, [inside, outside])
            })
            .collect();
        let next: Vec<bool> = tested.iter().map(|tested| tested.passes).collect();
        let last = round >= ROUNDS;
        if next == accepted || last {
            return Ok(Snooped {
                fit,
                tested: tested
                    .into_iter()
                    .zip(&accepted)
                    .map(|(tested, accepted)| Tested {
                        passes: *accepted,
                        ..tested
                    })
                    .collect(),
                critical: inside,
            });
        }
        // The sets can alternate; after half of the rounds only observations of both stay.
        accepted = if round > ROUNDS / 2 {
            next.iter().zip(&accepted).map(|(a, b)| *a && *b).collect()
        } else {
            next
        };
    }
}

fn test(
    lens: &KnownLens<f64>,
    fit: &Fit<f64>,
    measurement: &Measurement,
    accepted: bool,
    [inside, outside]: [f64; 2],
) -> Tested {
    let residuals = residuals_in_sigma(lens, fit, measurement);
    let leverages = residual_variances(lens, fit, measurement);
    let mut value = 0.0_f64;
    for (residual, leverage) in residuals.into_iter().zip(leverages) {
        let variance = if accepted {
            1.0 - leverage
        } else {
            1.0 + leverage
        };
        // An observation that no other controls has a residual of 0.
        let deviation = variance.max(1e-9).sqrt() * fit.sigma0;
        let size = residual.abs();
        if size * measurement.row.sigma_mm > ROUNDING_MM && deviation > 0.0 {
            value = value.max(size / deviation);
        }
    }
    Tested {
        residual_mm: residuals.map(|residual| residual * measurement.row.sigma_mm),
        test_value: value,
        passes: value <= if accepted { inside } else { outside },
    }
}

fn is_below(measurement: &Measurement, residuals: [f64; 2], scale: f64, critical: f64) -> bool {
    residuals.into_iter().all(|residual| {
        residual.abs() <= critical * scale
            || residual.abs() * measurement.row.sigma_mm <= ROUNDING_MM
    })
}

/// Returns a quantile of Student's distribution.
pub(crate) fn student(probability: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom.max(1.0))
        .map_or(f64::INFINITY, |student| student.inverse_cdf(probability))
}

/// Returns Pope's τ of r degrees of freedom from Student's t of r - 1.
pub(crate) fn pope(t: f64, freedom: f64) -> f64 {
    (freedom.sqrt() * t) / (freedom - 1.0 + t * t).sqrt()
}

#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
pub(crate) fn count(number: usize) -> f64 {
    number as f64
}
