//! Models that a program offers, and the coefficients of each.

use crate::coefficient::Coefficient::{
    self, Decentring, Divisor, FocalX, Prism, Radial, Skew, Tilt,
};

/// A model of a program that distorts rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Name, as the command line and the program have it.
    pub name: &'static str,
    /// Coefficients of the lens that it has.
    pub lens: &'static [Coefficient],
    /// Coefficients that take up the affinity B1, B2.
    pub affinity: &'static [Coefficient],
}

impl Model {
    /// Returns a model.
    pub(crate) const fn new(
        name: &'static str,
        lens: &'static [Coefficient],
        affinity: &'static [Coefficient],
    ) -> Self {
        Self {
            name,
            lens,
            affinity,
        }
    }
}

/// Radial and decentring coefficients, as most programs have them.
pub(crate) const BROWN_2: &[Coefficient] = &[Radial(0), Radial(1), Decentring(0), Decentring(1)];
pub(crate) const BROWN_3: &[Coefficient] = &[
    Radial(0),
    Radial(1),
    Radial(2),
    Decentring(0),
    Decentring(1),
];
pub(crate) const BROWN_4: &[Coefficient] = &[
    Radial(0),
    Radial(1),
    Radial(2),
    Radial(3),
    Decentring(0),
    Decentring(1),
];
pub(crate) const RATIONAL: &[Coefficient] = &[
    Radial(0),
    Radial(1),
    Radial(2),
    Divisor(0),
    Divisor(1),
    Divisor(2),
    Decentring(0),
    Decentring(1),
];
pub(crate) const TILTED: &[Coefficient] = &[
    Radial(0),
    Radial(1),
    Radial(2),
    Divisor(0),
    Divisor(1),
    Divisor(2),
    Decentring(0),
    Decentring(1),
    Prism(0),
    Prism(1),
    Prism(2),
    Prism(3),
    Tilt(0),
    Tilt(1),
];

/// Affinity of a program with fx and fy.
pub(crate) const TWO_FOCALS: &[Coefficient] = &[FocalX];
/// Affinity of a program with skew, too.
pub(crate) const FOCALS_AND_SKEW: &[Coefficient] = &[FocalX, Skew];
