//! Tables that are refused, each with its reason.

use fmc_adjustment::grid::table::TableObservation;

use crate::simulated::{BOTH, LENS, at_pitch, calibrated, camera, table};

/// Asserts that a changed table is refused in words that contain each of these.
fn refused(change: impl Fn(&mut TableObservation), parts: &[&str]) {
    let mut rows = table(&[0.0]);
    rows.iter_mut().for_each(change);
    let text = calibrated(&rows, &camera(), &LENS).unwrap_err().to_string();
    for part in ["table.csv"].iter().chain(parts) {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn corrections_and_other_units_are_told_by_the_camera_file() {
    let scaled = |factor: f64| {
        move |row: &mut TableObservation| {
            row.distortion_mm = row.distortion_mm.map(|value| factor * value);
        }
    };
    refused(scaled(-1.0), &["dx_um", "measured - ideal", "0.2 to 5"]);
    refused(scaled(1e-3), &["are they in mm?"]);
    refused(scaled(0.1), &["are they in pixels?"]);
    refused(
        scaled(1e3),
        &["line ", "nm", "a tenth of half the diagonal"],
    );
    refused(scaled(1e-8), &["is it in mm?"]);
}

#[test]
fn places_off_the_sensor_or_the_stroke_are_refused() {
    refused(
        |row| row.measured_mm[0] *= 1e3,
        &["line 2", "x_mm = -18", "-20 to 20"],
    );
    refused(
        |row| row.measured_mm = row.measured_mm.map(|value| value / 1e3),
        &["x_mm reaches", "is it in m?"],
    );
    refused(
        |row| {
            if row.line == 40 {
                row.stage_offset_mm = 1.5;
            }
        },
        &[
            "line 40",
            "stage_offset_mm = 1.5",
            "-1 to 1",
            "fmc.stroke_mm",
        ],
    );
}

#[test]
fn tables_and_pitches_that_give_no_grid_are_refused() {
    let camera = camera();
    let rows = table(&[0.3]);
    let text = calibrated(&rows, &camera, &BOTH).unwrap_err().to_string();
    assert!(
        text.contains("one stage position") && text.contains("0.3 mm"),
        "{text}"
    );
    let text = calibrated(&rows[..15], &camera, &LENS)
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("15 rows") && text.contains("16 and more"),
        "{text}"
    );
    // The message names a pitch that is accepted.
    let text = at_pitch(&rows, &camera, &LENS, 0.5)
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("84 x 88 nodes") && text.contains("at most 4096"),
        "{text}"
    );
    let (_, named) = text.rsplit_once(", so ").unwrap();
    let (named, _) = named.split_once(" mm").unwrap();
    let named: f64 = named.parse().unwrap();
    assert!(named < 0.8, "{named}");
    at_pitch(&rows, &camera, &LENS, named).unwrap();
}
