//! The formulas of Li et al. for principal distance and principal point from angles.

use nalgebra::{DMatrix, DVector};

/// Degree of the polynomial f(L) of (6).
const QUARTIC: usize = 4;

/// |tan W| below which a point is left out of the quartic: f(L) = L/tanW is 0/0 there.
const LEAST_TANGENT: f64 = 1e-6;

/// f and p of a formula, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistancePoint {
    /// Principal distance.
    pub f_mm: f64,
    /// Principal point from the zero of L.
    pub p_mm: f64,
}

/// Place on the line and angle of a target, mm and tangent.
pub type Ray = (f64, f64);

/// Returns f and p of (2): least squares of `D = L - f·tanW + p·tan²W`; `None` if the angles do
/// not determine both.
#[must_use]
pub fn both(rays: &[Ray]) -> Option<DistancePoint> {
    let sum = |power: i32| rays.iter().map(|(_, t)| t.powi(power)).sum::<f64>();
    let with = |power: i32| rays.iter().map(|(l, t)| l * t.powi(power)).sum::<f64>();
    let (s2, s3, s4) = (sum(2), sum(3), sum(4));
    let determinant = s3 * s3 - s2 * s4;
    let f = (with(2) * s3 - with(1) * s4) / determinant;
    let p = (with(2) * s2 - with(1) * s3) / determinant;
    (f.is_finite() && p.is_finite() && determinant.abs() > 1e-12 * s2 * s4)
        .then_some(DistancePoint { f_mm: f, p_mm: p })
}

/// Returns f of (3), p = 0; `None` without an angle other than zero.
#[must_use]
pub fn distance_alone(rays: &[Ray]) -> Option<f64> {
    let squares: f64 = rays.iter().map(|(_, t)| t * t).sum();
    let products: f64 = rays.iter().map(|(l, t)| l * t).sum();
    (squares > 0.0).then(|| products / squares)
}

/// Returns p of (4) for a known f; `None` without an angle other than zero.
#[must_use]
pub fn point_alone(rays: &[Ray], f_mm: f64) -> Option<f64> {
    let fourth: f64 = rays.iter().map(|(_, t)| t.powi(4)).sum();
    let sum: f64 = rays.iter().map(|(l, t)| f_mm * t.powi(3) - l * t * t).sum();
    (fourth > 0.0).then(|| sum / fourth)
}

/// Returns f0 = f(0) of the quartic (6) through f(L) = L/tanW of (5), weighted by tanW, points
/// with W = 0 left out; `None` for fewer points than its coefficients.
#[must_use]
pub fn quartic(rays: &[Ray]) -> Option<f64> {
    let scale = rays.iter().map(|(l, _)| l.abs()).fold(0.0, f64::max);
    let used: Vec<&Ray> = rays
        .iter()
        .filter(|(_, t)| t.abs() > LEAST_TANGENT)
        .collect();
    if used.len() <= QUARTIC || scale <= 0.0 {
        return None;
    }
    let rows: Vec<f64> = used
        .iter()
        .flat_map(|(l, t)| {
            let place = l / scale;
            let powers: [f64; QUARTIC + 1] =
                std::array::from_fn(|power| t * place.powi(i32::try_from(power).unwrap_or(0)));
            powers
        })
        .collect();
    // tanW·f(L) = L.
    let right = used.iter().map(|(l, _)| *l).collect();
    solve(used.len(), QUARTIC + 1, &rows, right)?
        .first()
        .copied()
}

/// Returns f0 and p of the direct fit `L = c + f0·T - p·T² + a3·T³ + a4·T⁴ + a5·T⁵`; `None` for
/// fewer points than coefficients.
#[must_use]
pub fn direct(rays: &[Ray]) -> Option<DistancePoint> {
    const TERMS: usize = 6;
    let scale = rays.iter().map(|(_, t)| t.abs()).fold(0.0, f64::max);
    if rays.len() < TERMS || scale <= 0.0 {
        return None;
    }
    let rows: Vec<f64> = rays
        .iter()
        .flat_map(|(_, t)| {
            let place = t / scale;
            let powers: [f64; TERMS] =
                std::array::from_fn(|power| place.powi(i32::try_from(power).unwrap_or(0)));
            powers
        })
        .collect();
    let right = rays.iter().map(|(l, _)| *l).collect();
    let found = solve(rays.len(), TERMS, &rows, right)?;
    Some(DistancePoint {
        f_mm: found.get(1)? / scale,
        p_mm: -found.get(2)? / scale.powi(2),
    })
}

fn solve(rows: usize, columns: usize, design: &[f64], right: Vec<f64>) -> Option<Vec<f64>> {
    let svd = DMatrix::from_row_slice(rows, columns, design).svd(true, true);
    if svd.singular_values.min() <= 1e-12 * svd.singular_values.max() {
        return None;
    }
    let solution = svd.solve(&DVector::from_vec(right), 0.0).ok()?;
    Some(solution.as_slice().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 29 points over ±18° of a lens without distortion.
    fn rays(f: f64, p: f64) -> Vec<Ray> {
        (-14..=14)
            .map(|index| {
                let t = (18.0 * f64::from(index) / 14.0).to_radians().tan();
                (f * t - p * t * t, t)
            })
            .collect()
    }

    #[test]
    fn formulas_return_their_own_model() {
        let rays = rays(218.0, 0.065);
        let found = both(&rays).unwrap();
        assert!((found.f_mm - 218.0).abs() < 1e-10 && (found.p_mm - 0.065).abs() < 1e-10);
        assert!((distance_alone(&rays).unwrap() - 218.0).abs() < 1e-10);
        assert!((point_alone(&rays, 218.0).unwrap() - 0.065).abs() < 1e-10);
        let found = direct(&rays).unwrap();
        assert!((found.f_mm - 218.0).abs() < 1e-9 && (found.p_mm - 0.065).abs() < 1e-9);
        assert!((quartic(&rays).unwrap() - 218.0).abs() < 1e-6);
    }

    #[test]
    fn too_few_points_have_no_formula() {
        assert_eq!(both(&[(0.0, 0.0), (1.0, 0.1)]), None);
        assert_eq!(quartic(&rays(218.0, 0.0)[..4]), None);
        assert_eq!(direct(&rays(218.0, 0.0)[..5]), None);
        assert_eq!(distance_alone(&[(0.0, 0.0)]), None);
    }
}
