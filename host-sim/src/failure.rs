//! How a command ends when it does not succeed.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use fmc_camera_file::{InputError, InputErrorKind};
use fmc_simulation::strip_experiment::experiment::ExperimentError;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceSpan};

/// Why a command ended, as its exit code says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Exit {
    /// The check that was asked for failed.
    CheckFailed = 1,
    /// An input is wrong.
    BadInput = 2,
    /// A device or the file system failed.
    DeviceOrIo = 3,
}

/// A command that did not succeed: its exit code and what the user reads.
#[derive(Debug)]
pub struct Failure {
    exit: Exit,
    message: Box<Message>,
}

/// What the user reads, with the place in the file where there is one.
#[derive(Debug, thiserror::Error)]
#[error("{text}")]
struct Message {
    text: String,
    help: Option<String>,
    place: Option<(NamedSource<String>, SourceSpan)>,
}

impl Diagnostic for Message {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        self.help
            .as_ref()
            .map(|help| Box::new(help) as Box<dyn std::fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.place
            .as_ref()
            .map(|(source, _)| source as &dyn miette::SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (_, span) = self.place.as_ref()?;
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(
            Some("here".to_owned()),
            *span,
        ))))
    }
}

impl Failure {
    /// An input is wrong.
    #[must_use]
    pub fn bad_input(text: impl Into<String>) -> Self {
        Self::new(Exit::BadInput, text)
    }

    /// A device or the file system failed.
    #[must_use]
    pub fn device_or_io(text: impl Into<String>) -> Self {
        Self::new(Exit::DeviceOrIo, text)
    }

    /// The check that was asked for failed.
    #[must_use]
    pub fn check(text: impl Into<String>) -> Self {
        Self::new(Exit::CheckFailed, text)
    }

    fn new(exit: Exit, text: impl Into<String>) -> Self {
        Self {
            exit,
            message: Box::new(Message {
                text: text.into(),
                help: None,
                place: None,
            }),
        }
    }

    /// An input file cannot be read: a wrong name is bad input, a failing disk is not.
    #[must_use]
    pub fn reading(path: &Path, error: &io::Error) -> Self {
        InputError::reading(path, error).into()
    }

    /// An output cannot be written.
    #[must_use]
    pub fn writing(what: impl std::fmt::Display, error: &io::Error) -> Self {
        Self::device_or_io(format!("{what}: cannot be written: {error}"))
    }

    /// Adds what the user can do about it.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.message.help = Some(help.into());
        self
    }

    /// Tells the user and gives the exit code of the process.
    #[must_use]
    pub fn report(self) -> ExitCode {
        let code = ExitCode::from(self.exit as u8);
        let report = miette::Report::new(*self.message);
        // Nothing is left to do when even the error stream is closed.
        let _ = writeln!(io::stderr(), "{report:?}");
        code
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        let exit = match error.kind() {
            InputErrorKind::Invalid => Exit::BadInput,
            InputErrorKind::Unreadable => Exit::DeviceOrIo,
        };
        let place = error.place().map(|place| {
            let source = NamedSource::new(&place.file, place.text.clone()).with_language("toml");
            (source, place.span.clone().into())
        });
        Self {
            exit,
            message: Box::new(Message {
                text: error.to_string(),
                help: error.help().map(str::to_owned),
                place,
            }),
        }
    }
}

impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Scenario(error) => error.into(),
            ExperimentError::NotConverged(_) => Self::check(error.to_string()),
        }
    }
}

/// Messages are not broken at the width of a terminal: a log file is searched line by line.
pub fn print_plainly() {
    // The hook can be set once; a second call changes nothing.
    let _ = miette::set_hook(Box::new(|_| {
        Box::new(miette::MietteHandlerOpts::new().wrap_lines(false).build())
    }));
}
