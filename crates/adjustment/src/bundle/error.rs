//! Errors of an adjustment.

use fmc_camera_file::InputError;

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
        "image {image} has neither a position and attitude nor four points with known coordinates: it cannot be oriented"
    )]
    Unoriented {
        /// Name of the image.
        image: String,
    },
    /// Control points do not fit the image points and each other.
    #[error(
        "control that does not fit: point {}; with it σ0 is {sigma0:.2}, without it {without:.2}; \
         check coordinates and name, or make it a check point",
        points.join("; point ")
    )]
    Control {
        /// Names of the points with adjusted less given coordinates.
        points: Vec<String>,
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

fn listed(names: &[String]) -> String {
    match names.split_last() {
        None => "the unknowns".to_owned(),
        Some((last, [])) => format!("{last} and the other unknowns"),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}
