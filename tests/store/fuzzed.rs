//! The fuzz targets of a camera's flash over their corpus, over damaged inputs of it and over
//! seeded random ones.

use std::path::Path;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::corpus::{self, Input};
use crate::store::flash_model;

#[path = "../../fuzz/flash.rs"]
mod flash;

fn inputs(corpus: &str) -> Vec<Input> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fuzz/corpus")
        .join(corpus);
    corpus::read(&folder).unwrap()
}

/// Returns a runner of so many cases, the same every time.
fn seeded(cases: u32) -> TestRunner {
    let config = Config {
        failure_persistence: None,
        ..Config::with_cases(cases)
    };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

#[test]
fn any_contents_of_the_flash_are_used_whole_or_not_and_written_over() {
    let inputs = inputs("flash_image");
    let used = inputs
        .iter()
        .filter(|input| flash::flash_image(&input.bytes));
    // The others are damaged, or of the ring alone.
    assert!(used.count() > 2);
    let edits = vec((any::<Index>(), any::<u8>()), 0..4);
    seeded(600)
        .run(&(any::<Index>(), edits, 0..8_u8), |(input, edits, crcs)| {
            let mut bytes = input.get(&inputs).bytes.clone();
            let length = bytes.len();
            for (at, byte) in edits {
                bytes[at.index(length)] = byte;
            }
            bytes[0] |= crcs;
            flash::flash_image(&bytes);
            Ok(())
        })
        .unwrap();
}

#[test]
fn ring_keeps_its_entries_through_any_order_of_pushes_steps_starts_and_cuts() {
    for input in inputs("record_ring") {
        flash::record_ring(&input.bytes);
    }
    seeded(300)
        .run(&vec(any::<u8>(), 0..200), |bytes| {
            flash::record_ring(&bytes);
            Ok(())
        })
        .unwrap();
}
