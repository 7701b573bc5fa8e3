//! Wrong units and directions of axes, told by the pattern of the residuals.

use fmc_camera_file::InputError;

use super::error::{BundleCalibrationError, BundleError};
use super::network::{Network, PointRole};
use super::orientation::resection::{KnownPoint, resected};
use super::solution::Solution;
use super::tables::NetworkTables;

/// σ0, in units of the σ of an image point, above which other readings of the files are tried.
const DOUBTFUL_SIGMA0: f64 = 10.0;

/// Factor by which another reading must fit better to be named.
const LEAST_IMPROVEMENT: f64 = 8.0;

/// Residual of a resection, as a fraction of the image's extent, that is no measurement.
const MOST_RESIDUAL: f64 = 2e-3;

/// Returns what explains an adjustment that failed.
#[must_use]
pub fn explained(
    network: &Network,
    tables: &NetworkTables,
    error: BundleError,
) -> BundleCalibrationError {
    if matches!(error, BundleError::Datum { .. }) {
        return error.into();
    }
    reading(network, tables).map_or_else(|| error.into(), BundleCalibrationError::from)
}

/// Checks that residuals are of the size of measurements.
///
/// # Errors
/// [`InputError`] that names the file and the reading of it that fits.
pub fn check(
    network: &Network,
    tables: &NetworkTables,
    solution: &Solution,
) -> Result<(), InputError> {
    if solution.sigma0() < DOUBTFUL_SIGMA0 {
        return Ok(());
    }
    reading(network, tables).map_or(Ok(()), Err)
}

/// Returns the error that names another reading of the files with which the images fit their known
/// points.
#[must_use]
pub fn reading(network: &Network, tables: &NetworkTables) -> Option<InputError> {
    let mut mirrored = 0.0;
    let mut as_read = 0.0;
    let mut angles_as_radians = 0;
    let mut angles_tested = 0;
    for number in 0..network.images.len() {
        let points = known_points(network, number);
        let flipped: Vec<KnownPoint> = points
            .iter()
            .map(|point| {
                let [x, y] = point.measured_mm;
                KnownPoint {
                    measured_mm: [x, -y],
                    ..*point
                }
            })
            .collect();
        let interior = &network.parameters.interior;
        let (Some(first), Some(second)) =
            (resected(interior, &points), resected(interior, &flipped))
        else {
            continue;
        };
        as_read += first.rms_mm;
        mirrored += second.rms_mm;
        if let Some(name) = network.images.get(number).map(|image| image.name.as_str())
            && let Some(row) = tables
                .images
                .as_ref()
                .and_then(|table| table.rows.iter().find(|row| &*row.image == name))
        {
            angles_tested += 1;
            let found = first.pose.orientation().attitude;
            let apart = |factor: f64| {
                found
                    .iter()
                    .zip(row.attitude_deg)
                    .map(|(found, given)| {
                        let difference = found - factor * given;
                        difference.sin().atan2(difference.cos()).abs()
                    })
                    .fold(0.0, f64::max)
            };
            if apart(1.0) < 0.02 && apart(1_f64.to_radians()) > 0.1 {
                angles_as_radians += 1;
            }
        }
    }
    let extent = network
        .image_points
        .iter()
        .map(|observed| observed.measured_mm[0].hypot(observed.measured_mm[1]))
        .fold(0.0, f64::max);
    let file = &tables.image_points.file;
    if mirrored * LEAST_IMPROVEMENT < as_read && as_read > MOST_RESIDUAL * extent {
        return Some(InputError::invalid(format!(
            "{file}: the images fit their known points {:.0} times better with y_mm reversed; y counts upwards in the sensor frame, \
             in an upright positive image",
            as_read / mirrored.max(1e-12)
        )));
    }
    if angles_tested > 0 && 2 * angles_as_radians > angles_tested {
        let file = tables.images.as_ref().map_or("", |table| &table.file);
        return Some(InputError::invalid(format!(
            "{file}: pitch_deg, roll_deg, yaw_deg fit the known points as radians; they are to be in degrees"
        )));
    }
    None
}

fn known_points(network: &Network, image: usize) -> Vec<KnownPoint> {
    network
        .image_points
        .iter()
        .filter(|observed| observed.image == image)
        .filter_map(|observed| {
            let point = network.points.get(observed.point)?;
            (point.role == PointRole::Control).then_some(KnownPoint {
                measured_mm: observed.measured_mm,
                ground_m: point.given_m,
            })
        })
        .collect()
}
