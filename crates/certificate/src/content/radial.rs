//! Radial distortion of a lens, Gaussian and balanced, with its standard deviation.

use fmc_camera_file::CameraFile;
use fmc_reference::lens::Lens;
use serde::Serialize;

use crate::calibration_summary::CalibrationSummary;
use crate::stated::Stated;

/// Radii of the profile from the principal point to the farthest corner.
pub(super) const PROFILE_POINTS: u32 = 41;
/// Halvings of the interval in which the balanced principal distance is looked for.
const HALVINGS: u32 = 100;
/// Steps of the fixed-point iteration for the measured radius of a field angle; the slope of the
/// distortion of a camera file is at most a half.
const ITERATIONS: u32 = 60;

/// Radial distortion and decentring at one distance from the principal point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RadialRow {
    /// Field angle of the ideal point, degrees.
    pub angle_deg: Option<Stated>,
    /// Radius of the measured point, mm.
    pub radius_mm: Option<Stated>,
    /// Radial distortion at f, measured - ideal, µm.
    pub gaussian_um: Option<Stated>,
    /// Radial distortion at the balanced principal distance, µm.
    pub balanced_um: Option<Stated>,
    /// Standard deviation of the radial distortion at f, µm.
    pub sigma_um: Option<Stated>,
    /// Decentring profile P(r) = r²·√(P1² + P2²), µm: its tangential component is at most P(r), its
    /// radial component at most 3P(r).
    pub decentring_um: Option<Stated>,
}

/// Radial functions of a lens.
pub(super) struct Radial<'a> {
    pub(super) lens: Lens,
    principal_distance_mm: f64,
    /// Share q by which the balanced principal distance is longer: f(1 + q).
    pub(super) balance: f64,
    summary: Option<&'a CalibrationSummary>,
}

impl<'a> Radial<'a> {
    pub(super) fn new(
        camera: &CameraFile,
        corner_mm: f64,
        calibrations: &'a [CalibrationSummary],
    ) -> Self {
        let mut radial = Self {
            lens: Lens::of(camera),
            principal_distance_mm: camera.principal_distance_mm,
            balance: 0.0,
            summary: None,
        };
        radial.summary = calibrations.iter().find(|one| radial.has_covariance(one));
        radial.balance = radial.balanced(corner_mm);
        radial
    }

    /// Returns the radial distortion at f, mm: K0·r + K1·r³ + K2·r⁵ + K3·r⁷.
    pub(super) fn gaussian_mm(&self, r: f64) -> f64 {
        let [k0, k1, k2, k3] = self.lens.k;
        let r2 = r * r;
        r * (k0 + r2 * (k1 + r2 * (k2 + r2 * k3)))
    }

    /// Returns the radial distortion at the balanced principal distance, mm: ideal points are
    /// 1 + q as far out as at f.
    pub(super) fn balanced_mm(&self, r: f64) -> f64 {
        self.at_balance(r, self.balance)
    }

    fn at_balance(&self, r: f64, balance: f64) -> f64 {
        let gaussian = self.gaussian_mm(r);
        gaussian - balance * (r - gaussian)
    }

    /// Returns the share q that makes the largest radial distortion least: a convex function of q,
    /// halved by its slope, with the sign of the largest distortion.
    fn balanced(&self, corner_mm: f64) -> f64 {
        let radii = || (1..PROFILE_POINTS).map(|index| corner_mm * share(index));
        let ratio = |r: f64| {
            let gaussian = self.gaussian_mm(r);
            gaussian / (r - gaussian)
        };
        let mut least = radii().map(ratio).fold(f64::INFINITY, f64::min);
        let mut most = radii().map(ratio).fold(f64::NEG_INFINITY, f64::max);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(least, most);
            let distortions = radii().map(|r| self.at_balance(r, middle));
            let largest = distortions.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
            if largest > 0.0 {
                least = middle;
            } else {
                most = middle;
            }
        }
        f64::midpoint(least, most)
    }

    /// Returns true if a calibration states σ of every radial coefficient other than zero, and
    /// their correlations.
    fn has_covariance(&self, summary: &CalibrationSummary) -> bool {
        let names = self.radial_names();
        let sigma = |name: &str| sigma(summary, name);
        !names.is_empty()
            && names.iter().all(|name| sigma(name).is_some())
            && names.iter().all(|a| {
                let mut others = names.iter();
                others.all(|b| summary.correlation(a, b).is_some())
            })
    }

    fn radial_names(&self) -> Vec<&'static str> {
        let names = ["k0", "k1", "k2", "k3"].into_iter().zip(self.lens.k);
        names
            .filter(|(_, k)| k.abs() > 0.0)
            .map(|(name, _)| name)
            .collect()
    }

    /// Returns σ of the radial distortion at f, mm, from those of K0 to K3 and their correlations.
    fn sigma_mm(&self, r: f64) -> Option<f64> {
        let summary = self.summary?;
        let effect = |name: &str| {
            let power = ["k0", "k1", "k2", "k3"]
                .iter()
                .position(|one| *one == name)?;
            let power = i32::try_from(2 * power + 1).ok()?;
            Some(sigma(summary, name)? * r.powi(power))
        };
        let names = self.radial_names();
        let mut variance = 0.0;
        for a in &names {
            for b in &names {
                variance += effect(a)? * effect(b)? * summary.correlation(a, b)?;
            }
        }
        Some(variance.max(0.0).sqrt())
    }

    pub(super) fn row(&self, r: f64) -> RadialRow {
        let um = |mm: f64| Stated::decimals(1e3 * mm, 3);
        let [p1, p2] = self.lens.p;
        let ideal = r - self.gaussian_mm(r);
        let angle = (ideal / self.principal_distance_mm).atan().to_degrees();
        RadialRow {
            angle_deg: Stated::decimals(angle, 3),
            radius_mm: Stated::decimals(r, 4),
            gaussian_um: um(self.gaussian_mm(r)),
            balanced_um: um(self.balanced_mm(r)),
            sigma_um: self.sigma_mm(r).and_then(um),
            decentring_um: um(r * r * p1.hypot(p2)),
        }
    }

    /// Returns rows at even field angles up to the farthest corner.
    pub(super) fn at_angles(&self, corner_mm: f64) -> Vec<RadialRow> {
        let ideal = corner_mm - self.gaussian_mm(corner_mm);
        let most = (ideal / self.principal_distance_mm).atan().to_degrees();
        let step = step(most, 9.0);
        (1..40)
            .map(|index| step * f64::from(index))
            .take_while(|angle| *angle <= most)
            .map(|angle| {
                let ideal = self.principal_distance_mm * angle.to_radians().tan();
                let mut r = ideal;
                for _ in 0..ITERATIONS {
                    r = ideal + self.gaussian_mm(r);
                }
                self.row(r)
            })
            .collect()
    }

    /// Returns rows at even radii, and at the farthest corner.
    pub(super) fn at_radii(&self, corner_mm: f64) -> Vec<RadialRow> {
        let step = step(corner_mm, 9.0);
        (1..40)
            .map(|index| step * f64::from(index))
            .take_while(|r| *r < corner_mm - 0.2 * step)
            .chain([corner_mm])
            .map(|r| self.row(r))
            .collect()
    }
}

fn sigma(summary: &CalibrationSummary, name: &str) -> Option<f64> {
    let parameter = summary.parameters.iter().find(|one| one.name == name)?;
    parameter.sigma
}

/// Returns the radius of a point of the profile as a share of the farthest corner's.
pub(super) fn share(index: u32) -> f64 {
    f64::from(index) / f64::from(PROFILE_POINTS - 1)
}

/// Returns the least of 1, 2, 2.5 and 5 times a power of ten that divides a range into at most so
/// many steps.
fn step(range: f64, most: f64) -> f64 {
    let decade = 10.0_f64.powf((range / most).log10().floor());
    [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * decade)
        .find(|step| range / step <= most)
        .unwrap_or(range)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radial(k: [f64; 4]) -> Radial<'static> {
        let mut radial = Radial {
            lens: Lens {
                k,
                p: [0.0; 2],
                b: [0.0; 2],
            },
            principal_distance_mm: 100.0,
            balance: 0.0,
            summary: None,
        };
        radial.balance = radial.balanced(50.0);
        radial
    }

    #[test]
    fn balanced_distortion_has_equal_extremes_of_both_signs() {
        let radial = radial([0.0, -1e-6, 0.0, 0.0]);
        let values: Vec<f64> = (0..=500)
            .map(|index| radial.balanced_mm(0.1 * f64::from(index)))
            .collect();
        let most = values.iter().copied().fold(0.0, f64::max);
        let least = values.iter().copied().fold(0.0, f64::min);
        // Of a cubic alone: a quarter of the distortion at the edge, 125 µm, at half the radius.
        assert!((most + least).abs() < 0.002 * most, "{most} {least}");
        assert!((most - 0.25 * 0.125).abs() < 0.001, "{most}");
        assert!(
            (radial.balance + 0.75 * 2.5e-3).abs() < 1e-5,
            "{}",
            radial.balance
        );
    }

    #[test]
    fn gauge_is_undone_by_the_balance() {
        let radial = radial([1e-4, 0.0, 0.0, 0.0]);
        assert!((1.0 + radial.balance - 1.0 / (1.0 - 1e-4)).abs() < 1e-12);
        assert!(radial.balanced_mm(30.0).abs() < 1e-12);
    }

    #[test]
    fn sigma_is_that_of_the_coefficients_with_their_correlation() {
        let text = r#"{"parameters":[{"name":"k1","value":-1e-6,"sigma":1e-9},
            {"name":"k2","value":1e-10,"sigma":1e-12}],
            "correlations":[{"a":"k1","b":"k2","value":-0.9}]}"#;
        let summary = CalibrationSummary::parse("s", text.as_bytes()).unwrap();
        let mut radial = radial([0.0, -1e-6, 1e-10, 0.0]);
        assert!(radial.has_covariance(&summary));
        radial.summary = Some(&summary);
        let (a, b) = (1e-9 * 2.7e4_f64, 1e-12 * 2.43e7_f64);
        let expected = (a * a + b * b - 1.8 * a * b).sqrt();
        assert!((radial.sigma_mm(30.0).unwrap() - expected).abs() < 1e-15);
        radial.lens.k = [0.0, -1e-6, 1e-10, 1e-15];
        assert!(!radial.has_covariance(&summary));
    }

    #[test]
    fn steps_are_round() {
        for (range, expected) in [
            (38.0, 5.0),
            (33.4, 5.0),
            (161.6, 20.0),
            (9.0, 1.0),
            (22.0, 2.5),
        ] {
            assert!((step(range, 9.0) - expected).abs() < 1e-12, "{range}");
        }
    }
}
