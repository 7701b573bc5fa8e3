//! Blocks of which the pages are made.

use crate::figure::Drawing;

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
pub(super) fn words(heading: &str) -> Column {
    Column {
        heading: heading.to_owned(),
        is_words: true,
    }
}

/// Returns a column of numbers.
pub(super) fn numbers(heading: &str) -> Column {
    Column {
        heading: heading.to_owned(),
        is_words: false,
    }
}
