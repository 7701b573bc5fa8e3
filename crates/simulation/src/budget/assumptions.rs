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

/// An assumption in the unit of its name: what a user states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Name with the unit, as in [`Stated`].
    pub name: &'static str,
    /// Value where none is stated.
    pub usual: f64,
    /// Least value that is believable.
    pub least: f64,
    /// Largest value that is believable.
    pub most: f64,
}

impl Quantity {
    const fn new(name: &'static str, usual: f64, [least, most]: [f64; 2]) -> Self {
        Self {
            name,
            usual,
            least,
            most,
        }
    }
}

/// Height above the ground, m.
pub const HEIGHT_M: Quantity = Quantity::new("height_m", 1000.0, [10.0, 20_000.0]);
/// Focus shift that was not measured, µm.
pub const FOCUS_UM: Quantity = Quantity::new("focus_um", 5.0, [0.0, 100.0]);
/// Error of V/H, %.
pub const VH_ERROR_PERCENT: Quantity = Quantity::new("vh_error_percent", 1.0, [0.0, 50.0]);
/// Terrain above the height that V/H holds for, % of it.
pub const RELIEF_PERCENT: Quantity = Quantity::new("relief_percent", 10.0, [0.0, 50.0]);
/// Drift angle that is not compensated, °.
pub const DRIFT_DEG: Quantity = Quantity::new("drift_deg", 1.0, [0.0, 45.0]);
/// Rate of roll, of pitch and of yaw that the mount leaves, °/s.
pub const RATE_DEG_S: Quantity = Quantity::new("rate_deg_s", 1.0, [0.0, 60.0]);
/// Step of the stage's encoder, µm.
pub const ENCODER_UM: Quantity = Quantity::new("encoder_um", 1.0, [0.0, 100.0]);
/// Error of the time stamp against position and attitude, ms.
pub const TIMING_MS: Quantity = Quantity::new("timing_ms", 0.1, [0.0, 100.0]);

/// Assumptions as a user states them, each in the unit of its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stated {
    /// [`HEIGHT_M`].
    pub height_m: f64,
    /// [`FOCUS_UM`].
    pub focus_um: f64,
    /// [`VH_ERROR_PERCENT`].
    pub vh_error_percent: f64,
    /// [`RELIEF_PERCENT`].
    pub relief_percent: f64,
    /// [`DRIFT_DEG`].
    pub drift_deg: f64,
    /// [`RATE_DEG_S`].
    pub rate_deg_s: f64,
    /// [`ENCODER_UM`].
    pub encoder_um: f64,
    /// [`TIMING_MS`].
    pub timing_ms: f64,
}

impl Stated {
    /// Returns the first value outside its range, with its quantity.
    #[must_use]
    pub fn outside(&self) -> Option<(Quantity, f64)> {
        let values = [
            (HEIGHT_M, self.height_m),
            (FOCUS_UM, self.focus_um),
            (VH_ERROR_PERCENT, self.vh_error_percent),
            (RELIEF_PERCENT, self.relief_percent),
            (DRIFT_DEG, self.drift_deg),
            (RATE_DEG_S, self.rate_deg_s),
            (ENCODER_UM, self.encoder_um),
            (TIMING_MS, self.timing_ms),
        ];
        values
            .into_iter()
            .find(|(quantity, value)| !(quantity.least..=quantity.most).contains(value))
    }
}

impl From<Stated> for Assumptions {
    fn from(stated: Stated) -> Self {
        Self {
            height_m: stated.height_m,
            focus_mm: stated.focus_um / 1000.0,
            vh_error: stated.vh_error_percent / 100.0,
            relief: stated.relief_percent / 100.0,
            drift_deg: stated.drift_deg,
            rate_deg_s: stated.rate_deg_s,
            encoder_mm: stated.encoder_um / 1000.0,
            timing_s: stated.timing_ms / 1000.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const USUAL: Stated = Stated {
        height_m: HEIGHT_M.usual,
        focus_um: FOCUS_UM.usual,
        vh_error_percent: VH_ERROR_PERCENT.usual,
        relief_percent: RELIEF_PERCENT.usual,
        drift_deg: DRIFT_DEG.usual,
        rate_deg_s: RATE_DEG_S.usual,
        encoder_um: ENCODER_UM.usual,
        timing_ms: TIMING_MS.usual,
    };

    #[test]
    fn value_outside_its_range_is_found_with_its_quantity() {
        assert_eq!(USUAL.outside(), None);
        for (value, is_outside) in [(9.9, true), (10.0, false), (2e4, false), (2.1e4, true)] {
            let stated = Stated {
                height_m: value,
                ..USUAL
            };
            let expected = is_outside.then_some((HEIGHT_M, value));
            assert_eq!(stated.outside(), expected, "{value}");
        }
        let stated = Stated {
            timing_ms: f64::NAN,
            ..USUAL
        };
        assert_eq!(stated.outside().map(|(one, _)| one), Some(TIMING_MS));
    }
}
