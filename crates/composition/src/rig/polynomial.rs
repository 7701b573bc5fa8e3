//! Polynomial from a sub-image to the virtual image.

use nalgebra::Matrix2;
use serde::{Deserialize, Serialize};

use crate::number::real;

/// Degrees that are offered.
pub const DEGREES: std::ops::RangeInclusive<usize> = 2..=5;

/// Steps of Newton's method for the inverse, which ends below [`INVERSE_PX`].
const STEPS: usize = 20;
/// Change of a place that ends the inverse, px.
const INVERSE_PX: f64 = 1e-9;

/// General polynomial of a sub-image.
///
/// # Model
/// `u = Σ_{i≤t} Σ_{j≤i} a_k ξ^(i-j) η^j`, `k = i(i+1)/2 + j`, and v with `b_k`: Zhao et al. 2013,
/// formula (1), with its index put right (`docs/errata.md`, Z1). ξ = (col - W/2)/(H/2) and
/// η = (row - H/2)/(H/2) of a sub-image of W x H px.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polynomial {
    /// t, 2 to 5.
    pub degree: usize,
    /// `a_k`, px of the virtual image.
    pub u: Vec<f64>,
    /// `b_k`, px of the virtual image.
    pub v: Vec<f64>,
    /// Largest σ of a place over the sub-image, px of the virtual image.
    pub sigma_px: f64,
}

/// Returns the number of coefficients of one axis: (t + 1)(t + 2)/2.
#[must_use]
pub const fn terms(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Returns ξ and η of a place of a sub-image of `size_px` (width, height).
#[must_use]
pub fn normalised([width, height]: [usize; 2], [col, row]: [f64; 2]) -> [f64; 2] {
    let half = real(height) / 2.0;
    [(col - real(width) / 2.0) / half, (row - half) / half]
}

/// Returns the values of all terms, in the order of the coefficients.
#[must_use]
pub fn basis(degree: usize, [xi, eta]: [f64; 2]) -> Vec<f64> {
    let mut values = Vec::with_capacity(terms(degree));
    for i in 0..=degree {
        values.extend((0..=i).map(|j| power(xi, i - j) * power(eta, j)));
    }
    values
}

fn power(base: f64, exponent: usize) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * base)
}

impl Polynomial {
    /// Returns the place in the virtual image of a normalised place.
    #[must_use]
    pub fn value(&self, place: [f64; 2]) -> [f64; 2] {
        let basis = basis(self.degree, place);
        [&self.u, &self.v].map(|coefficients| dot(coefficients, &basis))
    }

    /// Returns the derivatives of u and v by ξ and η.
    #[must_use]
    pub fn derivatives(&self, [xi, eta]: [f64; 2]) -> Matrix2<f64> {
        let (mut matrix, mut k) = (Matrix2::zeros(), 0);
        for i in 0..=self.degree {
            for j in 0..=i {
                let m = i - j;
                let by_xi = if m == 0 {
                    0.0
                } else {
                    real(m) * power(xi, m - 1) * power(eta, j)
                };
                let by_eta = if j == 0 {
                    0.0
                } else {
                    real(j) * power(xi, m) * power(eta, j - 1)
                };
                let [a, b] =
                    [&self.u, &self.v].map(|list| list.get(k).copied().unwrap_or_default());
                matrix += Matrix2::new(a * by_xi, a * by_eta, b * by_xi, b * by_eta);
                k += 1;
            }
        }
        matrix
    }

    /// Returns the normalised place of a place in the virtual image, by Newton's method from
    /// `start`; `None` if it does not end within 20 steps below 1e-9 of half the height.
    #[must_use]
    pub fn inverse(&self, [u, v]: [f64; 2], start: [f64; 2]) -> Option<[f64; 2]> {
        let mut place = start;
        for _ in 0..STEPS {
            let [found_u, found_v] = self.value(place);
            let way = self.derivatives(place).try_inverse()?
                * nalgebra::Vector2::new(u - found_u, v - found_v);
            place = [place[0] + way.x, place[1] + way.y];
            if way.amax() < INVERSE_PX {
                return place.iter().all(|at| at.is_finite()).then_some(place);
            }
        }
        None
    }
}

/// Returns the sum of products.
#[must_use]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_has_ten_terms_in_the_order_of_the_index() {
        assert_eq!(terms(3), 10);
        let expected = [1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 8.0, 12.0, 18.0, 27.0];
        assert_eq!(basis(3, [2.0, 3.0]), expected);
    }

    #[test]
    fn inverse_returns_to_the_place() {
        let polynomial = Polynomial {
            degree: 3,
            u: vec![500.0, 400.0, 1.0, 0.2, -0.3, 0.1, 0.05, 0.0, 0.02, 0.1],
            v: vec![300.0, -2.0, 401.0, 0.1, 0.4, -0.2, 0.0, 0.07, 0.0, 0.03],
            sigma_px: 0.0,
        };
        for place in [[0.9, -0.9], [-0.5, 0.3], [0.0, 1.0]] {
            let found = polynomial
                .inverse(polynomial.value(place), [0.0, 0.0])
                .unwrap();
            assert!((found[0] - place[0]).hypot(found[1] - place[1]) < 1e-9);
        }
    }
}
