//! Observations and choices of the precise-angle method for an area camera, and its result.

use fmc_camera_file::CameraFile;
use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::Vector3;

use crate::bundle::interior::InteriorElement;
use crate::calibration::result::{CalibrationResult, InputFile};

/// Largest angle, degrees.
pub const LARGEST_ANGLE_DEG: f64 = 89.0;

/// Range of the stage offsets, mm, below which they tell nothing about the stage.
pub const LEAST_STAGE_RANGE_MM: f64 = 1e-3;

/// A direction of the turntable in the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldDirection {
    /// Line in the file.
    pub line: u64,
    /// A, towards +x of the sensor frame, degrees.
    pub azimuth_deg: f64,
    /// E, towards +y of the sensor frame, degrees.
    pub elevation_deg: f64,
    /// Measured point in the sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// σ of either coordinate, mm.
    pub sigma_mm: f64,
    /// c, place of the stage along the FMC axis from its calibrated place, mm.
    pub stage_offset_mm: f64,
}

impl FieldDirection {
    /// Returns the direction in the frame of the turntable: (cosE·sinA, sinE, -cosE·cosA).
    #[must_use]
    pub fn direction(&self) -> Vector3<f64> {
        let (sin_a, cos_a) = self.azimuth_deg.to_radians().sin_cos();
        let (sin_e, cos_e) = self.elevation_deg.to_radians().sin_cos();
        Vector3::new(cos_e * sin_a, sin_e, -cos_e * cos_a)
    }

    /// Derivatives of the direction by A and by E, rad.
    pub(super) fn by_angles(&self) -> [Vector3<f64>; 2] {
        let (sin_a, cos_a) = self.azimuth_deg.to_radians().sin_cos();
        let (sin_e, cos_e) = self.elevation_deg.to_radians().sin_cos();
        [
            Vector3::new(cos_e * cos_a, 0.0, cos_e * sin_a),
            Vector3::new(-sin_e * sin_a, cos_e, sin_e * cos_a),
        ]
    }
}

/// Observations and choices of the precise-angle method for an area camera.
#[derive(Debug, Clone)]
pub struct FieldAnglesRequest<'a> {
    /// File of the observations.
    pub input: InputFile,
    /// Observations.
    pub observations: &'a [FieldDirection],
    /// `true` if the file has offsets of the stage, which are then to be calibrated.
    pub has_stage: bool,
    /// Camera file; what is not estimated is held at its values.
    pub camera: &'a CameraFile,
    /// Its residual grids, which are held; empty for a camera without.
    pub grids: &'a ResidualSplines,
    /// Elements of the interior orientation that are estimated.
    pub estimated: &'a [InteriorElement],
    /// σ of either angle, rad.
    pub sigma_angle_rad: f64,
    /// `true` if no observation is rejected as a gross error.
    pub keeps_all: bool,
}

/// A calibration of an area camera by precise angles.
#[derive(Debug, Clone)]
pub struct FieldAngles {
    /// The result.
    pub result: CalibrationResult,
    /// Attitude of the camera in the frame of the turntable.
    pub mount: Mount,
    /// Stage, if it was calibrated.
    pub stage: Option<CalibratedStage>,
}

/// Attitude of the camera in the frame of the turntable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    /// Pitch, roll, yaw, degrees: `turntable_from_camera = Rz(yaw)·Rx(pitch)·Ry(roll)`.
    pub attitude_deg: [f64; 3],
    /// σ of them, multiplied by σ0, degrees.
    pub sigma_deg: [f64; 3],
}

/// Offsets at which the stage has been calibrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibratedStage {
    /// Number of distinct offsets.
    pub offsets: usize,
    /// Smallest and largest, mm.
    pub range_mm: [f64; 2],
}
