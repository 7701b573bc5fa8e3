//! Radial and decentring profile of a calibrated lens.

use fmc_adjustment::calibration::result::CalibrationResult;
use serde::Serialize;

/// Names of the coefficients of the radial profile, lowest power first.
const RADIAL: [&str; 4] = ["k0", "k1", "k2", "k3"];

/// Radii at which the balanced profile is sought.
const STEPS: u32 = 400;

/// Step of the field angle in the table, degrees.
const ANGLE_STEP_DEG: f64 = 5.0;

/// One row of the profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ProfileRow {
    /// Field angle, degrees.
    pub angle_deg: f64,
    /// Measured radius, mm.
    pub radius_mm: f64,
    /// Radial distortion about f, measured - ideal, µm.
    pub gaussian_um: f64,
    /// Radial distortion about the balanced principal distance, µm.
    pub balanced_um: f64,
    /// σ of the radial distortion, µm; 0 if no coefficient was estimated.
    pub sigma_um: f64,
    /// Length of the decentring distortion, √(P1²+P2²)·r², µm.
    pub decentring_um: f64,
    /// σ of it, µm.
    pub decentring_sigma_um: f64,
}

/// Profiles of a lens.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Profile {
    /// Principal distance for which the largest positive and negative distortion of the format
    /// are equal, mm.
    pub balanced_distance_mm: f64,
    /// Radius of the farthest corner, mm.
    pub format_radius_mm: f64,
    /// Rows at field angles, and at the farthest corner.
    pub rows: Vec<ProfileRow>,
}

impl Profile {
    /// Returns the profile of a calibration.
    ///
    /// # Model
    /// Gaussian: `D(r) = K0·r + K1·r³ + K2·r⁵ + K3·r⁷` about f. Balanced:
    /// `r - (r - D(r))·f_b/f`, with `f_b` such that its largest absolute value over the format is
    /// least. Decentring: `P(r) = √(P1² + P2²)·r²`. σ by the covariance matrix, multiplied by σ0.
    #[must_use]
    pub fn of(result: &CalibrationResult) -> Self {
        let radius = result.coverage().format_radius_mm;
        let scale = balanced_scale(result, radius);
        let distance = result.calibrated.principal_distance_mm;
        let mut rows = Vec::new();
        let mut angle_deg: f64 = 0.0;
        while angle_deg < 89.0 {
            let Some(radius_mm) = measured_radius(result, distance * angle_deg.to_radians().tan())
            else {
                break;
            };
            if radius_mm >= radius {
                break;
            }
            rows.push(row(result, scale, radius_mm));
            angle_deg += ANGLE_STEP_DEG;
        }
        rows.push(row(result, scale, radius));
        Self {
            balanced_distance_mm: distance * scale,
            format_radius_mm: radius,
            rows,
        }
    }

    /// Returns rows at evenly spaced radii, for a figure.
    #[must_use]
    pub fn curve(result: &CalibrationResult, steps: u32) -> Vec<ProfileRow> {
        let radius = result.coverage().format_radius_mm;
        let scale = balanced_scale(result, radius);
        (0..=steps)
            .map(|step| row(result, scale, radius * f64::from(step) / f64::from(steps)))
            .collect()
    }
}

fn row(result: &CalibrationResult, scale: f64, radius_mm: f64) -> ProfileRow {
    let r = radius_mm;
    let distortion = &result.calibrated.distortion;
    let gaussian = gaussian(result, r);
    let ideal = r - gaussian;
    let powers = [r, r.powi(3), r.powi(5), r.powi(7)];
    let mut variance = 0.0;
    for (a, at_a) in RADIAL.into_iter().zip(powers) {
        for (b, at_b) in RADIAL.into_iter().zip(powers) {
            variance += at_a * at_b * result.covariance(a, b);
        }
    }
    let [p1, p2] = [distortion.p1, distortion.p2];
    let size = p1.hypot(p2);
    // Direction of (P1, P2); along it σ of the length is taken.
    let [u, v] = if size > 0.0 {
        [p1 / size, p2 / size]
    } else {
        [1.0, 0.0]
    };
    let decentring_variance = u * u * result.covariance("p1", "p1")
        + 2.0 * u * v * result.covariance("p1", "p2")
        + v * v * result.covariance("p2", "p2");
    ProfileRow {
        angle_deg: (ideal / result.calibrated.principal_distance_mm)
            .atan()
            .to_degrees(),
        radius_mm,
        gaussian_um: 1e3 * gaussian,
        balanced_um: 1e3 * (r - ideal * scale),
        sigma_um: 1e3 * variance.max(0.0).sqrt(),
        decentring_um: 1e3 * size * r * r,
        decentring_sigma_um: 1e3 * decentring_variance.max(0.0).sqrt() * r * r,
    }
}

fn gaussian(result: &CalibrationResult, r: f64) -> f64 {
    let distortion = &result.calibrated.distortion;
    let square = r * r;
    r * (distortion.k0
        + square * (distortion.k1 + square * (distortion.k2 + square * distortion.k3)))
}

/// Returns the measured radius of an ideal one, mm; `None` where the iteration does not converge.
fn measured_radius(result: &CalibrationResult, ideal: f64) -> Option<f64> {
    let mut r = ideal;
    for _ in 0..200 {
        let next = ideal + gaussian(result, r);
        if !next.is_finite() {
            return None;
        }
        if (next - r).abs() <= 1e-9 {
            return Some(next);
        }
        r = next;
    }
    None
}

/// Returns `f_b/f` for which the largest absolute distortion over the format is least: a golden
/// section search of a convex function.
fn balanced_scale(result: &CalibrationResult, radius: f64) -> f64 {
    let largest = |scale: f64| {
        (1..=STEPS)
            .map(|step| {
                let r = radius * f64::from(step) / f64::from(STEPS);
                (r - (r - gaussian(result, r)) * scale).abs()
            })
            .fold(0.0, f64::max)
    };
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (0.5, 1.5);
    for _ in 0..80 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if largest(a) < largest(b) {
            high = b;
        } else {
            low = a;
        }
    }
    f64::midpoint(low, high)
}
