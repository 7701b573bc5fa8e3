//! Test of which unknowns the observations can separate.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix6, OMatrix, SymmetricEigen, U6, Vector6};

use crate::bundle::pose::Pose;
use crate::correction::{COEFFICIENT_NAMES, COEFFICIENTS};
use crate::exterior_orientation::{ELEMENT_NAMES, ELEMENTS};
use crate::linear::bordered_matrix::BorderedMatrix;

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
    pub unknowns: Vec<String>,
}

fn listed(names: &[String]) -> String {
    match names.split_last() {
        None => "the unknowns".to_owned(),
        Some((last, [])) => format!("{last} and the other unknowns"),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}

/// Coupling of a frame's elements with the coefficients.
type Coupling = OMatrix<f64, U6, Dyn>;

/// Normal equations of frames that share no unknown point, in pitch, roll and yaw.
#[derive(Debug, Clone)]
struct Frames {
    /// Matrix and coupling with the coefficients of each frame.
    blocks: Vec<(Matrix6<f64>, Coupling)>,
    /// Matrix of the coefficients.
    shared: DMatrix<f64>,
}

impl Frames {
    fn of(normals: &BorderedMatrix, poses: &[Pose]) -> Option<Self> {
        let blocks = poses.iter().enumerate().map(|(frame, pose)| {
            let mut by_elements = Matrix6::identity();
            let rotation_by_angles = pose.angles_by_rotation()?.try_inverse()?;
            by_elements
                .fixed_view_mut::<3, 3>(3, 3)
                .copy_from(&rotation_by_angles);
            let block = normals.column(frame).first()?;
            let coupling = normals.border.fixed_rows::<ELEMENTS>(ELEMENTS * frame);
            Some((
                by_elements.tr_mul(&(block * by_elements)),
                by_elements.transpose() * coupling,
            ))
        });
        Some(Self {
            blocks: blocks.collect::<Option<_>>()?,
            shared: normals.corner.clone(),
        })
    }

    /// Returns the matrix of the coefficients after elimination of the frames (Schur complement).
    fn reduced(&self) -> Option<DMatrix<f64>> {
        let mut reduced = self.shared.clone();
        for (block, coupling) in &self.blocks {
            reduced -= coupling.tr_mul(&Factor::new(block)?.solve(coupling));
        }
        Some(reduced)
    }
}

/// Checks that the unknowns can be separated; `by_image` are the normal equations of the image
/// points alone, `all` those with the observed orientations.
pub(super) fn check(
    by_image: &BorderedMatrix,
    all: &BorderedMatrix,
    estimated: [bool; COEFFICIENTS],
    poses: &[Pose],
) -> Result<(), Inseparable> {
    let unknown = || Inseparable {
        unknowns: Vec::new(),
    };
    let by_image = Frames::of(by_image, poses).ok_or_else(unknown)?;
    let all = Frames::of(all, poses).ok_or_else(unknown)?;
    for (block, _) in &all.blocks {
        check_orientation(block)?;
    }
    let free: Vec<&str> = COEFFICIENT_NAMES
        .into_iter()
        .zip(estimated)
        .filter_map(|(name, is_free)| is_free.then_some(name))
        .collect();
    if free.is_empty() {
        return Ok(());
    }
    let lengths = by_image.shared.diagonal().map(f64::sqrt);
    if !lengths.iter().all(|length| *length > 0.0) {
        return Err(Inseparable {
            unknowns: names(&free, |index| {
                lengths.get(index).is_none_or(|length| *length <= 0.0)
            }),
        });
    }
    // Fraction of the effect of unit combinations that orientations cannot undo.
    let reduced = all.reduced().ok_or_else(unknown)?;
    let (least, direction) = weakest(reduced.component_div(&(&lengths * lengths.transpose())));
    if least >= MIN_COEFFICIENT_SEPARATION.powi(2) {
        return Ok(());
    }
    let combination = DVector::from_vec(direction.clone()).component_div(&lengths);
    Err(named(&by_image, &all, &combination, &free, &direction))
}

fn check_orientation(block: &Matrix6<f64>) -> Result<(), Inseparable> {
    let Some((_, scaled)) = unit_diagonal(block) else {
        let diagonal = block.diagonal();
        return Err(Inseparable {
            unknowns: names(&ELEMENT_NAMES, |index| {
                diagonal.get(index).is_none_or(|element| *element <= 0.0)
            }),
        });
    };
    let (least, direction) = weakest(DMatrix::from_iterator(
        ELEMENTS,
        ELEMENTS,
        scaled.iter().copied(),
    ));
    if least >= MIN_ORIENTATION_SEPARATION.powi(2) {
        return Ok(());
    }
    Err(Inseparable {
        unknowns: names(&ELEMENT_NAMES, large(&direction)),
    })
}

/// Names the coefficients of an inseparable combination and the orientation elements that undo it.
fn named(
    by_image: &Frames,
    all: &Frames,
    combination: &DVector<f64>,
    free: &[&str],
    direction: &[f64],
) -> Inseparable {
    let mut unknowns = names(free, large(direction));
    // Contribution of each element of all frames together to undoing the combination, by its effect
    // on the image points.
    let mut effects = [0.0_f64; ELEMENTS];
    for ((block, coupling), (image, _)) in all.blocks.iter().zip(&by_image.blocks) {
        let Some(factor) = Factor::new(block) else {
            continue;
        };
        let undoing = factor.solve(coupling) * combination;
        let image = image.diagonal();
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

/// Cholesky factor of a matrix scaled to a unit diagonal, because metres and radians mix.
#[derive(Debug, Clone)]
struct Factor {
    scale: Matrix6<f64>,
    factor: Cholesky<f64, U6>,
}

impl Factor {
    fn new(matrix: &Matrix6<f64>) -> Option<Self> {
        let (scale, scaled) = unit_diagonal(matrix)?;
        Some(Self {
            scale: Matrix6::from_diagonal(&scale),
            factor: Cholesky::new(scaled)?,
        })
    }

    fn solve(&self, right: &Coupling) -> Coupling {
        self.scale * self.factor.solve(&(self.scale * right))
    }
}

/// Returns the matrix scaled to a unit diagonal and the factors of its rows and columns; `None` for
/// a diagonal that is not positive.
fn unit_diagonal(matrix: &Matrix6<f64>) -> Option<(Vector6<f64>, Matrix6<f64>)> {
    let diagonal = matrix.diagonal();
    if !diagonal.iter().all(|element| *element > 0.0) {
        return None;
    }
    let scale = diagonal.map(|element| element.sqrt().recip());
    let scaling = Matrix6::from_diagonal(&scale);
    Some((scale, scaling * matrix * scaling))
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

fn names(all: &[&str], chosen: impl Fn(usize) -> bool) -> Vec<String> {
    all.iter()
        .enumerate()
        .filter(|(index, _)| chosen(*index))
        .map(|(_, name)| (*name).to_owned())
        .collect()
}
