//! Tests of the records of a flight by the observed positions, and comparison with a bundle that
//! knows one principal point.

use nalgebra::Vector3;

use super::calibration::{BundleCalibration, CalibrationOptions};
use super::error::BundleCalibrationError;
use super::network::PointRole;
use super::snooping::critical_values;
use super::state::State;
use super::tables::NetworkTables;
use super::tested::Tests;
use crate::calibration::result::residual::TestedResidual;

/// Sine of the angle between two strips above which they cross.
pub const CROSSING_SINE: f64 = 0.5;

/// Probability that any good record of a flight is doubted, shared by all. It is smaller than that
/// for image points: a flight has few records, a wrong one is wrong by far, and a doubt costs the
/// camera a visit to the laboratory.
pub const RECORD_ERROR: f64 = 0.001;

/// Control points that show records of the wrong sign.
pub const LEAST_CONTROL: usize = 5;

/// Largest number of records that are named one after the other.
pub const MOST_NAMED: usize = 10;

/// Test of the record of one image.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordTest {
    /// Name of the image.
    pub image: String,
    /// Observed position less projection centre along the motion of the principal point, m.
    pub tested: TestedResidual,
}

/// Tests of all records.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordTests {
    /// Tests, in the order of the images; of images with an observed position alone.
    pub all: Vec<RecordTest>,
    /// Critical value, for [`RECORD_ERROR`].
    pub critical: f64,
}

impl RecordTests {
    /// Tests the records of a bundle whose principal points move along a direction of the sensor
    /// frame.
    ///
    /// # Model
    /// A wrong c̄ of one exposure moves its projection centre along the motion by -c̄·H/f, against
    /// the observed position. Pope's τ of that component of the residual, σ0 estimated.
    #[must_use]
    pub fn of(calibration: &BundleCalibration, direction: [f64; 2]) -> Self {
        let snooped = &calibration.snooped;
        let (network, solution) = (&snooped.network, &snooped.solution);
        let all: Vec<RecordTest> = Tests::along(network, solution, &snooped.cofactors, direction)
            .into_iter()
            .filter_map(|(number, tested)| {
                let image = network.images.get(number)?.name.clone();
                Some(RecordTest { image, tested })
            })
            .collect();
        let [critical, _] = critical_values(RECORD_ERROR, all.len(), solution.redundancy());
        Self { all, critical }
    }

    /// Returns the records above the critical value, the worst first.
    #[must_use]
    pub fn suspects(&self) -> Vec<&RecordTest> {
        let value = |test: &RecordTest| test.tested.test_value;
        let mut suspects: Vec<&RecordTest> = self
            .all
            .iter()
            .filter(|test| value(test) > self.critical)
            .collect();
        suspects.sort_by(|a, b| value(b).total_cmp(&value(a)));
        suspects
    }
}

/// Names the records that are wrong, one after the other: the worst above the critical value, then
/// the worst of an adjustment without the observed position of its image, which may pull its
/// neighbours along. At most [`MOST_NAMED`].
///
/// # Errors
/// [`BundleCalibrationError`] of a further adjustment.
pub fn wrong_records(
    calibration: &BundleCalibration,
    tables: &NetworkTables,
    options: &CalibrationOptions,
    direction: [f64; 2],
) -> Result<Vec<String>, BundleCalibrationError> {
    let worst = |calibration: &BundleCalibration| {
        let tests = RecordTests::of(calibration, direction);
        tests.suspects().first().map(|test| test.image.clone())
    };
    let mut tables = tables.clone();
    let mut named = Vec::new();
    let mut next = worst(calibration);
    while let Some(image) = next.take().filter(|_| named.len() < MOST_NAMED) {
        let rows = tables.images.iter_mut().flat_map(|images| &mut images.rows);
        for row in rows.filter(|row| *row.image == *image) {
            let [.., pitch, roll, yaw] = row.sigmas;
            row.sigmas = [None, None, None, pitch, roll, yaw];
        }
        named.push(image);
        next = worst(&BundleCalibration::new(
            &tables,
            calibration.start,
            options,
        )?);
    }
    Ok(named)
}

/// Returns true if all principal points move along one line of the ground and fewer than
/// [`LEAST_CONTROL`] points are control: the residuals then do not show records of the wrong sign.
#[must_use]
pub fn is_blind_to_sign(calibration: &BundleCalibration, [x, y]: [f64; 2]) -> bool {
    let snooped = &calibration.snooped;
    let points = snooped.network.points.iter();
    let control = points.filter(|point| point.role == PointRole::Control);
    let direction = Vector3::new(x, y, 0.0);
    let poses = snooped.solution.state.poses.iter();
    let mut directions = poses.map(|pose| pose.rotation * direction);
    let first = directions.next().unwrap_or_default();
    control.count() < LEAST_CONTROL
        && directions.all(|other| first.cross(&other).norm() < CROSSING_SINE)
}

/// Returns the differences of the check points, adjusted less given, root mean square by axis, m;
/// `None` without any.
#[must_use]
pub fn check_points_rms_m(calibration: &BundleCalibration) -> Option<[f64; 3]> {
    let snooped = &calibration.snooped;
    let points = snooped.network.points.iter().enumerate();
    let check = points.filter(|(_, point)| point.role == PointRole::Check);
    root_mean_square(
        check
            .filter(|(number, _)| is_adjusted(calibration, *number))
            .map(|(number, point)| snooped.solution.state.point(number) - point.given_m),
    )
}

/// Returns the differences of the object points of two bundles of the same tables, root mean square
/// by axis, m; `None` without any.
#[must_use]
pub fn difference_rms_m(one: &BundleCalibration, other: &BundleCalibration) -> Option<[f64; 3]> {
    let [a, b] = [one, other].map(|bundle| &bundle.snooped.solution.state);
    root_mean_square(
        (0..a.points_m.len())
            .filter(|number| is_adjusted(one, *number) && is_adjusted(other, *number))
            .map(|number| a.point(number) - b.point(number)),
    )
}

/// Returns the unit vector of the ground along which the principal point of the first image moves.
#[must_use]
pub fn motion_on_ground(calibration: &BundleCalibration, [x, y]: [f64; 2]) -> Vector3<f64> {
    let mut poses = calibration.snooped.solution.state.poses.iter();
    let motion = poses
        .next()
        .map(|pose| pose.rotation * Vector3::new(x, y, 0.0));
    motion.unwrap_or_default()
}

/// Returns the differences of the check points, adjusted less given, along a direction of the
/// ground, m.
#[must_use]
pub fn check_points_along_m(calibration: &BundleCalibration, direction: Vector3<f64>) -> Vec<f64> {
    let snooped = &calibration.snooped;
    let points = snooped.network.points.iter().enumerate();
    points
        .filter(|(number, point)| {
            point.role == PointRole::Check && is_adjusted(calibration, *number)
        })
        .map(|(number, point)| snooped.solution.state.point(number) - point.given_m)
        .map(|difference| difference.dot(&direction))
        .collect()
}

/// Returns the differences of the object points of two bundles of the same tables along a direction
/// of the ground, m.
#[must_use]
pub fn differences_along_m(
    one: &BundleCalibration,
    other: &BundleCalibration,
    direction: Vector3<f64>,
) -> Vec<f64> {
    let [a, b] = [one, other].map(|bundle| &bundle.snooped.solution.state);
    (0..a.points_m.len())
        .filter(|number| is_adjusted(one, *number) && is_adjusted(other, *number))
        .map(|number| (a.point(number) - b.point(number)).dot(&direction))
        .collect()
}

fn root_mean_square(vectors: impl Iterator<Item = Vector3<f64>>) -> Option<[f64; 3]> {
    let (count, sum) = vectors.fold((0_u32, Vector3::zeros()), |(count, sum), one| {
        (count + 1, sum + one.component_mul(&one))
    });
    (count > 0).then(|| (sum / f64::from(count)).map(f64::sqrt).into())
}

fn is_adjusted(calibration: &BundleCalibration, point: usize) -> bool {
    State::is_unknown(&calibration.snooped.solution.layout, point)
}
