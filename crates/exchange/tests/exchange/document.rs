//! Numbers of `docs/formats.md`.

use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::program::Program;

use crate::support::{cameras, written};

const DOCUMENT: &str = include_str!("../../../../docs/formats.md");

/// Program and model of each column.
const COLUMNS: [(Program, &str); 5] = [
    (Program::Kalibr, "radtan"),
    (Program::Pix4d, "perspective"),
    (Program::Ros, "rational_polynomial"),
    (Program::Metashape, "frame"),
    (Program::OpenCv, "opencv14"),
];

/// Returns the cells of each row of the table with a heading.
pub(crate) fn rows(heading: &str) -> Vec<Vec<&'static str>> {
    let lines = DOCUMENT.lines();
    lines
        .skip_while(|line| !line.starts_with(heading))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect()
}

fn named(name: &str) -> Calibrated {
    cameras().into_iter().find(|one| one.name == name).unwrap()
}

#[test]
fn documented_residuals_are_those_of_the_export() {
    let rows = rows("| camera |");
    assert_eq!(rows.len(), 4);
    for row in rows {
        let camera = named(row[0]);
        assert_eq!(row.len(), 1 + COLUMNS.len());
        for (cell, (program, model)) in row[1..].iter().zip(COLUMNS) {
            let (largest, rms) = cell.split_once(" / ").unwrap();
            let residual = written(&camera, program, model).residual;
            for (text, found) in [(largest, residual.largest_um), (rms, residual.rms_um)] {
                let expected: f64 = text.parse().unwrap();
                let decimals = text.split_once('.').unwrap().1.len();
                let unit = 10f64.powi(-i32::try_from(decimals).unwrap());
                let off = (found - expected).abs();
                assert!(
                    off <= 0.55 * unit,
                    "{}, {model}: {found}, not {text}",
                    row[0]
                );
            }
        }
    }
}

/// Mistakes and their largest residuals on the iXM and on the RC30; `mistakes.rs` asserts them.
const MISTAKES: [[&str; 3]; 6] = [
    [
        "coefficients copied, units and signs right",
        "9.64",
        "0.0006",
    ],
    ["inverse power series, to r⁷", "16.5", "0.0075"],
    ["half a pixel", "2.28", "6.35"],
    ["p1 and p2 exchanged", "23.3", "4.42"],
    ["y of p1 not reversed", "17.3", "4.63"],
    ["y of the principal point not reversed", "48.1", "2.00"],
];

#[test]
fn documented_mistakes_are_those_of_the_tests() {
    let rows = rows("| mistake |");
    assert_eq!(rows[0][1..], ["0.402", "0.0007"]);
    assert_eq!(rows.len(), 1 + MISTAKES.len());
    for (row, expected) in rows[1..].iter().zip(MISTAKES) {
        assert_eq!(*row, expected);
        let source = include_str!("mistakes.rs");
        for number in &expected[1..] {
            assert!(source.contains(number.trim_end_matches('0')), "{number}");
        }
    }
}

#[test]
fn documented_files_are_those_of_the_export() {
    let ixm = named("Phase One iXM-RS150F 50 mm");
    let rows = rows("| format |");
    assert_eq!(rows.len(), 12);
    for row in rows {
        let format = row[0].trim_matches('`');
        let program = Program::WRITTEN
            .into_iter()
            .find(|one| one.name() == format);
        let exported = written(&ixm, program.unwrap(), "");
        for (name, _) in exported.files {
            let stem = name.split(['.', '-']).next().unwrap();
            assert!(row[1].contains(stem), "{format}: {name}");
        }
    }
}
