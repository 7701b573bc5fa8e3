//! Unknowns that the observations cannot tell apart.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::linear::bordered_factor::Singular;
use crate::linear::element::element;
use crate::linear::weakest_direction::WeakestDirection;

use super::error::BundleError;
use super::layout::Layout;
use super::network::Network;
use super::normals::Normals;
use super::parameters::Parameter;
use super::state::State;

/// Smallest eigenvalue of the normal matrix with unit diagonal: below it the matrix is singular but
/// for rounding.
const LEAST_EIGENVALUE: f64 = 1e-13;

/// Smallest eigenvalue that explains why a network does not converge: its σ are a thousand times
/// as large as those of separate unknowns.
const MOST_EIGENVALUE: f64 = 1e-6;

/// Smallest eigenvalue of the normal matrix of the shared unknowns alone, all others eliminated,
/// with unit diagonal: two unknowns with a correlation of 0.999999.
const LEAST_SHARED_EIGENVALUE: f64 = 1e-6;

/// Unknowns with more than this share of the largest in the weakest combination are named.
const NAMED_SHARE: f64 = 0.3;

/// Unknowns of an image: projection centre, and rotation vector about the ground axes
/// ([`super::pose::Pose`]), neither pitch nor roll of an image that is not flown northwards.
const POSE_NAMES: [&str; 6] = [
    "X_S",
    "Y_S",
    "Z_S",
    "rotation about X",
    "rotation about Y",
    "rotation about Z",
];

/// Most images whose elements are named.
const MOST_NAMED: usize = 3;

/// Checks that the normal matrix, its points eliminated, is not singular.
///
/// # Errors
/// [`BundleError::Inseparable`] with the unknowns of its null vector.
pub fn check(network: &Network, layout: &Layout, normals: &Normals) -> Result<(), BundleError> {
    match WeakestDirection::new(&normals.matrix, layout.order()) {
        Ok(weakest) if weakest.eigenvalue > LEAST_EIGENVALUE => Ok(()),
        Ok(weakest) => Err(BundleError::Inseparable {
            unknowns: names(network, layout, &weakest.components),
        }),
        Err(_) => {
            let diagonal = normals.matrix.diagonal();
            let unobserved: Vec<f64> = diagonal
                .iter()
                .map(|element| if *element > 0.0 { 0.0 } else { 1.0 })
                .collect();
            Err(BundleError::Inseparable {
                unknowns: names(network, layout, &unobserved),
            })
        }
    }
}

/// Returns what keeps a search from converging: unknowns that the observations hardly tell apart,
/// by name.
#[must_use]
pub fn not_converged(network: &Network, layout: &Layout, normals: Option<Normals>) -> BundleError {
    let weakest =
        normals.and_then(|normals| WeakestDirection::new(&normals.matrix, layout.order()).ok());
    match weakest {
        Some(weakest) if weakest.eigenvalue < MOST_EIGENVALUE => BundleError::Inseparable {
            unknowns: names(network, layout, &weakest.components),
        },
        _ => BundleError::NotConverged,
    }
}

/// Returns the names of the unknowns in the combination that a solved network determines least.
///
/// # Errors
/// [`Singular`] if an unknown is not observed at all.
pub fn weakest(
    network: &Network,
    layout: &Layout,
    state: &State,
    held: &[usize],
) -> Result<Vec<String>, Singular> {
    let mut normals = Normals::new(network, layout, state, 0.0)?;
    normals.hold(held);
    let weakest = WeakestDirection::new(&normals.matrix, layout.order())?;
    Ok(names(network, layout, &weakest.components))
}

/// Returns the names of shared unknowns that an adjusted network tells apart by nothing but noise:
/// residual differences of attitude keep the normal matrix from being singular.
#[must_use]
pub fn shared(network: &Network, layout: &Layout, cofactors: &DMatrix<f64>) -> Option<Vec<String>> {
    let columns: Vec<(usize, Parameter)> = layout
        .border
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, parameter)| !matches!(parameter, Parameter::Point { .. }))
        .collect();
    // One alone has nothing to be confused with, and an empty matrix no eigenvectors.
    if columns.len() < 2 {
        return None;
    }
    let part = DMatrix::from_fn(columns.len(), columns.len(), |row, column| {
        match (columns.get(row), columns.get(column)) {
            (Some((row, _)), Some((column, _))) => element(cofactors, *row, *column),
            _ => 0.0,
        }
    });
    let scaled = |matrix: &DMatrix<f64>| {
        let roots = matrix
            .diagonal()
            .map(|element| 1.0 / element.max(f64::MIN_POSITIVE).sqrt());
        let diagonal = DMatrix::from_diagonal(&roots);
        &diagonal * matrix * &diagonal
    };
    // Correlations are inverted: cofactors have units.
    let normal = scaled(&scaled(&part).cholesky()?.inverse());
    let eigen = SymmetricEigen::new(normal);
    let (least, vector) = eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
        .min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    let largest = vector.amax();
    let named = columns.iter().zip(vector.iter());
    (*least < LEAST_SHARED_EIGENVALUE).then(|| {
        named
            .filter(|(_, share)| share.abs() >= 0.5 * NAMED_SHARE * largest)
            .map(|((_, parameter), _)| network.parameter_name(*parameter))
            .collect()
    })
}

/// Returns the names of the unknowns with large components: shared ones first, then those of
/// images.
#[must_use]
pub fn names(network: &Network, layout: &Layout, components: &[f64]) -> Vec<String> {
    let rows = components.len().saturating_sub(layout.border.len());
    let (images, shared) = components
        .split_at_checked(rows)
        .unwrap_or((components, &[]));
    let largest = components
        .iter()
        .fold(0.0_f64, |most, share| most.max(share.abs()));
    let mut names: Vec<String> = layout
        .border
        .iter()
        .zip(shared)
        .filter(|(_, share)| largest > 0.0 && share.abs() >= 0.5 * NAMED_SHARE * largest)
        .map(|(parameter, _)| network.parameter_name(*parameter))
        .collect();
    // One element of several images together is named once.
    let mut elements: Vec<(f64, String)> = Vec::new();
    for (index, element) in POSE_NAMES.iter().enumerate() {
        let of_images = || {
            images
                .iter()
                .skip(index)
                .step_by(6)
                .map(|share| share.abs())
        };
        let strongest = of_images().fold(0.0_f64, f64::max);
        if largest <= 0.0 || strongest < NAMED_SHARE * largest {
            continue;
        }
        let concerned: Vec<&str> = of_images()
            .zip(&network.images)
            .filter(|(share, _)| *share >= NAMED_SHARE * largest)
            .map(|(_, image)| image.name.as_str())
            .collect();
        let of = if concerned.len() > MOST_NAMED {
            format!("{} images", concerned.len())
        } else {
            format!("image {}", concerned.join(", "))
        };
        elements.push((strongest, format!("{element} of {of}")));
    }
    elements.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    names.extend(elements.into_iter().map(|(_, name)| name));
    names
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use nalgebra::Vector6;

    use super::*;
    use crate::bundle::image::NetworkImage;
    use crate::bundle::interior::Interior;
    use crate::bundle::parameters::SharedValues;
    use crate::bundle::pose::Pose;
    use crate::exterior_orientation::ExteriorOrientation;

    #[test]
    fn rotation_of_an_image_is_named_by_the_axis_of_the_ground_about_which_it_turns() {
        // Flown westwards: a rotation about the ground's X is one about the camera's y, its roll.
        let pose = Pose::from(ExteriorOrientation {
            position_m: [0.0, 0.0, 100.0],
            attitude: [0.0, 0.0, FRAC_PI_2],
        });
        let mut step = Vector6::zeros();
        step[3] = 1e-3;
        let [pitch, roll, _] = pose.moved(&step).orientation().attitude;
        assert!(pitch.abs() < 1e-6 && (roll.abs() - 1e-3).abs() < 1e-6);
        let network = Network {
            images: vec![NetworkImage {
                name: "west".to_owned(),
                pose,
                observed: None,
                stage: None,
            }],
            points: Vec::new(),
            image_points: Vec::new(),
            additional: Vec::new(),
            scale_bars: Vec::new(),
            strips: Vec::new(),
            parameters: SharedValues::new(
                Interior {
                    principal_distance_mm: 50.0,
                    principal_point_mm: [0.0; 2],
                    k: [0.0; 4],
                    p: [0.0; 2],
                    b: [0.0; 2],
                },
                0,
            ),
            estimated: Vec::new(),
            priors: Vec::new(),
        };
        let layout = Layout::new(&network).unwrap();
        assert_eq!(
            names(&network, &layout, step.as_slice()),
            ["rotation about X of image west"]
        );
    }
}
