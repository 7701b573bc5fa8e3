//! Allowed ranges of the numbers of scenarios, and the ranges that scenarios share.

use std::fmt;

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;

/// Smallest and largest value of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) unit: &'static str,
}

/// Flying height above the ground frame's zero.
pub(crate) const FLYING_HEIGHT: Range = range(50.0, 15_000.0, "m");
/// Ground speed.
pub(crate) const SPEED: Range = range(10.0, 350.0, "m/s");
/// Exposure time, first light to last.
pub(crate) const EXPOSURE: Range = range(1e-6, 0.1, "s");
/// Height of the mean terrain.
pub(crate) const TERRAIN_HEIGHT: Range = range(-500.0, 9000.0, "m");
/// Amplitude of the terrain's relief.
pub(crate) const RELIEF: Range = range(0.0, 4000.0, "m");
/// Wavelength of the terrain's relief.
pub(crate) const WAVELENGTH: Range = range(10.0, 1e5, "m");

/// Creates a range with its unit.
pub(crate) const fn range(least: f64, most: f64, unit: &'static str) -> Range {
    Range { least, most, unit }
}

impl Range {
    /// Returns true if a value lies inside, ends included.
    pub(crate) fn holds(&self, value: f64) -> bool {
        self.least <= value && value <= self.most
    }

    /// Refuses a value outside of the range.
    pub(crate) fn check(
        &self,
        value: f64,
        text: &TomlText,
        path: &[&str],
    ) -> Result<(), InputError> {
        if self.holds(value) {
            return Ok(());
        }
        let hint = if self.unit == "m" && value.is_finite() {
            if self.holds(value / 1000.0) && value.abs() > self.most {
                "; in millimetres?"
            } else if value > 0.0 && value < self.least && self.holds(1000.0 * value) {
                "; in kilometres?"
            } else {
                ""
            }
        } else {
            ""
        };
        Err(text.invalid(path, &format!("is out of range: allowed {self}{hint}")))
    }

    /// Refuses a list with a value outside of the range.
    pub(crate) fn check_each(
        &self,
        values: &[f64],
        text: &TomlText,
        path: &[&str],
    ) -> Result<(), InputError> {
        match values.iter().find(|value| !self.holds(**value)) {
            None => Ok(()),
            Some(value) => Err(text.invalid(
                path,
                &format!("holds {value}, which is out of range: allowed {self}"),
            )),
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {} {}", self.least, self.most, self.unit)
    }
}

/// A value of the scenario that has an allowed range.
pub(crate) trait Ranged {
    fn check(&self, range: Range, text: &TomlText, path: &[&str]) -> Result<(), InputError>;
}

impl Ranged for f64 {
    fn check(&self, range: Range, text: &TomlText, path: &[&str]) -> Result<(), InputError> {
        range.check(*self, text, path)
    }
}

impl Ranged for i64 {
    fn check(&self, range: Range, text: &TomlText, path: &[&str]) -> Result<(), InputError> {
        range.check(whole(*self), text, path)
    }
}

impl<const COUNT: usize> Ranged for [f64; COUNT] {
    fn check(&self, range: Range, text: &TomlText, path: &[&str]) -> Result<(), InputError> {
        range.check_each(self, text, path)
    }
}

impl<T: Ranged> Ranged for Option<T> {
    fn check(&self, range: Range, text: &TomlText, path: &[&str]) -> Result<(), InputError> {
        self.as_ref()
            .map_or(Ok(()), |value| value.check(range, text, path))
    }
}

/// Checks `table.key`, where the Rust names are those of the file.
macro_rules! check {
    ($text:ident: $($table:ident.$key:ident $range:ident),+ $(,)?) => {
        $($table.$key.check($range, $text, &[stringify!($table), stringify!($key)])?;)+
    };
}

pub(crate) use check;

/// Refuses terrain that reaches the aircraft.
pub(crate) fn check_clearance(
    text: &TomlText,
    flying_height_m: f64,
    terrain_m: f64,
    relief_m: f64,
) -> Result<(), InputError> {
    if flying_height_m <= terrain_m + relief_m {
        return Err(text.invalid(
            &["terrain", "height_m"],
            &format!("with relief_m = {relief_m} reaches the aircraft at {flying_height_m} m"),
        ));
    }
    Ok(())
}

/// Converts a count into a number.
pub(crate) fn whole(count: i64) -> f64 {
    i32::try_from(count).map_or(f64::INFINITY, f64::from)
}
