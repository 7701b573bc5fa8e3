//! Fuzz target of camera files: `cargo xtask fuzz camera_file`.

#![no_main]

#[allow(dead_code, reason = "each program runs one of the targets")]
#[path = "../files.rs"]
mod files;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    files::camera_file(bytes);
});
