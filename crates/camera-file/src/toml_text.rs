//! TOML text whose errors are named with their place.

use std::ops::Range;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::input_error::{InputError, Place};
use crate::number::clipped;

/// Length in bytes above which a message does not show a line.
const LONGEST_LINE: usize = 400;

/// Text of a TOML file, and the name that messages use for the file.
#[derive(Debug, Clone, Copy)]
pub struct TomlText<'a> {
    file: &'a str,
    text: &'a str,
}

impl<'a> TomlText<'a> {
    /// Creates the text without its byte-order mark; `file` is the name that messages use.
    #[must_use]
    pub fn new(file: &'a str, text: &'a str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        Self { file, text }
    }

    /// Parses the text. Unknown and missing keys, wrong types and syntax errors are named with
    /// their place.
    ///
    /// # Errors
    /// [`InputError`] that names file, line and key.
    pub fn deserialize<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        toml::from_str(self.text).map_err(|error| {
            let span = error.span();
            let key = span.as_ref().and_then(|span| self.key_around(span));
            let message = match key {
                Some(key) => format!("{key}: {}", error.message()),
                None => error.message().to_owned(),
            };
            self.error(span, &message)
        })
    }

    /// Creates the error of a wrong value: `fault` continues after "key = value ". In `path`, a
    /// number is an index into an array.
    #[must_use]
    pub fn invalid(&self, path: &[&str], fault: &str) -> InputError {
        let span = self.value_span(path);
        let key = path.join(".");
        let value = span
            .as_ref()
            .and_then(|span| self.text.get(span.clone()))
            .map_or_else(String::new, |value| format!(" = {}", clipped(value)));
        self.error(span, &format!("{key}{value} {fault}"))
    }

    /// Returns true if the text has a value at a path.
    #[must_use]
    pub fn has(&self, path: &[&str]) -> bool {
        self.value_span(path).is_some()
    }

    /// Creates the error of a table whose values are not valid together.
    #[must_use]
    pub fn invalid_table(&self, table: &str, fault: &str) -> InputError {
        let span = self.value_span(&[table]);
        self.error(span, &format!("[{table}]: {fault}"))
    }

    fn error(&self, span: Option<Range<usize>>, message: &str) -> InputError {
        let Some(span) = span else {
            return InputError::invalid(format!("{}: {message}", self.file));
        };
        let line = 1 + self
            .text
            .bytes()
            .take(span.start)
            .filter(|byte| *byte == b'\n')
            .count();
        let error = InputError::invalid(format!("{}, line {line}: {message}", self.file));
        // A file with such a long line was not written by hand, and its lines are not shown.
        let longest = self.text.lines().map(str::len).max().unwrap_or(0);
        if longest > LONGEST_LINE {
            error
        } else {
            error.at(Place {
                file: self.file.to_owned(),
                text: self.text.to_owned(),
                span,
            })
        }
    }

    fn value_span(&self, path: &[&str]) -> Option<Range<usize>> {
        let table = DeTable::parse(self.text).ok()?;
        let (first, rest) = path.split_first()?;
        let mut value = table.get_ref().get(*first)?;
        for key in rest {
            // A number is an index into an array.
            value = match key.parse::<usize>() {
                Ok(index) => value.get_ref().get(index)?,
                Err(_) => value.get_ref().get(*key)?,
            };
        }
        Some(value.span())
    }

    /// Returns the dotted name of the innermost value that contains the span.
    fn key_around(&self, span: &Range<usize>) -> Option<String> {
        let table = DeTable::parse(self.text).ok()?;
        key_in(table.get_ref(), span)
    }
}

fn key_in(table: &DeTable<'_>, span: &Range<usize>) -> Option<String> {
    for (key, value) in table {
        let name = key.get_ref().as_ref();
        if let DeValue::Table(inner) = value.get_ref()
            && let Some(inner) = key_in(inner, span)
        {
            return Some(format!("{name}.{inner}"));
        }
        let around = value.span();
        if !matches!(value.get_ref(), DeValue::Table(_))
            && around.start <= span.start
            && span.end <= around.end
        {
            return Some(name.to_owned());
        }
    }
    None
}
