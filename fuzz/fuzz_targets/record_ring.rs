//! Fuzz target of a ring of records: `cargo xtask fuzz record_ring`.

#![no_main]

#[allow(dead_code, reason = "each program runs one of the targets")]
#[path = "../flash.rs"]
mod flash;
#[allow(dead_code, reason = "the tests of the store use all of it")]
#[path = "../../tests/store/flash_model.rs"]
mod flash_model;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    flash::record_ring(bytes);
});
