//! Distortion table of one focus setting.

use std::sync::Arc;

use super::homography::EIGHT;
use super::interpolation::{CrossValidation, InterpolatedTable, Interpolator};
use crate::calibration::result::CalibrationResult;

/// Largest number of targets of a cross-validation.
const MOST_VALIDATED: usize = 5000;

/// One row of a distortion table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableRow {
    /// Target.
    pub target: Arc<str>,
    /// Measured point, mm.
    pub measured_mm: [f64; 2],
    /// Δ = measured - ideal of the table's homography, (8) of Feng et al., mm.
    pub distortion_mm: [f64; 2],
    /// measured - ideal of the homography that goes with the camera file, mm: about the f and the
    /// principal point of the camera.
    pub of_camera_mm: [f64; 2],
}

/// Interior orientation that a table belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gauge {
    /// f, mm.
    pub principal_distance_mm: f64,
    /// (x0, y0), mm.
    pub principal_point_mm: [f64; 2],
    /// B1, B2.
    pub affinity: [f64; 2],
    /// Angle between the optical axis of the table and that of the camera, degrees.
    pub axis_deg: f64,
}

/// Errors of one interpolation, by cross-validation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterpolationError {
    /// Interpolation.
    pub interpolator: Interpolator,
    /// Of the table as it is; `None` if no target can be judged.
    pub of_table: Option<CrossValidation>,
    /// Of the table without its main term (9).
    pub of_remainder: Option<CrossValidation>,
}

/// A distortion table of one focus setting, and the calibration of the camera file that goes with
/// it.
#[derive(Debug, Clone)]
pub struct Dlt2d {
    /// Focus setting.
    pub focus: Option<Arc<str>>,
    /// Polynomial of the camera file.
    pub result: CalibrationResult,
    /// The table: accepted targets.
    pub rows: Vec<TableRow>,
    /// Interior orientation of the table.
    pub gauge: Gauge,
    /// l1 to l8, metres to mm; `None` if the plane's origin has no image.
    pub eight: Option<[f64; EIGHT]>,
    /// k0, k1, k2 of (9), fitted to the table.
    pub main_term: Option<[f64; 3]>,
    /// The table with the lattice of its targets, for interpolation.
    pub table: InterpolatedTable,
    /// The table without its main term.
    pub remainder: Option<InterpolatedTable>,
}

impl Dlt2d {
    /// Returns the errors of the four interpolations; empty for more targets than can be judged
    /// one by one.
    #[must_use]
    pub fn interpolation(&self) -> Vec<InterpolationError> {
        if self.rows.len() > MOST_VALIDATED {
            return Vec::new();
        }
        Interpolator::ALL
            .into_iter()
            .map(|interpolator| InterpolationError {
                interpolator,
                of_table: self.table.cross_validation(interpolator),
                of_remainder: self
                    .remainder
                    .as_ref()
                    .and_then(|table| table.cross_validation(interpolator)),
            })
            .collect()
    }
}
