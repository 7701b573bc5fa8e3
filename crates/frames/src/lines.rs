//! Lines of the rows of a table.

use csv::Position;

/// Counter of the lines in which the rows of a table begin, as an editor shows them.
///
/// The reader of CSV counts a line of `\r\n` only when it comes to the next, so that the row behind
/// the header is in line 1.
#[derive(Debug, Clone, Copy, Default)]
pub struct Lines {
    behind: Option<u64>,
}

impl Lines {
    /// Returns the line of a row behind the header; it must be called for the first of them.
    pub fn of(&mut self, row: Option<&Position>) -> u64 {
        let line = row.map_or(0, Position::line);
        line + *self.behind.get_or_insert(u64::from(line == 1))
    }
}
