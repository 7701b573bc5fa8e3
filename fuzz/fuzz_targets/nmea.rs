//! Fuzz target of satellite sentences: `cargo xtask fuzz nmea`.

#![no_main]

#[allow(dead_code, reason = "each program runs one of the targets")]
#[path = "../aircraft.rs"]
mod aircraft;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| aircraft::nmea(bytes));
