//! The pages of a certificate before they are set: sections of text, tables and figures.

mod sections;

use crate::content::Certificate;
use crate::figure::Drawing;

/// Word for what is not known.
pub const NOT_STATED: &str = "not stated";

/// The pages, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// Title.
    pub title: String,
    /// Lines under the title.
    pub subtitle: String,
    /// Line at the foot of every page.
    pub foot: String,
    /// Sections.
    pub sections: Vec<Section>,
}

/// A section.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// Blocks from top to bottom.
    pub blocks: Vec<Block>,
}

/// A part of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Names with what they stand for, a line each.
    Pairs(Vec<[String; 2]>),
    /// A table.
    Table(Table),
    /// Figures side by side.
    Figures(Vec<Figure>),
    /// A place to sign for each of these names and roles.
    Signatures(Vec<[String; 2]>),
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Line above the table.
    pub title: String,
    /// Columns.
    pub columns: Vec<Column>,
    /// Rows of as many cells as there are columns.
    pub rows: Vec<Vec<String>>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Heading, in one or more lines.
    pub heading: String,
    /// `true` for words, which stand on the left and may be broken; numbers stand on the right.
    pub is_words: bool,
}

/// A figure with its caption.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Drawing.
    pub drawing: Drawing,
    /// Caption.
    pub caption: String,
}

/// Returns a column of words.
fn words(heading: &str) -> Column {
    Column {
        heading: heading.to_owned(),
        is_words: true,
    }
}

/// Returns a column of numbers.
fn numbers(heading: &str) -> Column {
    Column {
        heading: heading.to_owned(),
        is_words: false,
    }
}

impl Document {
    /// Sets out a certificate.
    #[must_use]
    pub fn of(certificate: &Certificate) -> Self {
        let identity = &certificate.identity;
        let number = identity.number.as_deref().unwrap_or(NOT_STATED);
        let file = &identity.camera_file;
        let short = file.sha256.get(..16).unwrap_or(&file.sha256);
        Self {
            title: "Calibration certificate".to_owned(),
            subtitle: format!("{}, certificate number {number}", identity.name),
            foot: format!(
                "certificate {number}; camera file SHA-256 {short}…, CRC-32 {}",
                file.crc32
            ),
            sections: sections::all(certificate),
        }
    }
}
