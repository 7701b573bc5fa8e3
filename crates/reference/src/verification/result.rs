//! Results of a verification.

use fmc_camera::io::link::message::Counters;
use serde::Serialize;

use super::device::Evidence;
use crate::strict::MAX_SOLVER_ERROR_NM;

/// Largest allowed error of dx and dy against the strict solver, nm.
pub const MAX_ERROR_NM: f64 = 1.5;
/// Largest allowed error of a corrected coordinate, nm: the rounding of a coordinate of 114 mm to
/// f32 alone is 3.8 nm.
pub const MAX_COORDINATE_ERROR_NM: f64 = 5.0;

/// Treatments of distortion that a verification compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Treatment {
    /// No correction at all.
    None,
    /// The static calibration about the calibrated principal point.
    Static,
    /// The static calibration plus the dynamic terms as printed, eqs. 20-21.
    Printed,
    /// Correction by this camera.
    Camera,
}

impl Treatment {
    /// All four, in the order of the tables.
    pub const ALL: [Self; 4] = [Self::None, Self::Static, Self::Printed, Self::Camera];

    /// Returns the name in tables and legends.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::None => "no correction",
            Self::Static => "static correction",
            Self::Printed => "static + printed (20)-(21)",
            Self::Camera => "this camera",
        }
    }
}

/// Statistics of the errors of dx and dy, both components pooled, mm.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorStatistics {
    count: u64,
    sum: f64,
    sum_of_squares: f64,
    max: f64,
}

impl ErrorStatistics {
    /// Adds the two components of one point's error, mm; NaN counts as an infinite error.
    pub fn add(&mut self, error_mm: [f64; 2]) {
        for error in error_mm.map(infinite_if_nan) {
            self.count += 1;
            self.sum += error;
            self.sum_of_squares += error * error;
            self.max = self.max.max(error.abs());
        }
    }

    /// Number of points whose errors were added.
    #[must_use]
    pub const fn points(&self) -> u64 {
        self.count / 2
    }

    /// Adds all errors of another set.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.sum_of_squares += other.sum_of_squares;
        self.max = self.max.max(other.max);
    }

    /// Largest absolute error of a component, mm.
    #[must_use]
    pub const fn max_mm(&self) -> f64 {
        self.max
    }

    /// Root mean square of the components, mm.
    #[must_use]
    pub fn rms_mm(&self) -> f64 {
        (self.sum_of_squares / self.number()).sqrt()
    }

    /// Mean of the components, mm.
    #[must_use]
    pub fn bias_mm(&self) -> f64 {
        self.sum / self.number()
    }

    #[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
    fn number(&self) -> f64 {
        self.count.max(1) as f64
    }
}

/// Replaces NaN by infinity.
pub(super) const fn infinite_if_nan(number: f64) -> f64 {
    if number.is_nan() {
        f64::INFINITY
    } else {
        number
    }
}

/// One exposure of a verification.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameResult {
    /// `centred`, `from-rest` or `tdi`.
    pub strategy: &'static str,
    /// η = V/H, 1/s.
    pub vh_per_s: f64,
    /// t, s.
    pub exposure_s: f64,
    /// δ, mm.
    pub travel_mm: f64,
    /// c̄, mm from the calibrated principal point.
    pub centroid_mm: f64,
    /// Errors of dx, dy by treatment, in the order of [`Treatment::ALL`].
    pub errors: [ErrorStatistics; 4],
    /// Errors of the corrected coordinate.
    pub coordinate_error: ErrorStatistics,
    /// Largest error estimate of the strict solver, mm.
    pub solver_error_mm: f64,
}

/// Distortion at one point of the sensor, mm, for the arrow fields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldPoint {
    /// Measured point.
    pub point_mm: [f64; 2],
    /// Static distortion, measured - ideal.
    pub static_mm: [f64; 2],
    /// Change by the exposure: strict exposure mean less static distortion.
    pub dynamic_mm: [f64; 2],
}

/// The arrow fields of one exposure.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Field {
    /// Index of the exposure in [`CameraResult::frames`].
    pub frame: usize,
    /// Points of a grid over the sensor.
    pub points: Vec<FieldPoint>,
}

/// The point with the largest error of this camera.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct WorstPoint {
    /// Largest of the errors of dx and dy, nm.
    pub error_nm: f64,
    /// Measured x, mm.
    pub x_mm: f64,
    /// Measured y, mm.
    pub y_mm: f64,
    /// η = V/H, 1/s.
    pub vh_per_s: f64,
    /// t, s.
    pub exposure_s: f64,
    /// `centred`, `from-rest` or `tdi`.
    pub strategy: &'static str,
}

/// Results of all exposures of one camera.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraResult {
    /// Name in the camera file.
    pub name: String,
    /// Format, mm along x and y.
    pub format_mm: [f64; 2],
    /// Principal distance f, mm.
    pub principal_distance_mm: f64,
    /// Pixel pitch, µm.
    pub pixel_um: f64,
    /// FMC axis as the camera file spells it.
    pub axis: &'static str,
    /// Number of points compared.
    pub points: u64,
    /// Result of every exposure.
    pub frames: Vec<FrameResult>,
    /// Smallest and largest length of the distortion over the sensor, mm.
    pub distortion_mm: [f64; 2],
    /// Arrow fields of the exposure with the largest dynamic change.
    pub field: Field,
    /// The point with the largest error.
    pub worst: WorstPoint,
}

impl CameraResult {
    /// Returns the errors of dx and dy with a treatment, all exposures pooled.
    #[must_use]
    pub fn errors(&self, treatment: Treatment) -> ErrorStatistics {
        let mut all = ErrorStatistics::default();
        for frame in &self.frames {
            for (one, errors) in Treatment::ALL.iter().zip(&frame.errors) {
                if *one == treatment {
                    all.merge(errors);
                }
            }
        }
        all
    }

    /// Returns the errors of the corrected coordinate, all exposures pooled.
    #[must_use]
    pub fn coordinate_errors(&self) -> ErrorStatistics {
        let mut all = ErrorStatistics::default();
        for frame in &self.frames {
            all.merge(&frame.coordinate_error);
        }
        all
    }

    /// Returns the smallest and the largest δ, mm.
    #[must_use]
    pub fn travel_mm(&self) -> [f64; 2] {
        self.frames
            .iter()
            .fold([f64::INFINITY, 0.0], |[least, most], frame| {
                [least.min(frame.travel_mm), most.max(frame.travel_mm)]
            })
    }

    /// Returns the largest error estimate of the strict solver, mm.
    #[must_use]
    pub fn solver_error_mm(&self) -> f64 {
        self.frames.iter().fold(0.0, |most, frame| {
            infinite_if_nan(frame.solver_error_mm).max(most)
        })
    }

    /// Returns true if at least one point was compared, every one is within the limits, and so is
    /// the strict solver.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.points > 0
            && 1e6 * self.errors(Treatment::Camera).max_mm() <= MAX_ERROR_NM
            && 1e6 * self.coordinate_errors().max_mm() <= MAX_COORDINATE_ERROR_NM
            && 1e6 * self.solver_error_mm() <= MAX_SOLVER_ERROR_NM
    }
}

/// Results of a whole verification.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// Description of the device that computed the corrections.
    pub device: String,
    /// Reason why the device was not QEMU although it was requested, and the remedy.
    pub not_in_qemu: Option<String>,
    /// Evidence that the points are the device's.
    pub evidence: Evidence,
    /// Counters of the device's end of the link.
    pub link: Option<Counters>,
    /// Difference of the device from its own code on this PC, at which the verification ended.
    pub difference: Option<String>,
    /// Results of every camera.
    pub cameras: Vec<CameraResult>,
}

impl Verification {
    /// Describes the device and, if it replaces QEMU, the reason.
    #[must_use]
    pub fn place(&self) -> String {
        match &self.not_in_qemu {
            Some(reason) => format!("{}, NOT in QEMU: {reason}", self.device),
            None => self.device.clone(),
        }
    }

    /// Number of points compared.
    #[must_use]
    pub fn points(&self) -> u64 {
        self.cameras.iter().map(|camera| camera.points).sum()
    }

    /// Returns the camera with the largest error of all.
    #[must_use]
    pub fn worst(&self) -> Option<&CameraResult> {
        self.cameras
            .iter()
            .max_by(|a, b| a.worst.error_nm.total_cmp(&b.worst.error_nm))
    }

    /// Returns true if at least one camera was checked, every one passed, and none differed from
    /// its own code on this PC.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.difference.is_none()
            && !self.cameras.is_empty()
            && self.cameras.iter().all(CameraResult::passed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(camera_nm: f64, coordinate_nm: f64, solver_nm: f64) -> CameraResult {
        let errors = |nm: f64| {
            let mut errors = ErrorStatistics::default();
            errors.add([0.0, 1e-6 * nm]);
            errors
        };
        CameraResult {
            name: "test".to_owned(),
            format_mm: [20.0, 10.0],
            principal_distance_mm: 50.0,
            pixel_um: 5.0,
            axis: "+y",
            points: 1,
            frames: vec![FrameResult {
                strategy: "centred",
                vh_per_s: 0.1,
                exposure_s: 0.01,
                travel_mm: 0.05,
                centroid_mm: 0.0,
                errors: [errors(9.0), errors(9.0), errors(9.0), errors(camera_nm)],
                coordinate_error: errors(coordinate_nm),
                solver_error_mm: 1e-6 * solver_nm,
            }],
            distortion_mm: [0.0, 1.0],
            field: Field::default(),
            worst: WorstPoint::default(),
        }
    }

    #[test]
    fn each_limit_decides_alone_and_either_sign_counts() {
        assert!(camera(1.4, 4.9, 0.009).passed());
        for wrong in [
            camera(1.6, 4.9, 0.009),
            camera(-1.6, 4.9, 0.009),
            camera(1.4, 5.1, 0.009),
            camera(1.4, -5.1, 0.009),
            camera(1.4, 4.9, 0.011),
            camera(f64::NAN, 4.9, 0.009),
            camera(1.4, f64::NAN, 0.009),
            camera(1.4, 4.9, f64::NAN),
        ] {
            assert!(!wrong.passed());
        }
        let mut nothing = camera(0.0, 0.0, 0.0);
        nothing.points = 0;
        assert!(!nothing.passed());
    }

    #[test]
    fn statistics_are_those_of_both_components() {
        let mut errors = ErrorStatistics::default();
        errors.add([3.0, -4.0]);
        errors.add([0.0, -1.0]);
        assert_eq!(errors.points(), 2);
        assert!((errors.max_mm() - 4.0).abs() < 1e-15);
        assert!((errors.rms_mm() - (26.0_f64 / 4.0).sqrt()).abs() < 1e-15);
        assert!((errors.bias_mm() + 0.5).abs() < 1e-15);
    }
}
