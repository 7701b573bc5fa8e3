//! Quantities of a record that are judged by their σ.

use serde::Serialize;

/// A quantity of a record for which it states a σ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Centroid principal point along the FMC axis.
    PrincipalPoint,
    /// V/H.
    Vh,
    /// Centroid time in UTC.
    Utc,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::PrincipalPoint, Self::Vh, Self::Utc];

    /// Returns the name for sentences.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PrincipalPoint => "principal point",
            Self::Vh => "V/H",
            Self::Utc => "UTC",
        }
    }

    /// Returns the name of the file of its figure.
    #[must_use]
    pub const fn file_name(self) -> &'static str {
        match self {
            Self::PrincipalPoint => "principal-point.svg",
            Self::Vh => "vh.svg",
            Self::Utc => "utc.svg",
        }
    }

    /// Returns the largest root mean square of error/σ that a right σ may have.
    #[must_use]
    pub const fn largest_rms(self) -> f64 {
        match self {
            Self::PrincipalPoint | Self::Utc => 1.2,
            Self::Vh => 1.3,
        }
    }

    /// Returns the largest shares of errors beyond 3 σ and beyond 5 σ: of a normal distribution,
    /// 0.27 % and 6e-7, and somewhat more for V/H, whose σ holds for an air that nobody knows.
    #[must_use]
    pub const fn largest_shares(self) -> [f64; 2] {
        match self {
            Self::PrincipalPoint | Self::Utc => [0.003, 6e-7],
            Self::Vh => [0.02, 0.001],
        }
    }
}
