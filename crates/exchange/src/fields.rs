//! Fields of a tree of JSON or YAML, with messages that name them.

use fmc_camera_file::InputError;
use serde_json::Value;

use crate::source::Source;

/// A value of a tree, with its place.
#[derive(Debug, Clone)]
pub(crate) struct Field<'a> {
    source: Source<'a>,
    path: String,
    value: &'a Value,
}

impl<'a> Field<'a> {
    pub(crate) fn root(source: Source<'a>, value: &'a Value) -> Self {
        Self {
            source,
            path: String::new(),
            value,
        }
    }

    pub(crate) fn value(&self) -> &'a Value {
        self.value
    }

    fn below(&self, name: &str, value: &'a Value) -> Self {
        let path = if self.path.is_empty() {
            name.to_owned()
        } else {
            format!("{}.{name}", self.path)
        };
        Self {
            path,
            value,
            ..self.clone()
        }
    }

    /// Creates the error of this value.
    pub(crate) fn invalid(&self, fault: impl std::fmt::Display) -> InputError {
        if self.path.is_empty() {
            self.source.invalid(fault)
        } else {
            self.source.invalid(format!("{}: {fault}", self.path))
        }
    }

    /// Returns the field of a name, if there is one.
    pub(crate) fn find(&self, name: &str) -> Option<Self> {
        let value = self.value.get(name).filter(|value| !value.is_null())?;
        Some(self.below(name, value))
    }

    /// Returns the field of a name.
    pub(crate) fn get(&self, name: &str) -> Result<Self, InputError> {
        self.find(name)
            .ok_or_else(|| self.invalid(format!("{name} is missing")))
    }

    /// Returns the elements of a list.
    pub(crate) fn elements(&self) -> Result<Vec<Self>, InputError> {
        let list = self
            .value
            .as_array()
            .ok_or_else(|| self.invalid("not a list"))?;
        let element = |(index, value): (usize, &'a Value)| self.below(&index.to_string(), value);
        Ok(list.iter().enumerate().map(element).collect())
    }

    /// Returns the members of a table.
    pub(crate) fn members(&self) -> Result<Vec<(String, Self)>, InputError> {
        let table = self
            .value
            .as_object()
            .ok_or_else(|| self.invalid("not a table"))?;
        Ok(table
            .iter()
            .map(|(name, value)| (name.clone(), self.below(name, value)))
            .collect())
    }

    /// Returns a finite number.
    pub(crate) fn number(&self) -> Result<f64, InputError> {
        match self.value.as_f64() {
            Some(number) if number.is_finite() => Ok(number),
            _ => Err(self.invalid(format!(
                "{} is not a finite number",
                fmc_camera_file::number::clipped(&self.value.to_string())
            ))),
        }
    }

    /// Returns the number of a name.
    pub(crate) fn number_of(&self, name: &str) -> Result<f64, InputError> {
        self.get(name)?.number()
    }

    /// Returns the number of a name, 0 where there is none.
    pub(crate) fn number_or_zero(&self, name: &str) -> Result<f64, InputError> {
        self.find(name).map_or(Ok(0.0), |field| field.number())
    }

    /// Returns the numbers of a list.
    pub(crate) fn numbers(&self) -> Result<Vec<f64>, InputError> {
        self.elements()?.iter().map(Self::number).collect()
    }

    /// Returns exactly `N` numbers.
    pub(crate) fn exactly<const N: usize>(&self) -> Result<[f64; N], InputError> {
        let numbers = self.numbers()?;
        let count = numbers.len();
        numbers
            .try_into()
            .map_err(|_| self.invalid(format!("{count} numbers where {N} are expected")))
    }

    /// Returns a number of pixels.
    pub(crate) fn count(&self) -> Result<u32, InputError> {
        let whole = self.number()?;
        pixel_count(whole).ok_or_else(|| self.invalid(format!("{whole} is not a number of pixels")))
    }

    /// Returns a word.
    pub(crate) fn word(&self) -> Result<&'a str, InputError> {
        self.value
            .as_str()
            .ok_or_else(|| self.invalid("not a word"))
    }
}

/// Returns a whole number of pixels that a sensor can have.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the range is checked before"
)]
pub(crate) fn pixel_count(number: f64) -> Option<u32> {
    let is_whole = (number - number.round()).abs() < 1e-9;
    (is_whole && (1.0..=1e6).contains(&number)).then(|| number.round() as u32)
}
