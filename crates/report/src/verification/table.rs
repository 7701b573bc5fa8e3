//! The verification as a table for a terminal or a pipe.

use comfy_table::{Cell, CellAlignment, Table, presets::UTF8_FULL_CONDENSED};
use fmc_reference::verification::result::Verification;

use super::comparison::{Comparison, Row};
use super::verdict::{self, Verdict};
use crate::wording;

/// Writes the whole verification: the device, a row per camera, the worst case, the verdict, and
/// the device again, as the first line may have scrolled off the terminal.
#[must_use]
pub fn text(verification: &Verification) -> String {
    let verdict = Verdict::of(verification);
    let mut lines = vec![
        format!("device: {}", verification.place()),
        format!("points: {}", wording::evidence(&verification.evidence)),
    ];
    lines.extend(
        verification
            .link
            .map(|link| format!("link: {}", wording::link(&link))),
    );
    lines.extend([
        table(&Comparison::of(verification)).trim_fmt(),
        "errors of dx and of dy (per axis) against the strict solver, over all points and exposures"
            .to_owned(),
    ]);
    lines.extend(verdict.worst.map(|worst| format!("worst case: {worst}")));
    lines.extend(verdict.failures);
    lines.push(format!("limits: {}", verdict::limits()));
    let word = if verdict.passed { "PASS" } else { "FAIL" };
    lines.push(format!("{word}: {}", verdict.headline));
    lines.push(format!("ran on {}", verification.place()));
    lines.join("\n") + "\n"
}

fn table(comparison: &Comparison) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    let mut header = vec![
        "camera".to_owned(),
        "points".to_owned(),
        "δ\nµm".to_owned(),
        "distortion\nµm".to_owned(),
    ];
    for (label, unit) in &comparison.treatments {
        header.push(format!("{label}\nmax / rms, {unit}"));
    }
    header.push("coordinate\nmax, nm".to_owned());
    header.push("verdict".to_owned());
    table.set_header(header);
    for row in &comparison.rows {
        table.add_row(cells(row));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn cells(row: &Row) -> Vec<Cell> {
    let mut cells = vec![
        Cell::new(&row.camera),
        Cell::new(row.points),
        Cell::new(&row.travel_um),
        Cell::new(&row.distortion_um),
    ];
    for errors in &row.errors {
        cells.push(Cell::new(format!("{} / {}", errors.max, errors.rms)));
    }
    cells.push(Cell::new(&row.coordinate_max_nm));
    cells.push(Cell::new(if row.passed { "pass" } else { "FAIL" }));
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verification::fixture;

    #[test]
    fn table_holds_every_camera_device_limits_and_verdict() {
        let text = text(&fixture::passing());
        assert!(text.starts_with(
            "device: mock camera\npoints: 36 shown by digest to have the bits computed on this PC, 5 of them also compared one by one\n"
        ));
        for part in [
            "Alpha",
            "Beta",
            "1.5 nm",
            "5 nm",
            "0.01 nm",
            "worst case: Beta",
        ] {
            assert!(text.contains(part), "{part} is missing in\n{text}");
        }
        let last: Vec<_> = text.lines().rev().take(2).collect();
        assert_eq!(last[0], "ran on mock camera");
        assert!(last[1].starts_with("PASS: "));
    }

    #[test]
    fn stand_in_for_qemu_is_the_first_line_and_the_last() {
        let mut verification = fixture::passing();
        verification.not_in_qemu = Some("no QEMU: none here; to mend it: brew install".to_owned());
        let text = text(&verification);
        let lines: Vec<_> = text.lines().collect();
        let place = "mock camera, NOT in QEMU: no QEMU: none here; to mend it: brew install";
        assert_eq!(lines[0], format!("device: {place}"));
        assert_eq!(lines[lines.len() - 1], format!("ran on {place}"));
    }

    #[test]
    fn table_fits_200_columns() {
        let text = text(&fixture::passing());
        assert!(text.lines().all(|line| line.chars().count() <= 200));
    }

    #[test]
    fn failing_verification_says_so_and_names_the_camera() {
        let text = text(&fixture::failing());
        assert!(text.contains("Beta: error of dx or dy 2.00 nm exceeds 1.5 nm"));
        assert!(text.lines().any(|line| line.starts_with("FAIL: ")));
    }
}
