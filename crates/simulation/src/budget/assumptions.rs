//! What a budget assumes.

/// Uncertainties that no camera file holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assumptions {
    /// H, m.
    pub height_m: f64,
    /// Focus shift that nobody measured, mm.
    pub focus_mm: f64,
    /// Relative error of V/H.
    pub vh_error: f64,
    /// h/H: terrain above the height that V/H holds for.
    pub relief: f64,
    /// χ: drift that is not turned out, °.
    pub drift_deg: f64,
    /// Rate of roll, of pitch and of yaw, °/s.
    pub rate_deg_s: f64,
    /// Step of the stage's encoder, mm.
    pub encoder_mm: f64,
    /// Error of the time stamp, s.
    pub timing_s: f64,
}

/// What a lens leaves of a focus shift that was corrected as a pure enlargement, relative to the
/// shift: 173 nm per 10 µm, the worst of four ray-traced lenses (a wide-angle retrofocus).
pub const FOCUS_REMAINDER: f64 = 0.173 / 10.0;
