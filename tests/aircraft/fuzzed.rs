//! The fuzz targets over their corpus and over seeded random input.

use std::path::Path;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::aircraft::targets;
use crate::corpus;

/// Runs every input of the corpus, then random ones, the same every time.
fn run(target: fn(&[u8]), name: &str, frequent: &'static [u8]) {
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
    let byte = prop_oneof![3 => select(frequent), 1 => any::<u8>()];
    runner
        .run(&vec(byte, 0..400), |bytes| {
            target(&bytes);
            Ok(())
        })
        .unwrap();
}

#[test]
fn sentence_is_read_after_any_bytes() {
    run(
        targets::nmea,
        "nmea",
        b"0123456789.,,,,$*AVNEWMKTnaif-e\r\n",
    );
}

#[test]
fn message_is_read_after_any_bytes() {
    run(
        targets::mavlink,
        "mavlink",
        &[0xfd, 0xfe, 0, 1, 2, 25, 33, 132, 141],
    );
}
