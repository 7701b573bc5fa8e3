//! Errors of what is read.

use std::io;
use std::ops::Range;
use std::path::Path;

/// An input that cannot be used: what is wrong, where, and what helps.
///
/// It is shown as one line that names the file and, where they are known, line, field, value and
/// allowed range.
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

/// Who can mend it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputErrorKind {
    /// Whoever wrote or named the input.
    Invalid,
    /// The system: a storage or a connection failed while it was read.
    Unreadable,
}

/// A place in a text file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// What messages call the file.
    pub file: String,
    /// All of its text.
    pub text: String,
    /// The bytes of `text` that are wrong.
    pub span: Range<usize>,
}

impl InputError {
    /// An input with wrong content; `text` says in which file, and what is wrong there.
    #[must_use]
    pub fn invalid(text: impl Into<String>) -> Self {
        Self::new(InputErrorKind::Invalid, text)
    }

    /// An input file cannot be read: a wrong name is the user's to mend, a failing disk is not.
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

    /// Adds what the user can do about it.
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

    /// Who can mend it.
    #[must_use]
    pub fn kind(&self) -> InputErrorKind {
        self.0.kind
    }

    /// What the user can do about it, where that is known.
    #[must_use]
    pub fn help(&self) -> Option<&str> {
        self.0.help.as_deref()
    }

    /// Where it is, unless the whole file is meant.
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
