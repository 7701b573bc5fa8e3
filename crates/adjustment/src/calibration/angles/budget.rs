//! Error budget of the distortion by the precise-angle method.

use super::methods::{Ray, both, quartic};

/// Uncertainties of a measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// σ of a place L, mm.
    pub place_mm: f64,
    /// σ of an angle W, rad.
    pub angle_rad: f64,
}

/// σ of the distortion at one angle, mm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BudgetRow {
    /// (7) as printed.
    pub printed_mm: f64,
    /// (7) with its two misprints mended; without that of p, for which the paper has no formula.
    pub mended_mm: f64,
    /// From the covariance of D about f0 of the quartic and p of (2).
    pub covariance_mm: f64,
}

/// Returns the budget at the angles of the rays, in their order; `None` if f and p are not
/// determined.
///
/// # Model
/// Li et al. (7): `δ_D² = δ_L² + (∂D/∂W)²·δ_W² + tan²W·δ_f²`. Printed: `∂D/∂W = -f·sec²W -
/// 2p·tanW·sec²W`, first term of `δ_f²` is `δ_L²/(Σtan²W)²`. Mended: `+ 2p·tanW·sec²W` and
/// `δ_L²/Σtan²W`; f is f0 of the quartic, p that of (2). Covariance: derivatives of D, by
/// differences, by every place and every angle.
#[must_use]
pub fn budget(rays: &[Ray], uncertainty: Uncertainty) -> Option<Vec<BudgetRow>> {
    let Uncertainty {
        place_mm,
        angle_rad,
    } = uncertainty;
    let p_mm = both(rays)?.p_mm;
    let f_mm = quartic(rays)?;
    let squares: f64 = rays.iter().map(|(_, t)| t * t).sum();
    let by_angle: f64 = rays
        .iter()
        .map(|(l, t)| (l * (1.0 + t * t) / squares * angle_rad).powi(2))
        .sum();
    let printed_f = (place_mm / squares).powi(2) + by_angle;
    let mended_f = place_mm.powi(2) / squares + by_angle;
    let covariance = covariance(rays, uncertainty)?;
    let rows = rays.iter().zip(covariance).map(|((_, t), covariance_mm)| {
        let secant = 1.0 + t * t;
        let slope = |sign: f64| secant * (-f_mm + sign * 2.0 * p_mm * t);
        let total = |slope: f64, distance: f64| {
            (place_mm.powi(2) + (slope * angle_rad).powi(2) + t * t * distance).sqrt()
        };
        BudgetRow {
            printed_mm: total(slope(-1.0), printed_f),
            mended_mm: total(slope(1.0), mended_f),
            covariance_mm,
        }
    });
    Some(rows.collect())
}

/// Returns D of every ray about f0 of the quartic and p of (2), mm.
#[must_use]
pub fn paraxial_distortions(rays: &[Ray]) -> Option<Vec<f64>> {
    let f0 = quartic(rays)?;
    let p = both(rays)?.p_mm;
    Some(rays.iter().map(|(l, t)| l - f0 * t + p * t * t).collect())
}

fn covariance(rays: &[Ray], uncertainty: Uncertainty) -> Option<Vec<f64>> {
    let mut variances = vec![0.0; rays.len()];
    for index in 0..rays.len() {
        // Differences over one σ: the formulas are all but linear in them.
        for by_place in [true, false] {
            let changed = |sign: f64| {
                let mut rays = rays.to_vec();
                let (l, t) = rays.get_mut(index)?;
                if by_place {
                    *l += sign * uncertainty.place_mm;
                } else {
                    *t = (t.atan() + sign * uncertainty.angle_rad).tan();
                }
                paraxial_distortions(&rays)
            };
            let (plus, minus) = (changed(1.0)?, changed(-1.0)?);
            for ((variance, plus), minus) in variances.iter_mut().zip(plus).zip(minus) {
                *variance += (0.5 * (plus - minus)).powi(2);
            }
        }
    }
    Some(variances.into_iter().map(f64::sqrt).collect())
}
