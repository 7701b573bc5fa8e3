//! Streaming least squares of the five coefficients.

use super::design::{COLUMNS, Design, stands_for};
use super::fit::{Fit, FitError};
use super::known_lens::KnownLens;
use super::number::Number;
use super::observation::Observation;
use super::options::{FitOptions, StaticDecentring};
use super::parameter::{PARAMETERS, Parameter};
use super::triangle::{Triangle, at};
use crate::geometry::range::OutOfRange;

/// Number of points that are gathered in a separate factor before they join the others. Rounding
/// grows with the square root of the number of rotations that an element goes through; in blocks
/// each element goes through fewer of them.
pub(crate) const BLOCK_POINTS: u32 = 64;

/// Fewest points from which coefficients are adjusted.
pub const MIN_POINTS: u32 = 3;

/// Points are on a line where the root mean square of their distances from it is less than this
/// fraction of the format radius.
pub const MIN_SPREAD: f32 = 1e-3;

/// Largest regressor of `K_d1` and `P_m1` that counts as zero, mm: it explains less than a
/// nanometre.
pub const MIN_REGRESSOR_MM: f32 = 1e-5;

/// Least squares of the five coefficients over any number of observations, which are not kept.
///
/// # Model
/// Yuan et al. 2012, eqs. 22 and 24-28 as amended in section 13 of `docs/conventions.md`: the
/// observations are the total distortion, `K_m0` to `K_m2` replace K0 to K2, and K3, P, B of the
/// static calibration stay. Coordinates are divided by the format radius; the unknowns are
/// corrections to the static calibration with `K_d1` = `P_m1` = 0. The triangular factor is updated
/// by Givens rotations and the normal matrix is never formed: the condition number is about 25 over
/// a grid of exposures, where the normal matrix would have its square, and powers of mm 10⁶ and
/// more.
///
/// # Accuracy
/// Noise-free observations of the model give its coefficients back to 10⁻⁴ in single and 10⁻⁹ in
/// double precision (`tests/estimation/noise_free.rs`). One standard deviation of a coefficient
/// covers the truth as often as it should (`tests/estimation/coverage.rs`).
///
/// # Examples
/// ```
/// use fmc_camera::geometry::estimation::{adjustment::Adjustment, known_lens::KnownLens};
/// use fmc_camera::geometry::estimation::{observation::Observation, options::FitOptions};
/// use fmc_camera::{Calibration, CalibrationParameters};
/// let calibration = Calibration::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75))?;
/// let mut adjustment = Adjustment::new(KnownLens::of(&calibration), FitOptions::default());
/// // P_m1 = 1e-4 alone: 1e-4 · 0.1 · 200 = 0.002 mm along the axis at (10, 10) mm.
/// for travel_mm in [0.1_f32, 0.2] {
///     for (x, y) in [(-10.0, -20.0), (10.0, 10.0), (20.0, -5.0), (0.0, 30.0)] {
///         adjustment.observe(Observation {
///             x_mm: x,
///             y_mm: y,
///             dx_mm: 0.0,
///             dy_mm: 1e-4 * travel_mm * (x * x + y * y),
///             regressor_mm: travel_mm,
///             sigma_mm: 0.001,
///         })?;
///     }
/// }
/// let fitted = adjustment.fit()?.coefficients();
/// assert!((fitted.pm1 - 1e-4).abs() < 1e-8 && fitted.kd1.abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adjustment<T: Number> {
    lens: KnownLens<T>,
    options: FitOptions,
    total: Triangle<T, COLUMNS>,
    block: Triangle<T, COLUMNS>,
    /// Factor of the rows (1, x, y), which holds the spread of the points.
    places: Triangle<T, 3>,
    points: u32,
    largest_regressor: T,
}

impl<T: Number> Adjustment<T> {
    /// Returns an adjustment without observations.
    #[must_use]
    pub fn new(lens: KnownLens<T>, options: FitOptions) -> Self {
        Self {
            lens,
            options,
            total: Triangle::empty(),
            block: Triangle::empty(),
            places: Triangle::empty(),
            points: 0,
            largest_regressor: T::ZERO,
        }
    }

    /// n: points observed so far.
    #[must_use]
    pub const fn points(&self) -> u32 {
        self.points
    }

    /// Takes an observation.
    ///
    /// # Units and frames
    /// As in [`Observation`]; weight 1/σ².
    ///
    /// # Errors
    /// [`OutOfRange`] for a number that is not finite or outside its range; the adjustment is then
    /// unchanged.
    pub fn observe(&mut self, observation: Observation<T>) -> Result<(), OutOfRange> {
        let observation = observation.checked(&self.lens)?;
        for row in observation.rows(&self.lens) {
            self.block.absorb(row);
        }
        let [x0, y0] = self.lens.principal_point_mm;
        self.places.absorb([
            T::ONE,
            (observation.x_mm - x0) / self.lens.radius_mm,
            (observation.y_mm - y0) / self.lens.radius_mm,
        ]);
        let regressor = observation.regressor_mm.abs();
        if regressor > self.largest_regressor {
            self.largest_regressor = regressor;
        }
        self.points = self.points.saturating_add(1);
        if self.points.is_multiple_of(BLOCK_POINTS) {
            self.total.absorb_triangle(&self.block);
            self.block = Triangle::empty();
        }
        Ok(())
    }

    /// Solves for the coefficients from all observations so far.
    ///
    /// # Errors
    /// [`FitError`] if the observations do not determine them; it names the parameters that cannot
    /// be separated.
    pub fn fit(&self) -> Result<Fit<T>, FitError> {
        self.check_places()?;
        let mut factor = self.total;
        factor.absorb_triangle(&self.block);
        let estimates = self.options.decentring == StaticDecentring::Estimate;
        let believes = self.options.decentring == StaticDecentring::Known;
        let design = Design::of(&factor, self.options.tied, estimates);
        let unknowns = design.unknowns();
        let needed = unknowns / 2 + 1;
        if self.points < needed {
            return Err(FitError::TooFew {
                points: self.points,
                needed,
            });
        }
        // A decentring that is held without being known must be separable from the others, too.
        Design::of(&factor, self.options.tied, !believes).check()?;
        Ok(self.solved(&design))
    }

    /// Checks that there are enough points, that they are not on a line and that the principal
    /// point moves.
    fn check_places(&self) -> Result<(), FitError> {
        if self.points < MIN_POINTS {
            return Err(FitError::TooFew {
                points: self.points,
                needed: MIN_POINTS,
            });
        }
        let spread = self.distance_from_line();
        if spread < T::of(MIN_SPREAD) {
            return Err(FitError::OnALine {
                spread_mm: (spread * self.lens.radius_mm).single(),
            });
        }
        if self.largest_regressor < T::of(MIN_REGRESSOR_MM) {
            return Err(FitError::NoMotion {
                largest_mm: self.largest_regressor.single(),
            });
        }
        Ok(())
    }

    /// Returns the root mean square of the points' distances from the line that fits them best, in
    /// format radii: the smaller singular value of their centred coordinates.
    fn distance_from_line(&self) -> T {
        let (a, b, c) = (
            self.places.at(1, 1),
            self.places.at(1, 2),
            self.places.at(2, 2),
        );
        let half = T::of(0.5);
        let (xx, xy, yy) = (a * a, a * b, b * b + c * c);
        let difference = half * (xx - yy);
        let largest = half * (xx + yy) + (difference * difference + xy * xy).sqrt();
        if largest > T::ZERO {
            (a * c).abs() / (largest * T::of_count(self.points)).sqrt()
        } else {
            T::ZERO
        }
    }

    fn solved(&self, design: &Design<T>) -> Fit<T> {
        let Design { factor, size, tied } = design;
        let size = *size;
        let inverse = factor.inverse(size);
        let squares = factor.at(size, size) * factor.at(size, size);
        let unknowns = design.unknowns();
        let redundancy = self.points.saturating_mul(2).saturating_sub(unknowns);
        let sigma0 = (squares / T::of_count(redundancy)).sqrt();
        let sigma0_as_printed = (self.points > unknowns)
            .then(|| (squares / T::of_count(self.points - unknowns)).sqrt());

        let mut fit = Fit {
            options: self.options,
            points: self.points,
            unknowns,
            values: self.lens.starting_values(),
            standard_deviations: [T::ZERO; PARAMETERS],
            correlations: [[T::ZERO; PARAMETERS]; PARAMETERS],
            sigma0,
            sigma0_as_printed,
            condition: design.condition(),
        };
        let row_of =
            |parameter: Parameter| (0..size).find(|column| stands_for(*column, *tied, parameter));
        let rows = Parameter::ALL.map(row_of);
        let factors = Parameter::ALL.map(|parameter| match parameter {
            Parameter::Kd1 if *tied => T::of(2.0),
            _ => T::ONE,
        });
        let product = |first: usize, second: usize| {
            (0..size).fold(T::ZERO, |sum, column| {
                sum + at(&inverse, first, column) * at(&inverse, second, column)
            })
        };
        let scales = self.lens.scales();
        let places = rows.iter().zip(&factors).zip(&scales);
        for ((value, deviation), ((row, factor_of), scale)) in fit
            .values
            .iter_mut()
            .zip(&mut fit.standard_deviations)
            .zip(places)
        {
            let Some(row) = *row else { continue };
            let correction = (0..size).fold(T::ZERO, |sum, column| {
                sum + at(&inverse, row, column) * factor.at(column, size)
            });
            *value = *value + *factor_of * correction / *scale;
            *deviation = *factor_of * sigma0 * product(row, row).sqrt() / *scale;
        }
        for (first, correlations) in rows.iter().zip(&mut fit.correlations) {
            for (second, correlation) in rows.iter().zip(correlations) {
                if let (Some(first), Some(second)) = (*first, *second) {
                    *correlation = if first == second {
                        T::ONE
                    } else {
                        let squares = product(first, first) * product(second, second);
                        product(first, second) / squares.sqrt()
                    };
                }
            }
        }
        fit
    }
}
