//! Places of a source as offsets of its text.

use std::ops::Range;

use proc_macro2::{LineColumn, Span as TokenSpan};

use super::mutant::{Place, Span};

/// A source with the offsets at which its lines begin.
#[derive(Debug)]
pub(super) struct SourceText<'a> {
    pub(super) text: &'a str,
    lines: Vec<usize>,
}

impl<'a> SourceText<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let after = text.match_indices('\n').map(|(at, _)| at + 1);
        Self {
            text,
            lines: [0].into_iter().chain(after).collect(),
        }
    }

    /// Returns the offset of a place, in bytes; none beyond the text.
    fn offset(&self, place: Place) -> Option<usize> {
        let start = *self.lines.get(place.line.checked_sub(1)?)?;
        let rest = self.text.get(start..)?;
        let before = rest.chars().take(place.column.checked_sub(1)?);
        Some(start + before.map(char::len_utf8).sum::<usize>())
    }

    pub(super) fn range(&self, span: Span) -> Option<Range<usize>> {
        Some(self.offset(span.start)?..self.offset(span.end)?)
    }

    /// Returns the offsets of tokens.
    pub(super) fn range_of(&self, span: TokenSpan) -> Option<Range<usize>> {
        self.range(place_of(span))
    }

    pub(super) fn get(&self, range: &Range<usize>) -> &'a str {
        self.text.get(range.clone()).unwrap_or_default()
    }

    /// Returns the line of a number, without the space around it.
    pub(super) fn line(&self, number: usize) -> &'a str {
        let line = self.text.lines().nth(number.saturating_sub(1));
        line.unwrap_or_default().trim()
    }
}

/// Returns the places of tokens.
pub(super) fn place_of(span: TokenSpan) -> Span {
    // Columns are from zero there.
    let place = |at: LineColumn| Place {
        line: at.line,
        column: at.column + 1,
    };
    Span {
        start: place(span.start()),
        end: place(span.end()),
    }
}
