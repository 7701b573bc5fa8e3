//! Result of an adjustment, and the errors it may end with.

use core::fmt;

use super::number::Number;
use super::options::FitOptions;
use super::parameter::{PARAMETERS, Parameter};
use crate::geometry::five_coefficient::FiveCoefficients;

/// Adjusted coefficients in powers of mm, with their precision as the observations give it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fit<T> {
    /// Options of the adjustment.
    pub options: FitOptions,
    /// n: points observed, two observations each.
    pub points: u32,
    /// u: unknowns estimated.
    pub unknowns: u32,
    /// The parameters, in the order of [`Parameter::ALL`]; one that is held has the value it is
    /// held at.
    pub values: [T; PARAMETERS],
    /// Their standard deviations, by σ0; zero for one that is held.
    pub standard_deviations: [T; PARAMETERS],
    /// Their correlations; zero with one that is held.
    pub correlations: [[T; PARAMETERS]; PARAMETERS],
    /// σ0 = √(ΣPvv/(2n - u)): ratio of the residuals to the standard deviations given with the
    /// observations.
    pub sigma0: T,
    /// √(ΣPvv/(n - u)) as printed in Yuan et al. 2012, eq. 28, for comparison: it counts n where
    /// there are 2n observations. None for n ≤ u.
    pub sigma0_as_printed: Option<T>,
    /// Condition number of the design with columns of unit length.
    pub condition: T,
}

impl<T: Number> Fit<T> {
    /// A parameter, in powers of mm.
    #[must_use]
    pub fn value(&self, parameter: Parameter) -> T {
        element(&self.values, parameter)
    }

    /// The standard deviation of a parameter, in powers of mm.
    #[must_use]
    pub fn standard_deviation(&self, parameter: Parameter) -> T {
        element(&self.standard_deviations, parameter)
    }

    /// The correlation of two parameters.
    #[must_use]
    pub fn correlation(&self, first: Parameter, second: Parameter) -> T {
        self.correlations
            .get(first.index())
            .map_or(T::ZERO, |row| element(row, second))
    }

    /// The covariance of two parameters, in powers of mm.
    #[must_use]
    pub fn covariance(&self, first: Parameter, second: Parameter) -> T {
        self.correlation(first, second)
            * self.standard_deviation(first)
            * self.standard_deviation(second)
    }

    /// Degrees of freedom, 2n - u.
    #[must_use]
    pub const fn redundancy(&self) -> u32 {
        self.points.saturating_mul(2).saturating_sub(self.unknowns)
    }

    /// Returns the five coefficients as the correction takes them.
    #[must_use]
    pub fn coefficients(&self) -> FiveCoefficients {
        let single = |parameter| self.value(parameter).single();
        FiveCoefficients {
            km0: single(Parameter::Km0),
            km1: single(Parameter::Km1),
            km2: single(Parameter::Km2),
            kd1: single(Parameter::Kd1),
            pm1: single(Parameter::Pm1),
            regressor: self.options.regressor,
        }
    }
}

fn element<T: Number>(values: &[T; PARAMETERS], parameter: Parameter) -> T {
    values.get(parameter.index()).copied().unwrap_or(T::ZERO)
}

/// The observations do not determine the coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FitError {
    /// There are too few points.
    TooFew {
        /// Points observed.
        points: u32,
        /// Points needed.
        needed: u32,
    },
    /// All points are on one line, or at one place.
    OnALine {
        /// Root mean square of their distances from it, mm.
        spread_mm: f32,
    },
    /// The regressor is zero in every exposure, as c̄ is with a centred run-up: nothing determines
    /// `K_d1` and `P_m1`.
    NoMotion {
        /// Its largest absolute value, mm.
        largest_mm: f32,
    },
    /// No observation depends on a parameter.
    Unobserved {
        /// The parameter.
        parameter: Parameter,
    },
    /// Parameters change the observations in the same way.
    Inseparable {
        /// First of them.
        first: Parameter,
        /// Second of them.
        second: Parameter,
        /// A third, if only the three together do.
        third: Option<Parameter>,
    },
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { points, needed } => {
                write!(f, "{points} points where at least {needed} are needed")
            }
            Self::OnALine { spread_mm } => write!(
                f,
                "all points are on one line, or at one place: their distances from it are {spread_mm} mm (rms)"
            ),
            Self::NoMotion { largest_mm } => write!(
                f,
                "K_d1 and P_m1 do not exist: what they are regressed on is at most {largest_mm} mm in \
                 every exposure (with a centred run-up the centroid offset is zero)"
            ),
            Self::Unobserved { parameter } => {
                write!(f, "no observation depends on {parameter}")
            }
            Self::Inseparable {
                first,
                second,
                third: None,
            } => write!(
                f,
                "{first} and {second} cannot be separated by these observations"
            ),
            Self::Inseparable {
                first,
                second,
                third: Some(third),
            } => write!(
                f,
                "{first} and {second} cannot be separated from {third} by these observations"
            ),
        }
    }
}

impl core::error::Error for FitError {}
