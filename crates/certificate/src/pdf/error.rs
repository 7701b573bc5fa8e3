//! Errors of the PDF.

use fmc_report::figure::FigureError;
use krilla::configure::ConfigurationError;

/// A reason why the PDF cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PdfError {
    /// A font is damaged.
    #[error("a font of the certificate is damaged")]
    Font,
    /// A character has no glyph.
    #[error("the font of the certificate has no glyph for {0:?}")]
    NoGlyph(char),
    /// A table does not fit the page.
    #[error("the table {0:?} is wider than a page")]
    TooWide(String),
    /// Too many pages.
    #[error("the certificate has {0} pages, and at most 8 are allowed: shorten the details")]
    TooLong(usize),
    /// A figure failed.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The standard for archives and the version of PDF do not go together.
    #[error("{0:?}")]
    Configuration(ConfigurationError),
    /// The writer of the PDF failed.
    #[error("the PDF cannot be written: {0}")]
    Writer(String),
}
