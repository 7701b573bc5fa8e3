//! Errors of inputs.

use std::io;
use std::ops::Range;
use std::path::Path;

/// An input that cannot be used: the fault, its place, and a remedy.
///
/// It is shown as one line that names the file and, as far as they are known, line, field, value
/// and allowed range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", .0.text)]
pub struct InputError(Box<Parts>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct Parts {
    kind: InputErrorKind,
    text: String,
    help: Option<String>,
    place: Option<Place>,
}

/// Party that can correct the error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputErrorKind {
    /// The person who wrote or named the input.
    Invalid,
    /// The system: a storage device or a connection failed during reading.
    Unreadable,
}

/// A place in a text file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Name that messages use for the file.
    pub file: String,
    /// Text of the file.
    pub text: String,
    /// Range of bytes of `text` that are wrong.
    pub span: Range<usize>,
}

impl InputError {
    /// Creates the error of an input with wrong content; `text` names the file and the fault.
    #[must_use]
    pub fn invalid(text: impl Into<String>) -> Self {
        Self::new(InputErrorKind::Invalid, text)
    }

    /// Creates the error of an input file that cannot be read: the user can correct a wrong name,
    /// but not a failing disk.
    #[must_use]
    pub fn reading(path: &Path, error: &io::Error) -> Self {
        let kind = match error.kind() {
            io::ErrorKind::NotFound
            | io::ErrorKind::PermissionDenied
            | io::ErrorKind::IsADirectory
            | io::ErrorKind::NotADirectory
            | io::ErrorKind::InvalidInput
            | io::ErrorKind::InvalidFilename => InputErrorKind::Invalid,
            _ => InputErrorKind::Unreadable,
        };
        Self::new(kind, format!("{}: cannot be read: {error}", path.display()))
    }

    fn new(kind: InputErrorKind, text: impl Into<String>) -> Self {
        Self(Box::new(Parts {
            kind,
            text: text.into(),
            help: None,
            place: None,
        }))
    }

    /// Adds a remedy.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.0.help = Some(help.into());
        self
    }

    /// Adds the place in a text file.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.0.place = Some(place);
        self
    }

    /// Returns the party that can correct the error.
    #[must_use]
    pub fn kind(&self) -> InputErrorKind {
        self.0.kind
    }

    /// Returns the remedy, if one is known.
    #[must_use]
    pub fn help(&self) -> Option<&str> {
        self.0.help.as_deref()
    }

    /// Returns the place in a text file, unless the whole file is meant.
    #[must_use]
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_name_is_the_users_and_a_failing_disk_is_not() {
        for (error, kind) in [
            (io::ErrorKind::NotFound, InputErrorKind::Invalid),
            (io::ErrorKind::IsADirectory, InputErrorKind::Invalid),
            (io::ErrorKind::TimedOut, InputErrorKind::Unreadable),
            (io::ErrorKind::Other, InputErrorKind::Unreadable),
        ] {
            let error = InputError::reading(Path::new("camera.toml"), &error.into());
            assert_eq!(error.kind(), kind, "{error}");
            assert!(
                error
                    .to_string()
                    .starts_with("camera.toml: cannot be read: ")
            );
        }
    }
}
