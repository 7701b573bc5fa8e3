//! Fit of a pinhole formula, ideal -> measured, to a calibrated camera.

use nalgebra::{DMatrix, DVector};

use crate::calibrated::{Calibrated, GRID};
use crate::coefficient::Coefficient;
use crate::least_squares::Linearised;
use crate::pinhole::Pinhole;
use crate::scalar::{Scalar, Sloped};

/// Most steps of a fit. Without convergence the best found is the result: its residual is measured
/// and stated in any case.
const MAX_STEPS: u32 = 60;

/// Part of the sum of squares by which a step must reduce it to be followed by another.
const LEAST_GAIN: f64 = 1e-6;

/// Damping of the first step, for columns of unit length, and its change.
const FIRST_DAMPING: f64 = 1e-9;
const DAMPING_FACTOR: f64 = 10.0;
const LARGEST_DAMPING: f64 = 1e6;

/// Residual, px, that a coefficient of 1 in quotient, prism or tilt counts as. Numerator and
/// denominator of a metric lens nearly cancel, and prism and tilt resemble each other: of the many
/// sets that fit alike, this chooses a small one.
const SMALLNESS_PX: f64 = 1e-4;

/// A ray and the place where it is measured, px.
type Observation = ([f64; 2], [f64; 2]);

/// Returns the camera whose free coefficients fit the measured points of the whole sensor best.
///
/// # Model
/// Least squares of measured point (formula of the rays) - measured point over [`GRID`] x [`GRID`]
/// points with the strict rays of `camera`; principal point and fy are held at those of `camera`
/// with K0 = 0. Damped Gauss-Newton on columns of unit length, at most 60 steps, until a step gains
/// less than a millionth of the sum of squares.
///
/// # Accuracy
/// The residuals of the published cameras are within 25 % (largest) and 20 % (RMS) of those found
/// elsewhere: `tests/exchange/published.rs`.
#[must_use]
pub fn pinhole(camera: &Calibrated, free: &[Coefficient]) -> Pinhole {
    let observations: Vec<Observation> = camera
        .grid_mm(GRID)
        .into_iter()
        .map(|point| {
            (
                camera.ray_from_measured(point),
                camera.pixel_from_sensor(point),
            )
        })
        .collect();
    let start = Pinhole::ideal(camera.principal_distance_px(), camera.principal_point_px());
    // The quotient is fitted from the polynomial, the tilt from the quotient: each is the start of
    // the next, because from far away a quotient can run into its poles.
    let is_simple = |one: &Coefficient| !is_replaceable(*one);
    let is_without_tilt =
        |one: &Coefficient| !matches!(one, Coefficient::Prism(_) | Coefficient::Tilt(_));
    let simple: Vec<_> = free.iter().copied().filter(is_simple).collect();
    let quotient: Vec<_> = free.iter().copied().filter(is_without_tilt).collect();
    let mut found = improved(start, &simple, &observations);
    for stage in [&quotient[..], free] {
        if stage.len() > simple.len() {
            found = improved(found, stage, &observations);
        }
    }
    found
}

/// Returns the camera after steps that reduce the sum of squares.
fn improved(start: Pinhole, free: &[Coefficient], observations: &[Observation]) -> Pinhole {
    let mut camera = start;
    let mut sum = sum_of_squares(&camera, free, observations);
    let mut damping = FIRST_DAMPING;
    for _ in 0..MAX_STEPS {
        if free.is_empty() {
            break;
        }
        let Some(linearised) = linearised(&camera, free, observations) else {
            break;
        };
        let mut gain = 0.0;
        while damping < LARGEST_DAMPING {
            let trial = moved(&camera, free, &linearised.solve(damping));
            let reduced = sum_of_squares(&trial, free, observations);
            if reduced < sum {
                gain = (sum - reduced) / sum;
                (camera, sum) = (trial, reduced);
                damping /= DAMPING_FACTOR;
                break;
            }
            damping *= DAMPING_FACTOR;
        }
        if gain < LEAST_GAIN {
            break;
        }
    }
    camera
}

/// Returns `true` for a coefficient that other coefficients can nearly replace.
const fn is_replaceable(coefficient: Coefficient) -> bool {
    matches!(
        coefficient,
        Coefficient::Divisor(_) | Coefficient::Prism(_) | Coefficient::Tilt(_)
    )
}

fn sum_of_squares(camera: &Pinhole, free: &[Coefficient], observations: &[Observation]) -> f64 {
    let residuals: f64 = observations
        .iter()
        .map(|(ray, [u, v])| {
            let [col, row] = camera.project(*ray);
            (col - u).powi(2) + (row - v).powi(2)
        })
        .sum();
    let mut camera = *camera;
    let sizes: f64 = free
        .iter()
        .filter(|one| is_replaceable(**one))
        .filter_map(|one| one.of(&mut camera).map(|number| *number))
        .map(|number| (SMALLNESS_PX * number).powi(2))
        .sum();
    residuals + sizes
}

/// Returns the camera with its free coefficients changed.
fn moved(camera: &Pinhole, free: &[Coefficient], change: &[f64]) -> Pinhole {
    let mut moved = *camera;
    for (coefficient, change) in free.iter().zip(change) {
        if let Some(number) = coefficient.of(&mut moved) {
            *number += change;
        }
    }
    moved
}

fn linearised(
    camera: &Pinhole,
    free: &[Coefficient],
    observations: &[Observation],
) -> Option<Linearised> {
    let rows = 2 * observations.len();
    let mut design = DMatrix::zeros(rows + free.len(), free.len());
    let mut observed = DVector::zeros(rows + free.len());
    let missing = observations.iter().flat_map(|(ray, [u, v])| {
        let [col, row] = camera.project(*ray);
        [u - col, v - row]
    });
    for (cell, missing) in observed.iter_mut().zip(missing) {
        *cell = missing;
    }
    for (index, coefficient) in free.iter().enumerate() {
        let mut column = design.column_mut(index);
        let mut sloped: Pinhole<Sloped<f64>> = camera.map(Sloped::fixed);
        if let Some(number) = coefficient.of(&mut sloped) {
            if is_replaceable(*coefficient)
                && let (Some(cell), Some(wanted)) =
                    (column.get_mut(rows + index), observed.get_mut(rows + index))
            {
                *cell = SMALLNESS_PX;
                *wanted = -SMALLNESS_PX * number.value;
            }
            *number = Sloped::variable(number.value);
        }
        let slopes = observations
            .iter()
            .flat_map(|(ray, _)| sloped.project(ray.map(Sloped::constant)))
            .map(|sloped| sloped.slope);
        for (cell, slope) in column.iter_mut().zip(slopes) {
            *cell = slope;
        }
    }
    Linearised::new(design, &observed)
}
