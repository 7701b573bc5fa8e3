//! Options of an adjustment: the unknowns to estimate, and their regressor.

use crate::geometry::five_coefficient::Regressor;

/// Treatment of the static decentring along the FMC axis. Its displacement differs from that of
/// `K_d1` and `P_m1` only in that it is the same in every exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StaticDecentring {
    /// Held at the calibration's value; the data must be able to tell it from the dynamic terms.
    #[default]
    Hold,
    /// Estimated beside the five coefficients.
    Estimate,
    /// Held and taken to be free of error. One exposure suffices; an error of the value passes into
    /// `K_d1` and `P_m1`.
    Known,
}

/// Options of an adjustment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FitOptions {
    /// Regressor of `K_d1` and `P_m1`.
    pub regressor: Regressor,
    /// `true` to impose `K_d1` = 2`P_m1`, which holds for a distortion of K1 alone.
    pub tied: bool,
    /// Treatment of the static decentring along the FMC axis.
    pub decentring: StaticDecentring,
}
