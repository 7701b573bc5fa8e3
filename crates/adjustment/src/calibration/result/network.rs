//! Images and object points of a calibration.

use std::sync::Arc;

/// Projection centre and attitude of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageStation {
    /// Name of the image.
    pub image: Arc<str>,
    /// Projection centre in the object frame, m.
    pub position_m: [f64; 3],
    /// σ of it, multiplied by σ0, m; `None` if it was not computed.
    pub position_sigma_m: Option<[f64; 3]>,
    /// Pitch, roll, yaw, degrees: `ground_from_camera = Rz(yaw)·Rx(pitch)·Ry(roll)`.
    pub attitude_deg: [f64; 3],
    /// σ of them, multiplied by σ0, degrees; `None` if they were not computed.
    pub attitude_sigma_deg: Option<[f64; 3]>,
    /// Accepted image points.
    pub points: usize,
    /// Root of the mean square of its residuals along an axis, mm.
    pub residual_rms_mm: f64,
}

/// Part that an object point has in a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointRole {
    /// Its coordinates are held, or observations with σ.
    Control,
    /// Its coordinates are known, but not used: they judge the result.
    Check,
    /// Its coordinates are unknown.
    New,
}

impl PointRole {
    /// Returns the name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Control => "control",
            Self::Check => "check",
            Self::New => "new",
        }
    }
}

/// An object point.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectPoint {
    /// Name.
    pub point: Arc<str>,
    /// Role.
    pub role: PointRole,
    /// Adjusted coordinates in the object frame, m.
    pub position_m: [f64; 3],
    /// σ of them, multiplied by σ0, m; 0 for a coordinate that was held.
    pub sigma_m: [f64; 3],
    /// Coordinates as given, m; `None` for a new point.
    pub given_m: Option<[f64; 3]>,
    /// Number of images with the point in the adjustment.
    pub rays: usize,
    /// Largest angle between two of its rays, degrees; `None` with fewer than two.
    pub intersection_deg: Option<f64>,
    /// Largest (adjusted - given)/σ of a check point, or the test value of a control point.
    pub test_value: Option<f64>,
}
