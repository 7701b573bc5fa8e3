//! Fuzz target of requests to a camera: `cargo xtask fuzz station`.

#![no_main]

#[allow(dead_code, reason = "each program runs one of the targets")]
#[path = "../targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::station(bytes));
