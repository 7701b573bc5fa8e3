//! Assumptions of an error budget.

/// Uncertainties that a camera file does not state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assumptions {
    /// Flying height H, m.
    pub height_m: f64,
    /// Focus shift that was not measured, mm.
    pub focus_mm: f64,
    /// Relative error of V/H.
    pub vh_error: f64,
    /// h/H: height of the terrain above the plane that V/H holds for, relative to H.
    pub relief: f64,
    /// χ: drift that the camera's mount does not turn out, °.
    pub drift_deg: f64,
    /// Rate of roll, of pitch and of yaw, °/s.
    pub rate_deg_s: f64,
    /// Step of the stage's encoder, mm.
    pub encoder_mm: f64,
    /// Error of the time stamp, s.
    pub timing_s: f64,
}

/// Part of a focus shift that is left when it is corrected as a pure enlargement, relative to the
/// shift: 173 nm per 10 µm, the worst of four ray-traced lenses (a wide-angle retrofocus).
pub const FOCUS_REMAINDER: f64 = 0.173 / 10.0;
