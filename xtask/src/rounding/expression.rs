//! Expressions of single precision, as Gappa reads them.

/// Expression of names and constants.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Expression {
    /// Number or result of a definition.
    Name(String),
    /// Constant as the source writes it.
    Constant(String),
    Negative(Box<Self>),
    Root(Box<Self>),
    /// `+`, `-`, `*` or `/` between two.
    Operation(char, Box<Self>, Box<Self>),
}

/// Arithmetic of a line of a script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arithmetic {
    /// Every operation is rounded, and constants are single-precision numbers.
    Rounded,
    /// Nothing is rounded.
    Exact,
}

impl Arithmetic {
    /// Returns the name of a result.
    pub(super) fn name(self, name: &str) -> String {
        match self {
            Self::Rounded => name.to_owned(),
            Self::Exact => format!("exact_{name}"),
        }
    }
}

impl Expression {
    /// Returns the expression in Gappa's language.
    pub(super) fn text(&self, arithmetic: Arithmetic) -> String {
        let inner = |expression: &Self| expression.text(arithmetic);
        match self {
            Self::Name(name) => arithmetic.name(name),
            Self::Constant(decimal) => match (arithmetic, decimal.parse()) {
                (Arithmetic::Rounded, Ok(number)) => binary(number),
                _ => decimal.clone(),
            },
            Self::Negative(of) => format!("-({})", inner(of)),
            Self::Root(of) => format!("sqrt({})", inner(of)),
            Self::Operation(sign, left, right) => {
                format!("({} {sign} {})", inner(left), inner(right))
            }
        }
    }

    /// Gives names others.
    pub(super) fn rename(&mut self, other: &impl Fn(&str) -> Option<String>) {
        match self {
            Self::Name(name) => {
                if let Some(other) = other(name) {
                    *name = other;
                }
            }
            Self::Constant(_) => {}
            Self::Negative(of) | Self::Root(of) => of.rename(other),
            Self::Operation(_, left, right) => {
                left.rename(other);
                right.rename(other);
            }
        }
    }

    /// Returns true if it is a name or a constant, with which nothing is computed.
    pub(super) fn is_plain(&self) -> bool {
        matches!(self, Self::Name(_) | Self::Constant(_))
    }
}

/// Returns a number exactly, as Gappa writes it: a whole number times a power of two.
pub(super) fn binary(number: f32) -> String {
    let bits = number.to_bits();
    let fraction = bits & ((1 << 23) - 1);
    let (significand, exponent) = match bits >> 23 & 0xff {
        0 => (fraction, -149),
        exponent => (fraction | 1 << 23, exponent.cast_signed() - 150),
    };
    let sign = if number.is_sign_negative() { "-" } else { "" };
    format!("{sign}{significand}b{exponent}")
}

#[cfg(test)]
mod tests {
    use super::binary;

    #[test]
    fn numbers_are_written_exactly() {
        assert_eq!(binary(1.0), "8388608b-23");
        assert_eq!(binary(-0.75), "-12582912b-24");
        assert_eq!(binary(f32::from_bits(1)), "1b-149");
        assert_eq!(binary(0.0), "0b-149");
    }
}
