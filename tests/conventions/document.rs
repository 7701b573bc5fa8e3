//! Reader of the document and its tables, and check of the places where its numbers may stand.

/// Text of the document. Its paragraphs, code and tables are the blocks between blank lines.
const DOCUMENT: &str = include_str!("../../docs/conventions.md");

/// Returns the rows of every table whose first heading is `heading`.
pub(crate) fn rows(heading: &str) -> Vec<Vec<&'static str>> {
    rows_of(DOCUMENT, heading)
}

/// Returns the same rows of another document.
pub(crate) fn rows_of(document: &'static str, heading: &str) -> Vec<Vec<&'static str>> {
    let rows: Vec<_> = document
        .split("\n\n")
        .filter(|block| first_heading(block) == Some(heading))
        .flat_map(|table| table.lines().skip(2))
        .map(cells)
        .collect();
    assert!(!rows.is_empty(), "no table of {heading}");
    rows
}

/// Returns the whole text on one line.
pub(crate) fn running_text() -> String {
    DOCUMENT.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the text in backquotes in a cell.
pub(crate) fn names(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

fn first_heading(block: &str) -> Option<&str> {
    let heading = block.trim_start().strip_prefix('|')?.split('|').next()?;
    Some(heading.trim())
}

fn cells(line: &str) -> Vec<&str> {
    let inner = line
        .strip_prefix('|')
        .and_then(|line| line.strip_suffix('|'));
    inner.expect(line).split('|').map(str::trim).collect()
}

#[test]
fn numbers_with_a_unit_stand_only_in_tables_that_are_checked() {
    const CHECKED: &[Option<&str>] = &[Some("example"), Some("quantity"), Some("constant")];
    assert_numbers_checked(DOCUMENT, CHECKED);
}

/// Checks that numbers with a unit stand only in tables of these headings.
pub(crate) fn assert_numbers_checked(document: &str, checked: &[Option<&str>]) {
    const UNITS: &[&str] = &[
        "mm", "µm", "nm", "m", "cm", "px", "s", "ms", "1/s", "mm/s", "m/s", "%", "rows", "°", "°/s",
    ];
    for block in document.split("\n\n") {
        if checked.contains(&first_heading(block)) {
            continue;
        }
        let words: Vec<_> = block.split_whitespace().collect();
        for pair in words.windows(2) {
            let number = pair[0].trim_start_matches(['(', '*']);
            let unit = pair[1].trim_end_matches(['.', ',', ';', ':', ')', '*']);
            assert!(
                !(UNITS.contains(&unit) && number.parse::<f64>().is_ok()),
                "unchecked number {number} {unit}: {block}"
            );
        }
    }
}
