//! Fuzz target of autopilot messages: `cargo xtask fuzz mavlink`.

#![no_main]

#[allow(dead_code, reason = "each program runs one of the targets")]
#[path = "../aircraft.rs"]
mod aircraft;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| aircraft::mavlink(bytes));
