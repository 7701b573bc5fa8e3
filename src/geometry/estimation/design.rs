//! The unknowns of one adjustment, picked from the factor of all parameters.

use super::fit::FitError;
use super::number::Number;
use super::parameter::{PARAMETERS, Parameter};
use super::separability::Separability;
use super::triangle::Triangle;

/// Smallest separation of parameters. Parameters are inseparable where a combination of them (of
/// unit length) changes the observations by less than this fraction of the change that each causes
/// alone. Rounding in single precision is less than a tenth of it.
pub const MIN_SEPARATION: f32 = 1e-3;

/// Columns of a factor: parameters and right-hand side.
pub(super) const COLUMNS: usize = PARAMETERS + 1;

/// The factor of the unknowns that are estimated, right-hand side after them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Design<T: Number> {
    pub(super) factor: Triangle<T, COLUMNS>,
    /// u, which is also the column of the right-hand side.
    pub(super) size: usize,
    pub(super) tied: bool,
}

/// Returns the parameters that a column of a design stands for, the main one first.
const fn parameters_of(column: usize, tied: bool) -> [Option<Parameter>; 2] {
    match (column, tied) {
        (0, _) => [Some(Parameter::Km0), None],
        (1, _) => [Some(Parameter::Km1), None],
        (2, _) => [Some(Parameter::Km2), None],
        (3, false) => [Some(Parameter::Kd1), None],
        (3, true) => [Some(Parameter::Pm1), Some(Parameter::Kd1)],
        (4, false) => [Some(Parameter::Pm1), None],
        (4, true) | (5, false) => [Some(Parameter::Decentring), None],
        _ => [None, None],
    }
}

/// Returns true if a column of a design stands for a parameter.
pub(super) fn stands_for(column: usize, tied: bool, parameter: Parameter) -> bool {
    parameters_of(column, tied).contains(&Some(parameter))
}

impl<T: Number> Design<T> {
    /// Picks columns of the factor of all parameters, adds two where they are tied, and makes it a
    /// triangle again.
    pub(super) fn of(all: &Triangle<T, COLUMNS>, tied: bool, with_decentring: bool) -> Self {
        let five = if tied { 4 } else { 5 };
        let size = if with_decentring { five + 1 } else { five };
        let mut factor = Triangle::empty();
        for row in 0..COLUMNS {
            let mut picked = [T::ZERO; COLUMNS];
            for (column, element) in picked.iter_mut().enumerate() {
                if column < size {
                    for parameter in parameters_of(column, tied).into_iter().flatten() {
                        let term = all.at(row, parameter.index());
                        *element = match parameter {
                            Parameter::Kd1 if tied => *element + T::of(2.0) * term,
                            _ => *element + term,
                        };
                    }
                } else if column == size {
                    *element = all.at(row, PARAMETERS);
                }
            }
            factor.absorb(picked);
        }
        Self { factor, size, tied }
    }

    pub(super) fn unknowns(&self) -> u32 {
        // At most six.
        u32::try_from(self.size).unwrap_or(0)
    }

    pub(super) fn condition(&self) -> T {
        let separability = Separability::of(&self.factor, self.size);
        separability.most / separability.least
    }

    /// Checks that the columns can be told apart.
    pub(super) fn check(&self) -> Result<(), FitError> {
        let separability = Separability::of(&self.factor, self.size);
        let name = |column| {
            let [main, _] = parameters_of(column, self.tied);
            main.unwrap_or(Parameter::Km0)
        };
        if let Some(column) = separability.empty {
            return Err(FitError::Unobserved {
                parameter: name(column),
            });
        }
        if separability.least >= T::of(MIN_SEPARATION) {
            return Ok(());
        }
        // The error names the two parameters with the largest share, and a third whose share is of
        // their order.
        let mut shares = separability.direction.map(Number::abs);
        let mut take_largest = || {
            let mut largest = (0, T::ZERO);
            for (column, share) in shares.iter().enumerate() {
                if *share > largest.1 {
                    largest = (column, *share);
                }
            }
            if let Some(share) = shares.get_mut(largest.0) {
                *share = T::ZERO;
            }
            largest
        };
        let (a, most) = take_largest();
        let (b, _) = take_largest();
        let (c, least) = take_largest();
        let third = (least > T::of(0.3) * most).then_some(c);
        let (first, second, third) = match third {
            None => (a.min(b), a.max(b), None),
            Some(c) => {
                let last = a.max(b).max(c);
                let first = a.min(b).min(c);
                (first, a + b + c - first - last, Some(last))
            }
        };
        Err(FitError::Inseparable {
            first: name(first),
            second: name(second),
            third: third.map(name),
        })
    }
}
