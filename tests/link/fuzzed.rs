//! The fuzz targets over their corpus and over seeded random input.

use std::path::Path;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::corpus;
use crate::link::targets;

/// Runs every input of the corpus, then random ones, the same every time.
fn run(target: fn(&[u8]), name: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fuzz/corpus")
        .join(name);
    let inputs = corpus::read(&folder).unwrap();
    assert!(inputs.len() > 10, "{} inputs of {name}", inputs.len());
    for input in inputs {
        target(&input.bytes);
    }
    let seed = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(
        Config {
            failure_persistence: None,
            ..Config::with_cases(2000)
        },
        seed,
    );
    // Small numbers are more frequent than random ones would be, because they are lengths, zeros
    // and numbers of messages.
    let byte = prop_oneof![3 => 0_u8..16, 1 => any::<u8>()];
    runner
        .run(&vec(byte, 0..400), |bytes| {
            target(&bytes);
            Ok(())
        })
        .unwrap();
}

#[test]
fn any_bytes_on_the_wire_are_read_as_by_a_simple_reader() {
    run(targets::wire, "wire");
}

#[test]
fn camera_works_after_any_requests() {
    run(targets::station, "station");
}
