//! Content of the reports that belongs to one method alone.

use serde_json::{Map, Value};

use crate::terminal;

/// A figure in a file of its own and on the page.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Name of the file.
    pub file_name: String,
    /// Caption on the page.
    pub caption: String,
    /// The figure.
    pub svg: String,
}

/// A table on the page, of one method alone.
#[derive(Debug, Clone, Default)]
pub struct PageTable {
    /// Heading.
    pub title: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
    /// Sentences below it.
    pub caption: String,
}

impl PageTable {
    /// Writes the table for a terminal, without its caption; empty without rows.
    #[must_use]
    pub fn text(&self) -> String {
        if self.rows.is_empty() {
            return String::new();
        }
        let columns = self.columns.iter().enumerate().map(|(index, name)| {
            if index == 0 {
                terminal::words(name)
            } else {
                terminal::numbers(name)
            }
        });
        let table = terminal::lines(columns, self.rows.iter().cloned());
        format!("{}\n{table}\n", self.title)
    }
}

/// Content of the reports that belongs to one method alone.
#[derive(Debug, Clone, Default)]
pub struct OfMethod {
    /// Keys of `summary.json`.
    pub summary: Map<String, Value>,
    /// Tables of the page.
    pub tables: Vec<PageTable>,
    /// Figures, before those of all methods.
    pub figures: Vec<Figure>,
    /// Further files by name.
    pub files: Vec<(String, Vec<u8>)>,
}

impl OfMethod {
    /// Adds the content of another method that goes on from this one.
    pub fn join(&mut self, mut other: Self) {
        self.summary.append(&mut other.summary);
        self.tables.append(&mut other.tables);
        self.figures.append(&mut other.figures);
        self.files.append(&mut other.files);
    }
}
