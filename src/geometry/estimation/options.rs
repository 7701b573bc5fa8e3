//! What is estimated, and on what it is regressed.

use crate::geometry::five_coefficient::Regressor;

/// What becomes of the static decentring along the FMC axis, whose displacement differs from that
/// of `K_d1` and `P_m1` in one thing alone: it does not change from exposure to exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StaticDecentring {
    /// Held at the calibration's value; the data must be able to tell it from the dynamic terms.
    #[default]
    Hold,
    /// Estimated beside the five coefficients.
    Estimate,
    /// Held and believed without error. One exposure suffices; an error of the value passes into
    /// `K_d1` and `P_m1`.
    Known,
}

/// Options of an adjustment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FitOptions {
    /// What `K_d1` and `P_m1` are multiplied by.
    pub regressor: Regressor,
    /// Whether `K_d1` = 2`P_m1` is imposed: what a distortion of K1 alone demands.
    pub tied: bool,
    /// The static decentring along the FMC axis.
    pub decentring: StaticDecentring,
}
