//! Motion, attitude and compensation of the camera in one exposure.

/// Motion of the camera over the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GroundMotion {
    /// η = V/H, with H above the reference plane, 1/s.
    pub vh_per_s: f32,
    /// h/H: terrain above the reference plane, per cent of H; negative below it.
    pub relief_percent: f32,
    /// χ: angle by which the track points to the right of the camera's forward axis, °.
    pub drift_deg: f32,
}

/// Attitude of the camera at the exposure's centroid, and its rates about the camera's axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Attitude {
    /// θ, right-handed about the axis to the right: the optical axis forward of the vertical, °.
    pub pitch_deg: f32,
    /// φ, right-handed about the forward axis: the optical axis to the left of the vertical, °.
    pub roll_deg: f32,
    /// Rate about the axis to the right, °/s.
    pub pitch_rate_deg_s: f32,
    /// Rate about the forward axis, °/s.
    pub roll_rate_deg_s: f32,
    /// Rate about the axis upwards: positive turns the nose to the left, °/s.
    pub yaw_rate_deg_s: f32,
}

/// Motion, attitude and compensation of one exposure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlightState {
    /// Motion over the ground.
    pub motion: GroundMotion,
    /// Attitude and its rates.
    pub attitude: Attitude,
    /// V/H for which the mechanism compensates, 1/s; 0 if the mechanism stands still.
    pub compensated_vh_per_s: f32,
}
