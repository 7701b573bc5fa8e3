//! Test of which unknowns the observations can separate.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::correction::{COEFFICIENT_NAMES, COEFFICIENTS};
use crate::exterior_orientation::{ELEMENT_NAMES, ELEMENTS};
use crate::normal_equations::{Factor, NormalEquations, SharedVector, unit_diagonal};

/// Elements of one exterior orientation are inseparable if a combination of them changes the
/// observations by less than this fraction of the change by each alone.
pub const MIN_ORIENTATION_SEPARATION: f64 = 1e-3;

/// Coefficients are inseparable from the exterior orientation if orientations within their σ can
/// undo all but this fraction of the effect of a combination of them. On flat ground with a free
/// orientation the fraction is the lens distortion, up to 1 %; relief of 5 % of the height adds
/// less than as much again. `K_m0`, `K_m1` and `K_m2` among themselves leave 4 to 5 % in the
/// shipped scenarios.
pub const MIN_COEFFICIENT_SEPARATION: f64 = 0.02;

/// Unknowns with more than this share of the largest in an inseparable combination are named.
const NAMED_SHARE: f64 = 0.3;

/// Error: the observations leave a combination of unknowns undetermined.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the observations cannot tell {} apart", listed(unknowns))]
pub struct Inseparable {
    /// Symbols of the unknowns, coefficients first.
    pub unknowns: Vec<&'static str>,
}

fn listed(names: &[&str]) -> String {
    match names.split_last() {
        None => "the unknowns".to_owned(),
        Some((last, [])) => format!("{last} and the other unknowns"),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}

/// Checks that the unknowns can be separated; `by_image` are the normal equations of the image
/// points alone, `all` those with the observed orientations.
pub(super) fn check(
    by_image: &NormalEquations,
    all: &NormalEquations,
    estimated: [bool; COEFFICIENTS],
) -> Result<(), Inseparable> {
    for block in &all.frames {
        check_orientation(block)?;
    }
    let free: Vec<usize> = (0..COEFFICIENTS)
        .zip(estimated)
        .filter_map(|(index, is_free)| is_free.then_some(index))
        .collect();
    if free.is_empty() {
        return Ok(());
    }
    let lengths = by_image.shared.diagonal().map(f64::sqrt);
    if let Some(unobserved) = free
        .iter()
        .find(|index| lengths.get(**index).is_none_or(|length| *length <= 0.0))
    {
        return Err(Inseparable {
            unknowns: names(&COEFFICIENT_NAMES, |index| index == *unobserved),
        });
    }
    // Fraction of the effect of unit combinations that orientations cannot undo.
    let reduced = all.reduced().ok_or(Inseparable {
        unknowns: Vec::new(),
    })?;
    let length = |index: usize| lengths.get(index).copied().unwrap_or(1.0);
    let remaining = DMatrix::from_fn(free.len(), free.len(), |row, column| {
        match (free.get(row), free.get(column)) {
            (Some(&row), Some(&column)) => {
                reduced.get((row, column)).copied().unwrap_or(0.0) / (length(row) * length(column))
            }
            _ => 0.0,
        }
    });
    let (least, direction) = weakest(remaining);
    if least >= MIN_COEFFICIENT_SEPARATION.powi(2) {
        return Ok(());
    }
    let mut combination = SharedVector::zeros();
    for (index, share) in free.iter().zip(&direction) {
        if let Some(element) = combination.get_mut(*index) {
            *element = share / length(*index);
        }
    }
    Err(named(by_image, all, &combination, &free, &direction))
}

fn check_orientation(block: &crate::normal_equations::FrameBlock) -> Result<(), Inseparable> {
    let Some((_, scaled)) = unit_diagonal(&block.matrix) else {
        let diagonal = block.matrix.diagonal();
        return Err(Inseparable {
            unknowns: names(&ELEMENT_NAMES, |index| {
                diagonal.get(index).is_none_or(|element| *element <= 0.0)
            }),
        });
    };
    let (least, direction) = weakest(DMatrix::from_fn(ELEMENTS, ELEMENTS, |row, column| {
        scaled.get((row, column)).copied().unwrap_or(0.0)
    }));
    if least >= MIN_ORIENTATION_SEPARATION.powi(2) {
        return Ok(());
    }
    Err(Inseparable {
        unknowns: names(&ELEMENT_NAMES, large(&direction)),
    })
}

/// Names the coefficients of an inseparable combination and the orientation elements that undo it.
fn named(
    by_image: &NormalEquations,
    all: &NormalEquations,
    combination: &SharedVector,
    free: &[usize],
    direction: &[f64],
) -> Inseparable {
    let is_large = large(direction);
    let mut unknowns = names(&COEFFICIENT_NAMES, |index| {
        free.iter()
            .position(|free| *free == index)
            .is_some_and(&is_large)
    });
    // Contribution of each element of all frames together to undoing the combination, by its effect
    // on the image points.
    let mut effects = [0.0_f64; ELEMENTS];
    for (block, image) in all.frames.iter().zip(&by_image.frames) {
        let Some(factor) = Factor::new(&block.matrix) else {
            continue;
        };
        let undoing = factor.solve(&(block.coupling * combination));
        let image = image.matrix.diagonal();
        for ((effect, step), weight) in effects.iter_mut().zip(undoing.iter()).zip(image.iter()) {
            *effect += step.powi(2) * weight;
        }
    }
    let effects = effects.map(f64::sqrt);
    let undoing = effects.iter().copied().fold(0.0, f64::max);
    // Coefficients that imitate only each other need no orientation.
    if undoing > 0.3 {
        unknowns.extend(names(&ELEMENT_NAMES, large(&effects)));
    }
    Inseparable { unknowns }
}

/// Returns the smallest eigenvalue and its eigenvector.
fn weakest(matrix: DMatrix<f64>) -> (f64, Vec<f64>) {
    let eigen = SymmetricEigen::new(matrix);
    let mut least = (f64::INFINITY, Vec::new());
    for (value, vector) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if *value < least.0 {
            least = (*value, vector.iter().copied().collect());
        }
    }
    least
}

fn large(shares: &[f64]) -> impl Fn(usize) -> bool {
    let largest = shares
        .iter()
        .fold(0.0_f64, |most, share| most.max(share.abs()));
    let is_large: Vec<bool> = shares
        .iter()
        .map(|share| share.abs() >= NAMED_SHARE * largest)
        .collect();
    move |index| is_large.get(index).copied().unwrap_or(false)
}

fn names(all: &[&'static str], chosen: impl Fn(usize) -> bool) -> Vec<&'static str> {
    all.iter()
        .enumerate()
        .filter_map(|(index, name)| chosen(index).then_some(*name))
        .collect()
}
