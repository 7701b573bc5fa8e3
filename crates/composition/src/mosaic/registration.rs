//! One polynomial over the whole frame: registration to another image of the same ground.

use nalgebra::{DMatrix, DVector};

use crate::number::{median, real, rms};
use crate::rig::polynomial::{Polynomial, basis, normalised, terms};

/// Pairs per coefficient below which a registration is refused.
const LEAST_PAIRS_PER_TERM: usize = 2;
/// Deviation, in robust standard deviations, beyond which a pair is an outlier.
const OUTLIER: f64 = 4.0;
/// Rounds of rejection.
const ROUNDS: usize = 20;

/// A place of an image and its place in another one, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Place in the image.
    pub from_px: [f64; 2],
    /// Place in the other one.
    pub to_px: [f64; 2],
}

/// A polynomial over a frame, fitted to pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    /// Size of the image that the pairs come from, px.
    pub size_px: [usize; 2],
    /// The polynomial, of normalised places of that image.
    pub polynomial: Polynomial,
    /// Pairs that were kept.
    pub kept: usize,
    /// Pairs that were outliers.
    pub outliers: usize,
    /// Root mean square of a coordinate's residual over the kept pairs, px.
    pub residual_px: f64,
}

impl Registration {
    /// Fits a polynomial by least squares, with outliers rejected by the median of absolute
    /// deviations; `None` with fewer than two pairs per coefficient, or where they do not determine
    /// it.
    #[must_use]
    pub fn fit(size_px: [usize; 2], degree: usize, pairs: &[Pair]) -> Option<Self> {
        let mut kept: Vec<Pair> = pairs.to_vec();
        for _ in 0..ROUNDS {
            let found = Self::unweighted(size_px, degree, &kept)?;
            let distances = |list: &[Pair]| -> Vec<f64> {
                list.iter().map(|pair| found.distance_px(pair)).collect()
            };
            // Median of a Rayleigh distribution: 1.177 σ.
            let sigma = median(distances(&kept))? / 1.177;
            let limit = (OUTLIER * sigma).max(1e-6);
            let next: Vec<Pair> = pairs
                .iter()
                .copied()
                .filter(|pair| found.distance_px(pair) <= limit)
                .collect();
            if next == kept {
                return Some(Self {
                    outliers: pairs.len() - kept.len(),
                    ..found
                });
            }
            kept = next;
        }
        let found = Self::unweighted(size_px, degree, &kept)?;
        Some(Self {
            outliers: pairs.len() - kept.len(),
            ..found
        })
    }

    /// Fits a polynomial by least squares to all pairs; `None` as for [`Self::fit`].
    #[must_use]
    pub fn unweighted(size_px: [usize; 2], degree: usize, pairs: &[Pair]) -> Option<Self> {
        let count = terms(degree);
        if pairs.len() < LEAST_PAIRS_PER_TERM * count {
            return None;
        }
        let mut normals = DMatrix::zeros(count, count);
        let mut rights = [DVector::zeros(count), DVector::zeros(count)];
        for pair in pairs {
            let row = DVector::from_vec(basis(degree, normalised(size_px, pair.from_px)));
            normals += &row * row.transpose();
            for (right, value) in rights.iter_mut().zip(pair.to_px) {
                *right += &row * value;
            }
        }
        let cholesky = normals.cholesky()?;
        let inverse = cholesky.inverse();
        let [u, v] = rights.map(|right| cholesky.solve(&right).as_slice().to_vec());
        let mut found = Self {
            size_px,
            polynomial: Polynomial {
                degree,
                u,
                v,
                sigma_px: 0.0,
            },
            kept: pairs.len(),
            outliers: 0,
            residual_px: 0.0,
        };
        let residuals = pairs.iter().flat_map(|pair| {
            let [u, v] = found.at(pair.from_px);
            [u - pair.to_px[0], v - pair.to_px[1]]
        });
        found.residual_px = rms(residuals)?;
        // σ at the worst of the places that were measured.
        let redundancy = real(pairs.len() - count) / real(pairs.len());
        let sigma = found.residual_px / redundancy.sqrt();
        let cofactors = pairs.iter().map(|pair| {
            let row = DVector::from_vec(basis(degree, normalised(size_px, pair.from_px)));
            row.dot(&(&inverse * &row))
        });
        let largest = cofactors.fold(0.0, f64::max);
        found.polynomial.sigma_px = sigma * largest.max(0.0).sqrt();
        found
            .polynomial
            .u
            .iter()
            .all(|value| value.is_finite())
            .then_some(found)
    }

    /// Returns the place in the other image.
    #[must_use]
    pub fn at(&self, place_px: [f64; 2]) -> [f64; 2] {
        self.polynomial.value(normalised(self.size_px, place_px))
    }

    /// Returns the place in the image of a place in the other one; `None` beyond the range of the
    /// polynomial.
    #[must_use]
    pub fn inverse(&self, place_px: [f64; 2]) -> Option<[f64; 2]> {
        let start = normalised(self.size_px, place_px);
        let [xi, eta] = self.polynomial.inverse(place_px, start)?;
        let [width, height] = self.size_px.map(real);
        let half = height / 2.0;
        Some([xi * half + width / 2.0, eta * half + half])
    }

    fn distance_px(&self, pair: &Pair) -> f64 {
        let [u, v] = self.at(pair.from_px);
        (u - pair.to_px[0]).hypot(v - pair.to_px[1])
    }
}
