//! Robust first fit, which resists gross errors.

use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::fit::{Fit, FitError};
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};

use super::measurement::Measurement;
use super::residual::{adjusted, residuals_in_sigma};
use super::units::median;

/// Number of points of an elemental fit. With 20 % of gross errors one fit in six is free of them,
/// with 40 % one in 60.
const SUBSET: usize = 8;
/// Number of elemental fits.
const SUBSETS: usize = 400;
/// Number of measurements by which elemental fits are judged.
const JUDGES: usize = 2000;
/// Number of elemental fits that are improved.
const FINALISTS: usize = 8;
/// Largest number of concentration steps.
const STEPS: usize = 20;

/// A fit and the scale of its good residuals, in units of σ.
#[derive(Debug, Clone)]
pub(super) struct RobustStart {
    pub(super) fit: Fit<f64>,
    pub(super) scale: f64,
}

/// Fits by least median of squares with elemental subsets and concentration steps (Rousseeuw and
/// Van Driessen, Computing LTS regression for large data sets, 2006). The fit breaks down at half
/// of the points; the choice of subsets is always the same.
///
/// # Errors
/// [`FitError`] if no subset determines the coefficients.
pub(super) fn robust_start(
    lens: &KnownLens<f64>,
    options: FitOptions,
    measurements: &[Measurement],
) -> Result<RobustStart, FitError> {
    // Few points cannot separate P from the dynamic terms; all of them together have been shown to.
    let options = FitOptions {
        decentring: match options.decentring {
            StaticDecentring::Hold => StaticDecentring::Known,
            other => other,
        },
        ..options
    };
    let mut draw = Draw(0x5eed_0005);
    let judges: Vec<&Measurement> = if measurements.len() > JUDGES {
        (0..JUDGES)
            .filter_map(|_| measurements.get(draw.below(measurements.len())))
            .collect()
    } else {
        measurements.iter().collect()
    };
    let mut finalists: Vec<(f64, Fit<f64>)> = Vec::new();
    let mut last_error = None;
    for _ in 0..SUBSETS {
        let subset = (0..SUBSET).filter_map(|_| measurements.get(draw.below(measurements.len())));
        match adjusted(lens, options, subset).fit() {
            Ok(fit) => {
                finalists.push((median_square(lens, &fit, &judges), fit));
                finalists.sort_by(|(a, _), (b, _)| a.total_cmp(b));
                finalists.truncate(FINALISTS);
            }
            Err(error) => last_error = Some(error),
        }
    }
    // With few points all of them are fitted together.
    if finalists.is_empty() {
        let fit = adjusted(lens, options, measurements.iter()).fit();
        let fit = fit.map_err(|error| last_error.unwrap_or(error))?;
        finalists.push((median_square(lens, &fit, &judges), fit));
    }
    let best = finalists
        .into_iter()
        .map(|(_, fit)| concentrated(lens, options, fit, &judges))
        .min_by(|(a, _), (b, _)| a.total_cmp(b));
    let (square, fit) = best.ok_or(FitError::TooFew {
        points: 0,
        needed: 3,
    })?;
    // The median of the squared length of two normal errors is 2 ln 2.
    let scale = (square / (2.0 * std::f64::consts::LN_2)).sqrt();
    Ok(RobustStart { fit, scale })
}

fn median_square(lens: &KnownLens<f64>, fit: &Fit<f64>, judges: &[&Measurement]) -> f64 {
    median(
        judges
            .iter()
            .map(|measurement| square(lens, fit, measurement))
            .collect(),
    )
}

fn square(lens: &KnownLens<f64>, fit: &Fit<f64>, measurement: &Measurement) -> f64 {
    let [x, y] = residuals_in_sigma(lens, fit, measurement);
    x * x + y * y
}

/// Refits the better half of the measurements until the median no longer falls.
fn concentrated(
    lens: &KnownLens<f64>,
    options: FitOptions,
    mut fit: Fit<f64>,
    judges: &[&Measurement],
) -> (f64, Fit<f64>) {
    let mut best = median_square(lens, &fit, judges);
    for _ in 0..STEPS {
        let half = judges
            .iter()
            .copied()
            .filter(|measurement| square(lens, &fit, measurement) <= best);
        let adjustment: Adjustment<f64> = adjusted(lens, options, half);
        let Ok(next) = adjustment.fit() else { break };
        let square = median_square(lens, &next, judges);
        if square >= best {
            break;
        }
        (best, fit) = (square, next);
    }
    (best, fit)
}

/// Sequence of evenly distributed numbers, always the same: `SplitMix64` (Steele, Lea and Flood
/// 2014).
struct Draw(u64);

impl Draw {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        let count = u64::try_from(count).unwrap_or(u64::MAX).max(1);
        usize::try_from(z % count).unwrap_or(0)
    }
}
