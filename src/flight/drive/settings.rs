//! A setting of a drive that is out of its range.

use core::fmt;

use crate::geometry::range::OutOfRange;

/// A setting is not a number, or lies outside its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingOutOfRange {
    /// The field.
    pub setting: &'static str,
    /// What it was, in the unit of its name.
    pub value: f32,
    /// Smallest allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
}

impl fmt::Display for SettingOutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            setting,
            value,
            min,
            max,
        } = self;
        write!(f, "{setting} = {value} is outside {min} to {max}")
    }
}

impl core::error::Error for SettingOutOfRange {}

impl From<OutOfRange> for SettingOutOfRange {
    fn from(error: OutOfRange) -> Self {
        Self {
            setting: error.quantity.name(),
            value: error.value,
            min: error.min,
            max: error.max,
        }
    }
}

/// A value, if it is a number in `[min, max]`.
pub(in crate::flight) const fn within(
    setting: &'static str,
    value: f32,
    min: f32,
    max: f32,
) -> Result<f32, SettingOutOfRange> {
    if value >= min && value <= max {
        Ok(value)
    } else {
        Err(SettingOutOfRange {
            setting,
            value,
            min,
            max,
        })
    }
}
