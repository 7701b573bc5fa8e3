//! An argument of a format string as text.

use std::fmt::{Display, Write as _};

use defmt_parser::{DisplayHint, TimePrecision};

/// Largest width of a number, digits: a hint that asks for more is damaged.
const WIDEST: usize = 128;

/// An argument of a format string.
pub(super) enum Argument<'a> {
    Unsigned(u128),
    /// The number and its width in bits.
    Signed(i128, u32),
    Single(f32),
    Double(f64),
    Truth(bool),
    Character(char),
    Text(&'a str),
    /// A structure or a variant of an enum, its fields shown already.
    Value(String),
}

impl Argument<'_> {
    /// Appends the argument in the form of its hint; `None` for what is not shown here.
    pub(super) fn show(&self, hint: Option<&DisplayHint>, text: &mut String) -> Option<()> {
        if let Some(
            DisplayHint::NoHint { zero_pad }
            | DisplayHint::Binary { zero_pad, .. }
            | DisplayHint::Octal { zero_pad, .. }
            | DisplayHint::Hexadecimal { zero_pad, .. },
        ) = hint
            && *zero_pad > WIDEST
        {
            return None;
        }
        match self {
            Self::Unsigned(number) => unsigned(*number, hint, text),
            Self::Signed(number, bits) => signed(*number, *bits, hint, text),
            Self::Single(number) => write!(text, "{number:?}").ok(),
            Self::Double(number) => write!(text, "{number:?}").ok(),
            Self::Truth(truth) => write!(text, "{truth}").ok(),
            Self::Character(character) => write!(text, "{character}").ok(),
            Self::Text(line) => match hint {
                Some(DisplayHint::Debug) => write!(text, "{line:?}").ok(),
                _ => write!(text, "{line}").ok(),
            },
            Self::Value(value) => write!(text, "{value}").ok(),
        }
    }
}

fn unsigned(number: u128, hint: Option<&DisplayHint>, text: &mut String) -> Option<()> {
    match hint {
        Some(DisplayHint::Seconds(precision)) => {
            let (digits, per_second) = match precision {
                TimePrecision::Micros => (6, 1_000_000),
                TimePrecision::Millis => (3, 1000),
                TimePrecision::Seconds => return None,
            };
            let [seconds, part] = [number / per_second, number % per_second];
            write!(text, "{seconds}.{part:0digits$}").ok()
        }
        _ => radix(number, hint, text).or_else(|| decimal(number, hint, text)),
    }
}

fn signed(number: i128, bits: u32, hint: Option<&DisplayHint>, text: &mut String) -> Option<()> {
    // The two's complement in the number's own width.
    let own = number.cast_unsigned() & (u128::MAX >> (128 - bits));
    radix(own, hint, text).or_else(|| decimal(number, hint, text))
}

/// Appends a number in base 10, also where the hint does not apply to numbers.
fn decimal(number: impl Display, hint: Option<&DisplayHint>, text: &mut String) -> Option<()> {
    match hint {
        Some(
            DisplayHint::Bitflags { .. }
            | DisplayHint::Cbor
            | DisplayHint::ISO8601(_)
            | DisplayHint::Time(_),
        ) => None,
        Some(DisplayHint::NoHint { zero_pad }) => write!(text, "{number:0zero_pad$}").ok(),
        _ => write!(text, "{number}").ok(),
    }
}

/// Appends a number in base 2, 8 or 16, where the hint asks for it.
fn radix(number: u128, hint: Option<&DisplayHint>, text: &mut String) -> Option<()> {
    let (alternate, width) = match hint? {
        DisplayHint::Binary {
            alternate,
            zero_pad,
        }
        | DisplayHint::Octal {
            alternate,
            zero_pad,
        }
        | DisplayHint::Hexadecimal {
            alternate,
            zero_pad,
            ..
        } => (*alternate, *zero_pad),
        _ => return None,
    };
    let written = match (hint?, alternate) {
        (DisplayHint::Binary { .. }, false) => write!(text, "{number:0width$b}"),
        (DisplayHint::Binary { .. }, true) => write!(text, "{number:#0width$b}"),
        (DisplayHint::Octal { .. }, false) => write!(text, "{number:0width$o}"),
        (DisplayHint::Octal { .. }, true) => write!(text, "{number:#0width$o}"),
        (
            DisplayHint::Hexadecimal {
                uppercase: true, ..
            },
            false,
        ) => {
            write!(text, "{number:0width$X}")
        }
        (
            DisplayHint::Hexadecimal {
                uppercase: true, ..
            },
            true,
        ) => {
            write!(text, "{number:#0width$X}")
        }
        (_, false) => write!(text, "{number:0width$x}"),
        (_, true) => write!(text, "{number:#0width$x}"),
    };
    written.ok()
}
