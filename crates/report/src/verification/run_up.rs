//! The comparison of the treatments of distortion, run-up by run-up, in words.

use fmc_reference::verification::result::{ErrorStatistics, FrameResult, Verification};

use crate::{length, wording};

/// The exposures of all cameras with one run-up strategy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct RunUp {
    pub(super) strategy: String,
    /// Largest error of each treatment, with its unit.
    pub(super) largest_errors: Vec<String>,
}

/// Returns every strategy that occurs, in order of appearance.
pub(super) fn all(verification: &Verification) -> Vec<RunUp> {
    let frames = || {
        verification
            .cameras
            .iter()
            .flat_map(|camera| &camera.frames)
    };
    let mut strategies: Vec<&str> = Vec::new();
    for frame in frames() {
        if !strategies.contains(&frame.strategy) {
            strategies.push(frame.strategy);
        }
    }
    strategies
        .into_iter()
        .map(|strategy| RunUp {
            strategy: wording::strategy(strategy).to_owned(),
            largest_errors: largest(frames().filter(|frame| frame.strategy == strategy)),
        })
        .collect()
}

fn largest<'a>(frames: impl Iterator<Item = &'a FrameResult>) -> Vec<String> {
    let mut all = [ErrorStatistics::default(); 4];
    for frame in frames {
        for (sum, errors) in all.iter_mut().zip(&frame.errors) {
            sum.merge(errors);
        }
    }
    all.map(|errors| length::text(errors.max_mm())).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verification::fixture;

    #[test]
    fn every_strategy_has_its_row_with_the_largest_error_of_all_cameras() {
        let run_ups = all(&fixture::passing());
        let strategies: Vec<&str> = run_ups.iter().map(|row| row.strategy.as_str()).collect();
        assert_eq!(strategies, ["centred run-up", "run-up from rest"]);
        let errors = &run_ups[1].largest_errors;
        assert_eq!(errors, &["500 µm", "500 nm", "1.50 µm", "0.20 nm"]);
    }
}
