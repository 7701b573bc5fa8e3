//! `docs/integration.md` against the code: its lists and quotations. States to which faults lead
//! are compared in `tests/controller/document.rs`, times of a frame in
//! `host-sim/tests/frame_timing`.

mod constants;
mod fields;
mod lists;
mod settings;

use crate::conventions::document::{assert_numbers_checked, rows_of};

const DOCUMENT: &str = include_str!("../../../docs/integration.md");

#[expect(dead_code, reason = "its `main` prints what is compared here")]
#[path = "../../../examples/imaginary_mechanism.rs"]
mod imaginary_mechanism;

fn rows(heading: &str) -> Vec<Vec<&'static str>> {
    rows_of(DOCUMENT, heading)
}

/// Returns the output of the example as the document quotes it, and the text before and after it.
fn around_output() -> (&'static str, &'static str, &'static str) {
    let fence = "```output\n";
    let at = DOCUMENT.find(fence).unwrap() + fence.len();
    let (before, rest) = DOCUMENT.split_at(at);
    let (output, after) = rest.split_once("```").unwrap();
    (before, output, after)
}

#[test]
fn example_is_short_and_prints_what_the_document_shows() {
    let source = include_str!("../../../examples/imaginary_mechanism.rs");
    assert!(source.lines().count() < 100);
    let (_, shown, _) = around_output();
    assert_eq!(shown, imaginary_mechanism::flight().unwrap());
}

#[test]
fn numbers_with_a_unit_stand_only_in_what_is_checked() {
    let tables = ["setting", "source of V/H", "constant", "instant"];
    let (before, _, after) = around_output();
    for part in [before, after] {
        assert_numbers_checked(part, &tables.map(Some));
    }
}
