//! Tables for a terminal, as wide as it is: from 80 to 120 columns, and 80 elsewhere.

use std::io::{self, IsTerminal};

use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Table, TableStyle, Width,
};

/// Least and largest width of a table, columns of the terminal.
const WIDTHS: [u16; 2] = [80, 120];

/// Distance of neighbouring columns, and the distance where the table would be too wide with that.
const GAPS: [u16; 2] = [2, 1];

/// Part of the distance that belongs to the junctions of the lines.
const JUNCTION: u16 = 1;

/// Horizontal lines above, below and under the headings.
const LINES: TableStyle = TableStyle::new()
    .top_border(LineStyle::none().fill('─').junction('─'))
    .header_separator(LineStyle::none().fill('═').junction('═'))
    .bottom_border(LineStyle::none().fill('─').junction('─'));

/// Returns the width of a table: that of the terminal, or 80 columns in a pipe.
fn width() -> u16 {
    let [least, most] = WIDTHS;
    if !io::stdout().is_terminal() {
        return least;
    }
    terminal_size::terminal_size_of(io::stdout())
        .map_or(least, |(width, _)| width.0.clamp(least, most))
}

/// A column of a table.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    heading: String,
    alignment: CellAlignment,
}

/// Returns a column of words, which stand on the left.
pub(crate) fn words(heading: impl Into<String>) -> Column {
    Column {
        heading: heading.into(),
        alignment: CellAlignment::Left,
    }
}

/// Returns a column of numbers, which stand on the right.
pub(crate) fn numbers(heading: impl Into<String>) -> Column {
    Column {
        heading: heading.into(),
        alignment: CellAlignment::Right,
    }
}

/// Writes a table, without a line feed at its end.
///
/// If it would be wider than the terminal, the cells of the first column go on in a second line; no
/// other cell is broken.
pub(crate) fn table<const N: usize>(
    columns: impl IntoIterator<Item = Column>,
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    lines(columns, rows.into_iter().map(Vec::from))
}

/// Writes a table whose number of columns is not known beforehand.
pub(crate) fn lines(
    columns: impl IntoIterator<Item = Column>,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let (headings, alignments): (Vec<String>, Vec<CellAlignment>) = columns
        .into_iter()
        .map(|column| (column.heading, column.alignment))
        .unzip();
    let width = width();
    let mut table = Table::new();
    table
        .load_style(LINES)
        .set_header(headings)
        .add_rows(rows)
        .set_width(width)
        .set_content_arrangement(ContentArrangement::Dynamic);
    let gap = gap(&table, width);
    let last = alignments.len().saturating_sub(1);
    for ((index, column), alignment) in table.column_iter_mut().enumerate().zip(alignments) {
        column.set_cell_alignment(alignment);
        column.set_padding((0, if index == last { 0 } else { gap - JUNCTION }));
        if index > 0 {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    table.trim_fmt()
}

/// Returns the larger gap that leaves room for every cell in one line, or else the smaller one.
fn gap(table: &Table, width: u16) -> u16 {
    let [large, small] = GAPS;
    let widths = table.column_max_content_widths();
    let gaps = u16::try_from(widths.len().saturating_sub(1)).unwrap_or(u16::MAX);
    let fits = widths.iter().sum::<u16>() + gaps * large <= width;
    if fits { large } else { small }
}

/// Writes names and what they stand for, a line each, without a line feed at the end.
///
/// The names take `names` columns. What is longer than the rest of the terminal goes on in the next
/// line, under its beginning.
#[must_use]
pub fn pairs<'a>(names: u16, pairs: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let mut table = Table::new();
    table
        .load_style(TableStyle::new())
        .add_rows(
            pairs
                .into_iter()
                .map(|(name, what)| [name.to_owned(), what]),
        )
        .set_width(width())
        .set_content_arrangement(ContentArrangement::Dynamic);
    for column in table.column_iter_mut() {
        column.set_padding((0, 0));
    }
    if let Some(column) = table.column_mut(0) {
        column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(names)));
    }
    table.trim_fmt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widths(text: &str) -> Vec<usize> {
        text.lines().map(|line| line.chars().count()).collect()
    }

    #[test]
    fn words_are_broken_and_numbers_are_not() {
        let long = "a camera with a name that is far longer than any name should be".to_owned();
        let number = "1234567.891234567".to_owned();
        let text = table(
            [words("camera"), numbers("µm"), numbers("nm")],
            [[long.clone(), number.clone(), number.clone()]],
        );
        assert!(widths(&text).iter().all(|width| *width <= 80), "{text}");
        assert_eq!(text.matches(&number).count(), 2, "{text}");
        let first: Vec<String> = text
            .lines()
            .skip(3)
            .map(|line| line.chars().take(44).collect::<String>().trim().to_owned())
            .collect();
        assert!(first.join(" ").starts_with(&long), "{text}");
    }

    #[test]
    fn lines_are_as_long_as_the_table() {
        let text = table(
            [words("term"), numbers("µm")],
            [["all".to_owned(), "0.1".to_owned()]],
        );
        assert_eq!(
            text,
            "─────────\nterm   µm\n═════════\nall   0.1\n─────────"
        );
    }

    #[test]
    fn pairs_go_on_under_their_beginning() {
        let text = pairs(6, [("one", "two".to_owned()), ("long", "word ".repeat(20))]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "one   two");
        assert!(lines[1].starts_with("long  word word"), "{text}");
        assert!(lines[2].starts_with("      word"), "{text}");
        assert!(widths(&text).iter().all(|width| *width <= 80), "{text}");
    }
}
