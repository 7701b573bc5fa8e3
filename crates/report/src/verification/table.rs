//! The verification as a table for a terminal or a pipe.

use fmc_reference::verification::result::Verification;

use super::comparison::{Comparison, ErrorCell};
use super::verdict::{self, Verdict};
use crate::terminal::{self, numbers, words};
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
    let comparison = Comparison::of(verification);
    lines.extend([
        conditions(&comparison),
        "errors of dx and of dy (per axis) against the strict solver, over all points and exposures"
            .to_owned(),
        errors(&comparison),
    ]);
    lines.extend(verdict.worst.map(|worst| format!("worst case: {worst}")));
    lines.extend(verdict.failures);
    lines.push(format!("limits: {}", verdict::limits()));
    let word = if verdict.passed { "PASS" } else { "FAIL" };
    lines.push(format!("{word}: {}", verdict.headline));
    lines.push(format!("ran on {}", verification.place()));
    lines.join("\n") + "\n"
}

/// Writes what was verified: points, travel, distortion, and the errors if nothing is corrected.
fn conditions(comparison: &Comparison) -> String {
    let [(label, unit), ..] = comparison.treatments;
    let columns = [
        words("camera"),
        numbers("points"),
        numbers("δ\nµm"),
        numbers("distortion\nµm"),
        numbers(format!("{label}\nmax / rms, {unit}")),
    ];
    let rows = comparison.rows.iter().map(|row| {
        let [uncorrected, ..] = &row.errors;
        [
            row.camera.clone(),
            row.points.to_string(),
            row.travel_um.clone(),
            row.distortion_um.clone(),
            format!("{} / {}", uncorrected.max, uncorrected.rms),
        ]
    });
    terminal::table(columns, rows)
}

/// Writes the errors of the corrections, largest and root mean square, and the verdicts.
fn errors(comparison: &Comparison) -> String {
    let [_, fixed, printed, camera] = comparison.treatments.map(|(_, unit)| unit);
    let columns = [
        words("camera"),
        words(""),
        numbers(format!("static\n\n\n{fixed}")),
        numbers(format!("static +\nprinted\n(20)-(21)\n{printed}")),
        numbers(format!("this\ncamera\n\n{camera}")),
        numbers("coordinate\n\n\nnm"),
        numbers("verdict"),
    ];
    let rows = comparison.rows.iter().map(|row| {
        let [_, fixed, printed, camera] = &row.errors;
        let cell = |errors: &ErrorCell| format!("{}\n{}", errors.max, errors.rms);
        [
            row.camera.clone(),
            "max\nrms".to_owned(),
            cell(fixed),
            cell(printed),
            cell(camera),
            row.coordinate_max_nm.clone(),
            if row.passed { "pass" } else { "FAIL" }.to_owned(),
        ]
    });
    terminal::table(columns, rows)
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
    fn tables_fit_80_columns() {
        let comparison = Comparison::of(&fixture::passing());
        for table in [conditions(&comparison), errors(&comparison)] {
            assert!(table.lines().all(|line| line.chars().count() <= 80));
        }
    }

    #[test]
    fn failing_verification_says_so_and_names_the_camera() {
        let text = text(&fixture::failing());
        assert!(text.contains("Beta: error of dx or dy 2.00 nm exceeds 1.5 nm"));
        assert!(text.lines().any(|line| line.starts_with("FAIL: ")));
    }
}
