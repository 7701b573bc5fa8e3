//! Errors of an adjustment.

use std::fmt;

use fmc_camera_file::InputError;
use nalgebra::Vector3;

/// Largest number of iterations; from closed initial orientations a network takes about six.
pub const MOST_ITERATIONS: usize = 200;

/// Error of the adjustment of a network.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BundleError {
    /// The observations cannot separate some unknowns.
    #[error("the observations cannot tell {} apart", listed(unknowns))]
    Inseparable {
        /// Names of the unknowns.
        unknowns: Vec<String>,
    },
    /// The observations do not determine the datum.
    #[error(
        "the observations leave {defects} of the 7 parameters of the datum (shift, rotation, scale) undetermined; \
         give three control points that do not lie on a line, or positions of images, or use a free network"
    )]
    Datum {
        /// Parameters of a similarity transformation without observation.
        defects: usize,
    },
    /// An image cannot be oriented.
    #[error(
        "image {image} has neither a position and attitude nor four points with known coordinates, nor two if it looks \
         straight down: it cannot be oriented"
    )]
    Unoriented {
        /// Name of the image.
        image: String,
    },
    /// Control points do not fit the image points and each other.
    #[error(
        "control that does not fit: {}; with it σ0 is {sigma0:.2}, without it {without:.2}{}; \
         check coordinates and name, or make it a check point",
        points.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
        alternatives(or)
    )]
    Control {
        /// Points that do not fit together.
        points: Vec<Misfit>,
        /// Points of which each alone would explain the misfit as well as the first.
        or: Vec<Misfit>,
        /// σ0 with them.
        sigma0: f64,
        /// σ0 without them.
        without: f64,
    },
    /// No step lowers the sum of squares, or a point moved above a lens.
    #[error("the adjustment does not converge within {MOST_ITERATIONS} iterations")]
    NotConverged,
}

/// Error of a calibration by a network.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BundleCalibrationError {
    /// The files.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The adjustment.
    #[error(transparent)]
    Adjustment(#[from] BundleError),
}

/// A control point that does not fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Name.
    pub point: String,
    /// Adjusted less given coordinates, m.
    pub difference_m: Vector3<f64>,
}

impl fmt::Display for Misfit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z]: [f64; 3] = self.difference_m.into();
        let point = &self.point;
        write!(formatter, "point {point} by {x:.4}, {y:.4}, {z:.4} m")
    }
}

fn alternatives(or: &[Misfit]) -> String {
    if or.is_empty() {
        return String::new();
    }
    let names: Vec<&str> = or.iter().map(|misfit| misfit.point.as_str()).collect();
    format!(
        "; too few control points to tell it from {}",
        names.join(", ")
    )
}

fn listed(names: &[String]) -> String {
    match names.split_last() {
        None => "the unknowns".to_owned(),
        Some((last, [])) => format!("{last} and the other unknowns"),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}
