//! Outcome of one adjustment of one run.

use fmc_adjustment::bundle::calibration::BundleCalibration;
use fmc_adjustment::bundle::record_tests::{check_points_rms_m, difference_rms_m};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Probability that a right σ0 is beyond [`Outcome::sigma0_limit`].
pub const SIGMA0_ERROR: f64 = 0.05;

/// Numbers of an adjustment.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Check points along the strips, across and in height, root mean square, m.
    pub check_m: [f64; 3],
    /// σ0.
    pub sigma0: f64,
    /// Redundancy.
    pub redundancy: usize,
    /// Value that a right σ0 exceeds with the probability [`SIGMA0_ERROR`].
    pub sigma0_limit: f64,
    /// Object points of this adjustment less those with records, root mean square by axis, m.
    pub from_records_m: [f64; 3],
    /// Frames whose records are named one after the other; those of the variant with records alone
    /// are tested.
    pub named: Vec<String>,
}

impl Outcome {
    /// Takes the numbers of an adjustment, beside the one with records.
    pub(super) fn of(
        calibration: &BundleCalibration,
        with_records: &BundleCalibration,
        named: Vec<String>,
    ) -> Self {
        let solution = &calibration.snooped.solution;
        Self {
            check_m: check_points_rms_m(calibration).unwrap_or([f64::NAN; 3]),
            sigma0: solution.sigma0(),
            redundancy: solution.redundancy(),
            sigma0_limit: sigma0_limit(solution.redundancy()),
            from_records_m: difference_rms_m(calibration, with_records).unwrap_or([f64::NAN; 3]),
            named,
        }
    }

    /// Returns true if σ0 is beyond its limit.
    #[must_use]
    pub fn is_beyond(&self) -> bool {
        self.sigma0 > self.sigma0_limit
    }
}

/// Returns √(χ²/r), the quantile of σ0 at 1 - [`SIGMA0_ERROR`].
fn sigma0_limit(redundancy: usize) -> f64 {
    let freedom = f64::from(u32::try_from(redundancy).unwrap_or(u32::MAX));
    ChiSquared::new(freedom).map_or(f64::INFINITY, |chi2| {
        (chi2.inverse_cdf(1.0 - SIGMA0_ERROR) / freedom).sqrt()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limit_of_sigma0_is_the_tabulated_quantile() {
        // χ²(10; 0.95) = 18.307, χ²(3380; 0.95) by Wilson and Hilferty.
        assert!((sigma0_limit(10) - 1.8307_f64.sqrt()).abs() < 1e-4);
        assert!((sigma0_limit(3380) - 1.0200).abs() < 2e-4);
        assert!(sigma0_limit(0).is_infinite());
    }
}
