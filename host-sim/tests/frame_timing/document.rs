//! The frame in the document, compared with the one flown here.

use crate::frame_timing::drawing::svg;
use crate::frame_timing::flight::{Flight, fly};

const DOCUMENT: &str = include_str!("../../../docs/integration.md");
const FIGURE: &str = "../docs/figures/frame-timing.svg";

/// `FMC_WRITE_FIGURE=1` writes the figure anew.
#[test]
fn figure_of_the_document_is_the_one_drawn_here() {
    let drawn = svg(&fly()).unwrap();
    if std::env::var_os("FMC_WRITE_FIGURE").is_some() {
        std::fs::write(FIGURE, &drawn).unwrap();
    }
    let shown = std::fs::read_to_string(FIGURE).unwrap();
    assert!(shown == drawn, "{FIGURE} is out of date");
}

#[test]
fn times_in_the_document_are_those_of_the_frame() {
    let Flight {
        handed_over_ms,
        command_ms,
        opened_ms,
        closed_ms,
        recorded_ms,
        armed_ms,
        ..
    } = fly();
    let expected = [
        ("trigger", 0.0),
        ("command handed over", handed_over_ms),
        ("command leaves", command_ms),
        ("first light", opened_ms),
        ("last light", closed_ms),
        ("record", recorded_ms),
        ("armed again", armed_ms),
    ]
    .map(|(name, ms)| (name, format!("{ms:.1}")));
    let documented: Vec<_> = DOCUMENT
        .lines()
        .skip_while(|line| !line.starts_with("| instant |"))
        .skip(2)
        .map_while(|line| line.strip_prefix("| ")?.strip_suffix(" |"))
        .map(|row| {
            let cells: Vec<_> = row.split(" | ").collect();
            (cells[0], cells[1].to_owned())
        })
        .collect();
    assert_eq!(documented, expected);
}

#[test]
fn stage_is_at_speed_and_centred_while_the_light_is_on() {
    let flight = fly();
    let open = flight
        .stage
        .iter()
        .filter(|it| (flight.opened_ms..=flight.closed_ms).contains(&it.ms));
    for instant in open.clone() {
        // 100 mm · 0.1 1/s.
        assert!((instant.speed_mm_s - 10.0).abs() < 1e-3, "{instant:?}");
        // Half of 33.3 µm on either side.
        assert!(instant.offset_mm.abs() < 0.0168, "{instant:?}");
    }
    assert!(open.count() > 30);
}
