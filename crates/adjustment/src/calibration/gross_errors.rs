//! Search for gross errors in adjustments of few unknowns: the worst first, then again.

use super::least_squares::{Adjusted, AdjustmentError, Model, adjust};
use super::result::CalibrationResult;
use super::result::residual::TestedResidual;
use super::snooping::{FAMILY_ERROR, LEAST_REDUNDANCY, ROUNDING_MM, count, pope, student};

/// Share of rejected points above which the model is doubted.
const LARGEST_REJECTED: f64 = 0.05;

/// An adjustment without the observations that are in gross error.
#[derive(Debug, Clone)]
pub(crate) struct Searched<M, const D: usize> {
    pub(crate) adjusted: Adjusted<M, D>,
    pub(crate) accepted: Vec<bool>,
    /// Critical value of Pope's τ.
    pub(crate) critical: Option<f64>,
    /// Residuals with their tests, of all observations.
    pub(crate) tested: Vec<[TestedResidual; D]>,
}

/// Adjusts, rejects the observation with the largest test value beyond the critical one, and
/// repeats; then admits again those that fit the final adjustment, each once.
///
/// # Model
/// Pope's τ with σ0 estimated, [`FAMILY_ERROR`] shared by all components; for rejected observations
/// Student's t of their prediction. With `keeps_all` nothing is rejected.
pub(crate) fn search<M: Model<D>, const D: usize>(
    start: &M,
    keeps_all: bool,
) -> Result<Searched<M, D>, AdjustmentError> {
    let total = start.observations();
    let mut accepted = vec![true; total];
    let mut was_admitted = vec![false; total];
    let mut adjusted = adjust(start, &accepted)?;
    let probability = 1.0 - FAMILY_ERROR / (2.0 * count(D * total));
    loop {
        let freedom = count(adjusted.redundancy);
        let outside = student(probability, freedom - 1.0);
        let critical = (adjusted.redundancy >= LEAST_REDUNDANCY).then(|| pope(outside, freedom));
        let tested: Vec<[TestedResidual; D]> = (0..total)
            .map(|index| test(&adjusted, index, &accepted))
            .collect();
        let value = |index: usize| {
            let tests = tested.get(index).into_iter().flatten();
            tests
                .filter(|one| one.residual.abs() > ROUNDING_MM)
                .map(|one| one.test_value)
                .fold(0.0, f64::max)
        };
        let is_in = |index: usize| accepted.get(index).copied().unwrap_or(false);
        let worst = (0..total)
            .filter(|index| is_in(*index))
            .max_by(|a, b| value(*a).total_cmp(&value(*b)));
        let mut next = accepted.clone();
        if let Some(worst) = worst
            && !keeps_all
            && critical.is_some_and(|critical| value(worst) > critical)
        {
            if let Some(taken) = next.get_mut(worst) {
                *taken = false;
            }
        } else {
            for (index, taken) in next.iter_mut().enumerate() {
                let is_first = was_admitted.get(index) == Some(&false);
                if !*taken && is_first && value(index) <= outside {
                    *taken = true;
                    if let Some(admitted) = was_admitted.get_mut(index) {
                        *admitted = true;
                    }
                }
            }
        }
        if next == accepted {
            return Ok(Searched {
                adjusted,
                accepted,
                critical,
                tested,
            });
        }
        adjusted = adjust(&adjusted.model, &next)?;
        accepted = next;
    }
}

/// Returns a warning if more image points were rejected than gross errors explain.
pub(crate) fn rejection_warning(result: &CalibrationResult) -> Option<String> {
    let total = result.image_residuals.len();
    let rejected = result.image_residuals.iter().filter(|one| one.is_rejected);
    let rejected = rejected.count();
    (count(rejected) > LARGEST_REJECTED * count(total)).then(|| {
        format!(
            "{rejected} of {total} points were rejected: more likely the model does not follow the \
             image than so many points are wrong; estimate more of the distortion"
        )
    })
}

fn test<M: Model<D>, const D: usize>(
    adjusted: &Adjusted<M, D>,
    index: usize,
    accepted: &[bool],
) -> [TestedResidual; D] {
    let zero = [0.0; D];
    let residuals = adjusted.residuals.get(index).unwrap_or(&zero);
    let leverages = adjusted.leverages.get(index).unwrap_or(&zero);
    let sigma = adjusted.model.sigma_mm(index);
    let is_in = accepted.get(index).copied().unwrap_or(false);
    std::array::from_fn(|component| {
        let residual = residuals.get(component).copied().unwrap_or(0.0);
        let leverage = leverages.get(component).copied().unwrap_or(0.0);
        if is_in {
            let redundancy = (1.0 - leverage).clamp(0.0, 1.0);
            TestedResidual::new(residual, sigma, redundancy, adjusted.sigma0)
        } else {
            let deviation = adjusted.sigma0 * sigma * (1.0 + leverage).sqrt();
            TestedResidual {
                residual,
                sigma,
                redundancy: 0.0,
                test_value: if deviation > 0.0 {
                    residual.abs() / deviation
                } else {
                    0.0
                },
            }
        }
    })
}
