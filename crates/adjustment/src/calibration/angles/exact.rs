//! The exact model of a line camera on a turntable.

use nalgebra::DMatrix;

use super::super::least_squares::{Linearised, Model};

/// Names of the unknowns.
pub(super) const NAMES: [&str; 5] = ["principal_distance_mm", "p", "k1", "k2", "angle_offset_rad"];

/// Place on the line and angle of a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LineAngle {
    pub(super) l_mm: f64,
    pub(super) angle_rad: f64,
    /// σ of the place and of f·tanW together, mm.
    pub(super) sigma_mm: f64,
}

/// Coefficients of g(q) = 1 - 4q + 55/3·q² - …: the inverse of `r = i + K·i³` is
/// `i = r(1 - q + 3q²·g(q))`, q = K·r².
const INVERSE_CUBIC: [f64; 7] = [1.0, -4.0, 55.0 / 3.0, -91.0, 476.0, -2584.0, 14_421.0];

/// Radii at which the polynomial of the camera file is fitted.
const SAMPLES: u32 = 200;

/// Radial distortion of two coefficients.
///
/// # Model
/// `D(r) = K1·r³ + K2·r⁵·g(K1·r²)`, measured - ideal at the measured place: with K2 = 0 a cubic of
/// the measured place, with K2 = -3·K1² one of the ideal place. Without the powers above the fifth
/// the second leaves a bias of 11 µm in f = 218 mm at 3.7 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LineDistortion {
    pub(super) k1: f64,
    pub(super) k2: f64,
}

/// Distortion at a place with its derivatives.
struct AtPlace {
    value: f64,
    by_place: f64,
    by_k1: f64,
    by_k2: f64,
}

impl LineDistortion {
    fn at(self, r: f64) -> AtPlace {
        let Self { k1, k2 } = self;
        let square = r * r;
        let q = k1 * square;
        // g, its derivative, and Σ(5 + 2n)·gₙ·qⁿ by Horner's scheme.
        let (mut g, mut slope, mut weighted) = (0.0, 0.0, 0.0);
        for (n, coefficient) in INVERSE_CUBIC.into_iter().enumerate().rev() {
            slope = slope * q + g;
            g = g * q + coefficient;
            let power = 5.0 + 2.0 * super::super::snooping::count(n);
            weighted = weighted * q + power * coefficient;
        }
        let fifth = square * square * r;
        AtPlace {
            value: r * q + k2 * fifth * g,
            by_place: 3.0 * q + k2 * square * square * weighted,
            by_k1: r * square + k2 * fifth * square * slope,
            by_k2: fifth * g,
        }
    }

    pub(super) fn value(self, r: f64) -> f64 {
        self.at(r).value
    }

    /// Returns dD/dr.
    pub(super) fn slope(self, r: f64) -> f64 {
        self.at(r).by_place
    }

    /// Returns the polynomial of the camera file: least squares over the measured places up to a
    /// radius, mm.
    pub(super) fn polynomial(self, radius: f64) -> FilePolynomial {
        let places: Vec<f64> = (1..=SAMPLES)
            .map(|step| f64::from(step) / f64::from(SAMPLES))
            .collect();
        let design = DMatrix::from_fn(places.len(), 3, |row, column| {
            let place = places.get(row).copied().unwrap_or(0.0);
            place.powi([3, 5, 7].get(column).copied().unwrap_or(0))
        });
        let right = DMatrix::from_fn(places.len(), 3, |row, column| {
            let at = self.at(radius * places.get(row).copied().unwrap_or(0.0));
            [at.value, at.by_k1, at.by_k2]
                .get(column)
                .copied()
                .unwrap_or(0.0)
        });
        let solution = design
            .clone()
            .svd(true, true)
            .solve(&right, 0.0)
            .unwrap_or_else(|_| DMatrix::zeros(3, 3));
        let left_mm = (&design * &solution - &right).column(0).amax();
        let element = |power: usize, column: usize, exponent: i32| {
            solution.get((power, column)).copied().unwrap_or(0.0) / radius.powi(exponent)
        };
        let row = |column: usize| {
            [
                element(0, column, 3),
                element(1, column, 5),
                element(2, column, 7),
            ]
        };
        FilePolynomial {
            k: row(0),
            by_k1: row(1),
            by_k2: row(2),
            left_mm,
        }
    }
}

/// K1, K2, K3 of the camera file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FilePolynomial {
    pub(super) k: [f64; 3],
    /// Derivatives of them by the two coefficients of [`LineDistortion`].
    pub(super) by_k1: [f64; 3],
    pub(super) by_k2: [f64; 3],
    /// Largest difference from the distortion, mm.
    pub(super) left_mm: f64,
}

/// Unknowns of the moment with the observations.
///
/// # Model
/// `ideal(L - p) = f·tan(W - W0)`, `ideal(r) = r - D(r)`, [`LineDistortion`].
#[derive(Debug, Clone)]
pub(super) struct LineCamera<'a> {
    /// f, mm; p, mm; K1, mm⁻²; K2, mm⁻⁴; W0, rad.
    pub(super) unknowns: [f64; 5],
    pub(super) angles: &'a [LineAngle],
}

impl LineCamera<'_> {
    pub(super) fn distortion(&self) -> LineDistortion {
        let [_, _, k1, k2, _] = self.unknowns;
        LineDistortion { k1, k2 }
    }

    /// Returns the largest distance of a place from the principal point, mm.
    pub(super) fn radius_mm(&self) -> f64 {
        let [_, p, ..] = self.unknowns;
        let radii = self.angles.iter().map(|one| (one.l_mm - p).abs());
        radii.fold(0.0, f64::max)
    }
}

impl Model<1> for LineCamera<'_> {
    fn unknowns(&self) -> usize {
        NAMES.len()
    }

    fn observations(&self) -> usize {
        self.angles.len()
    }

    fn sigma_mm(&self, index: usize) -> f64 {
        self.angles.get(index).map_or(1.0, |one| one.sigma_mm)
    }

    fn linearised(&self, index: usize) -> Option<Linearised<1>> {
        let one = self.angles.get(index)?;
        let [f, p, _, _, offset] = self.unknowns;
        let r = one.l_mm - p;
        let angle = one.angle_rad - offset;
        let tangent = angle.tan();
        if angle.abs() >= std::f64::consts::FRAC_PI_2 {
            return None;
        }
        let at = self.distortion().at(r);
        Some(Linearised {
            residual: [r - at.value - f * tangent],
            derivatives: [vec![
                -tangent,
                at.by_place - 1.0,
                -at.by_k1,
                -at.by_k2,
                f * (1.0 + tangent * tangent),
            ]],
        })
    }

    fn moved(&self, step: &[f64]) -> Option<Self> {
        let mut next = self.clone();
        for (unknown, change) in next.unknowns.iter_mut().zip(step) {
            *unknown += change;
        }
        let [f, ..] = next.unknowns;
        (f > 0.0).then_some(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_inverts_a_cubic_of_the_ideal_place() {
        let k = 0.037 / 70.83_f64.powi(2);
        let lens = LineDistortion {
            k1: k,
            k2: -3.0 * k * k,
        };
        for ideal in [-70.83, 5.0, 40.0, 70.83] {
            let measured = ideal + k * f64::powi(ideal, 3);
            let found = measured - lens.value(measured);
            assert!((found - ideal).abs() < 5e-6, "{ideal} {found}");
            let step = 1e-4;
            let slope = (lens.value(measured + step) - lens.value(measured - step)) / (2.0 * step);
            assert!((lens.slope(measured) - slope).abs() < 1e-9);
        }
        // 55·0.037⁴ of the radius is beyond the seventh power; the polynomial takes most of it.
        let polynomial = lens.polynomial(73.5);
        assert!(polynomial.left_mm < 1.5e-4, "{}", polynomial.left_mm);
        let [k1, k2, k3] = polynomial.k;
        let square = 40.0_f64 * 40.0;
        let value = 40.0 * square * (k1 + square * (k2 + square * k3));
        assert!((value - lens.value(40.0)).abs() < 1.5e-4);
    }

    #[test]
    fn derivatives_by_coefficients_are_the_limits_of_differences() {
        let lens = LineDistortion {
            k1: 7e-6,
            k2: -1.5e-10,
        };
        let r = 60.0;
        let at = lens.at(r);
        let by = |change: fn(&mut LineDistortion, f64), step: f64| {
            let moved = |sign: f64| {
                let mut moved = lens;
                change(&mut moved, sign * step);
                moved.value(r)
            };
            (moved(1.0) - moved(-1.0)) / (2.0 * step)
        };
        let by_k1 = by(|lens, step| lens.k1 += step, 1e-10);
        let by_k2 = by(|lens, step| lens.k2 += step, 1e-14);
        assert!((at.by_k1 / by_k1 - 1.0).abs() < 1e-6);
        assert!((at.by_k2 / by_k2 - 1.0).abs() < 1e-6);
    }
}
