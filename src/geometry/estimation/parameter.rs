//! The unknowns of an adjustment.

use core::fmt;

/// An unknown, in the order of the columns of the design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Parameter {
    /// `K_m0`, mm⁰.
    Km0,
    /// `K_m1`, mm⁻².
    Km1,
    /// `K_m2`, mm⁻⁴.
    Km2,
    /// `K_d1`, mm⁻².
    Kd1,
    /// `P_m1`, mm⁻².
    Pm1,
    /// The static decentring along the FMC axis, mm⁻¹: P2 for e = ±y, P1 for e = ±x.
    Decentring,
}

/// Largest number of unknowns.
pub const PARAMETERS: usize = 6;

impl Parameter {
    /// All parameters, in the order of the columns.
    pub const ALL: [Self; PARAMETERS] = [
        Self::Km0,
        Self::Km1,
        Self::Km2,
        Self::Kd1,
        Self::Pm1,
        Self::Decentring,
    ];

    /// Returns its place in [`Self::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Km0 => 0,
            Self::Km1 => 1,
            Self::Km2 => 2,
            Self::Kd1 => 3,
            Self::Pm1 => 4,
            Self::Decentring => 5,
        }
    }

    /// Returns the symbol for messages.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Km0 => "K_m0",
            Self::Km1 => "K_m1",
            Self::Km2 => "K_m2",
            Self::Kd1 => "K_d1",
            Self::Pm1 => "P_m1",
            Self::Decentring => "the static decentring along the FMC axis (P2 for ±y, P1 for ±x)",
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}
