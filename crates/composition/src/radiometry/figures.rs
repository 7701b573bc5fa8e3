//! Figures of a detector, in the terms of EMVA 1288.

/// Least temporal variance of dark frames, DN²: below it quantisation rules (EMVA 1288).
const LEAST_DARK_VARIANCE: f64 = 0.24;
/// Variance of quantisation, DN².
const QUANTISATION: f64 = 1.0 / 12.0;

/// Figures of a detector, with the names and units of EMVA 1288, Releases 3.1 and 4.0.
///
/// # Model
/// The standard takes two frames at every level; here the sets of flats are one frame each, and
/// temporal noise is what a pixel leaves of its own straight line over all sets. Non-uniformities
/// are deviations within blocks of 16 x 16 pixels, where the standard has a high-pass filter;
/// temporal noise is subtracted from them, as there.
///
/// Quantum efficiency and responsivity need photons per pixel, dark current needs darks of several
/// exposure times: neither is determined.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct DetectorFigures {
    /// K, overall system gain, DN per electron.
    pub gain_dn_per_e: f64,
    /// Mean of the dark frames, DN.
    pub dark_dn: f64,
    /// `σ_y.dark`, temporal dark noise, DN; of two darks or more, else of the noise of the flats.
    pub temporal_dark_noise_dn: f64,
    /// `σ_d`, temporal dark noise without quantisation, electrons.
    pub temporal_dark_noise_e: f64,
    /// DSNU1288, DN.
    pub dsnu_dn: f64,
    /// DSNU1288, electrons.
    pub dsnu_e: f64,
    /// PRNU1288, percent.
    pub prnu_percent: f64,
    /// `μ_e.sat`, electrons between dark and the sample from which on pixels count as saturated.
    pub saturation_capacity_e: f64,
    /// `SNR_max`, dB.
    pub snr_max_db: f64,
    /// `μ_e.min`, absolute sensitivity threshold, electrons.
    pub absolute_sensitivity_threshold_e: f64,
    /// DR, dynamic range, dB.
    pub dynamic_range_db: f64,
    /// Linearity; `None` where the light of the sets is not known.
    pub linearity: Option<Linearity>,
    /// Defective pixels.
    pub defects: usize,
}

impl DetectorFigures {
    /// Completes the figures that follow from gain, dark noise, non-uniformities and the signal at
    /// saturation, DN.
    pub(super) fn complete(&mut self, dark_variance: f64, saturation_dn: f64) {
        let variance = dark_variance.max(LEAST_DARK_VARIANCE);
        let gain = self.gain_dn_per_e;
        self.temporal_dark_noise_dn = variance.sqrt();
        if gain <= 0.0 {
            return;
        }
        self.temporal_dark_noise_e = (variance - QUANTISATION).sqrt() / gain;
        self.dsnu_e = self.dsnu_dn / gain;
        self.saturation_capacity_e = (saturation_dn / gain).max(0.0);
        self.absolute_sensitivity_threshold_e = (variance / (gain * gain) + 0.25).sqrt() + 0.5;
        self.snr_max_db = 10.0 * self.saturation_capacity_e.log10();
        self.dynamic_range_db =
            20.0 * (self.saturation_capacity_e / self.absolute_sensitivity_threshold_e).log10();
    }
}

/// Linearity of a detector.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Linearity {
    /// LE, mean of the absolute deviations, percent (Release 4.0).
    pub error_percent: f64,
    /// `LE_min`, percent (Release 3.1).
    pub least_percent: f64,
    /// `LE_max`, percent (Release 3.1).
    pub largest_percent: f64,
    /// Sets from 5 to 95 % of saturation, which take part.
    pub sets: usize,
}

/// Parts of the saturation between which sets take part.
const RANGE: std::ops::RangeInclusive<f64> = 0.05..=0.95;
/// Least number of sets of which two determine the line.
const LEAST_SETS: usize = 3;

impl Linearity {
    /// Returns the linearity from the light of every set, in any unit, and its mean signal less
    /// dark, DN; `None` with fewer than three sets from 5 to 95 % of saturation, or of one light.
    ///
    /// # Model
    /// `y = a₀ + a₁ H` by least squares of the relative deviations (weights 1/y²), and
    /// `δ = 100 (y - a₀ - a₁ H)/(a₀ + a₁ H)`.
    #[must_use]
    pub fn of(light: &[f64], signal_dn: &[f64], saturation_dn: f64) -> Option<Self> {
        let pairs: Vec<(f64, f64)> = light
            .iter()
            .copied()
            .zip(signal_dn.iter().copied())
            .filter(|(_, signal)| RANGE.contains(&(signal / saturation_dn)))
            .collect();
        if pairs.len() < LEAST_SETS {
            return None;
        }
        let most = pairs.iter().map(|(light, _)| *light).fold(0.0, f64::max);
        let (mut normals, mut right) = (nalgebra::Matrix2::zeros(), nalgebra::Vector2::zeros());
        for (light, signal) in &pairs {
            let row = nalgebra::Vector2::new(1.0, light / most) / *signal;
            normals += row * row.transpose();
            right += row;
        }
        let diagonal = normals.diagonal().product();
        if normals.determinant() < 1e-9 * diagonal {
            return None;
        }
        let [[constant, slope]] = normals.cholesky()?.solve(&right).data.0;
        let deviations: Vec<f64> = pairs
            .iter()
            .map(|(light, signal)| {
                let line = constant + slope * light / most;
                100.0 * (signal - line) / line
            })
            .collect();
        let sum: f64 = deviations.iter().map(|value| value.abs()).sum();
        Some(Self {
            error_percent: sum / crate::number::real(deviations.len()),
            least_percent: deviations.iter().copied().fold(f64::INFINITY, f64::min),
            largest_percent: deviations.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            sets: deviations.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_line_has_no_error_and_offset_is_none() {
        let light = [1.0, 2.0, 3.0, 4.0];
        let found = Linearity::of(&light, &[110.0, 210.0, 310.0, 410.0], 500.0).unwrap();
        assert!(found.error_percent < 1e-9 && found.sets == 4, "{found:?}");
    }

    /// Weighted least squares of three points by hand: y = 100, 200, 309 at H = 1, 2, 3.
    #[test]
    fn curve_has_the_deviations_of_the_weighted_line() {
        let (light, signal) = ([1.0, 2.0, 3.0], [100.0, 200.0, 309.0]);
        let found = Linearity::of(&light, &signal, 400.0).unwrap();
        let sum = |power_h: i32, power_y: i32| -> f64 {
            let pairs = light.iter().zip(&signal);
            pairs
                .map(|(h, y)| f64::powi(*h, power_h) / f64::powi(*y, power_y))
                .sum()
        };
        let (n, h, hh) = (sum(0, 2), sum(1, 2), sum(2, 2));
        let (y, hy) = (sum(0, 1), sum(1, 1));
        let constant = (y * hh - h * hy) / (n * hh - h * h);
        let slope = (n * hy - h * y) / (n * hh - h * h);
        let expected = 100.0 * (309.0 / (constant + 3.0 * slope) - 1.0);
        assert!(
            (found.largest_percent - expected).abs() < 1e-9,
            "{found:?} {expected}"
        );
        assert!(
            found.least_percent < 0.0 && found.error_percent > 0.1,
            "{found:?}"
        );
    }

    #[test]
    fn one_light_or_two_sets_in_the_range_determine_nothing() {
        assert_eq!(
            Linearity::of(&[2.0; 3], &[100.0, 101.0, 102.0], 400.0),
            None
        );
        assert_eq!(
            Linearity::of(&[1.0, 2.0, 9.0], &[100.0, 200.0, 900.0], 900.0),
            None
        );
    }

    #[test]
    fn figures_follow_from_gain_and_noise() {
        let mut figures = DetectorFigures {
            gain_dn_per_e: 0.5,
            dsnu_dn: 3.0,
            ..DetectorFigures::default()
        };
        figures.complete(100.0 + 1.0 / 12.0, 10_000.0);
        assert!((figures.temporal_dark_noise_e - 20.0).abs() < 1e-9);
        assert!((figures.dsnu_e - 6.0).abs() < 1e-12);
        assert!((figures.saturation_capacity_e - 20_000.0).abs() < 1e-9);
        assert!((figures.snr_max_db - 43.0103).abs() < 1e-4);
        // √(400.33 + 0.25) + 0.5 electrons.
        assert!((figures.absolute_sensitivity_threshold_e - 20.5145).abs() < 1e-3);
        assert!((figures.dynamic_range_db - 59.780).abs() < 1e-2);
    }
}
