//! Failures of commands, with their exit codes.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use fmc_camera_file::{InputError, InputErrorKind};
use fmc_simulation::strip_experiment::experiment::ExperimentError;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceSpan};

/// Exit code of a command that failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Exit {
    /// The check that was asked for failed.
    CheckFailed = 1,
    /// An input is wrong.
    BadInput = 2,
    /// A device or the file system failed.
    DeviceOrIo = 3,
}

/// A command that did not succeed: its exit code and the text for the user.
#[derive(Debug)]
pub struct Failure {
    exit: Exit,
    message: Box<Message>,
}

/// Text for the user, with the place in the file where there is one.
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
    /// Returns the failure of a wrong input.
    #[must_use]
    pub fn bad_input(text: impl Into<String>) -> Self {
        Self::new(Exit::BadInput, text)
    }

    /// Returns the failure of a device or the file system.
    #[must_use]
    pub fn device_or_io(text: impl Into<String>) -> Self {
        Self::new(Exit::DeviceOrIo, text)
    }

    /// Returns the failure of a check that was asked for.
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

    /// Returns the failure to read an input file: a wrong name is bad input, a failing disk is not.
    #[must_use]
    pub fn reading(path: &Path, error: &io::Error) -> Self {
        InputError::reading(path, error).into()
    }

    /// Returns the failure to write an output.
    #[must_use]
    pub fn writing(what: impl std::fmt::Display, error: &io::Error) -> Self {
        Self::device_or_io(format!("{what}: cannot be written: {error}"))
    }

    /// Adds advice for the user.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.message.help = Some(help.into());
        self
    }

    /// Exit code of the process.
    #[must_use]
    pub const fn code(&self) -> u8 {
        self.exit as u8
    }

    /// The fault in one line.
    #[must_use]
    pub fn text(&self) -> String {
        self.message.text.clone()
    }

    /// Prints the failure and returns the exit code of the process.
    #[must_use]
    pub fn report(self) -> ExitCode {
        let code = ExitCode::from(self.code());
        let report = miette::Report::new(*self.message);
        note(format_args!("{report:?}"));
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

/// Writes a line to the error stream. A line that cannot be written, to a full disk or a closed
/// pipe, is lost without an error: the exit code still tells the outcome.
pub fn note(line: impl std::fmt::Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Prints messages without breaking lines at the width of a terminal, because log files are
/// searched line by line.
pub fn print_plainly() {
    // The hook can be set once; a second call changes nothing.
    let _ = miette::set_hook(Box::new(|_| {
        Box::new(miette::MietteHandlerOpts::new().wrap_lines(false).build())
    }));
}
