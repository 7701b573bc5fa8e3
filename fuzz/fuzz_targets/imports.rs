//! Fuzz target of other programs' files: `cargo xtask fuzz imports`.

#![no_main]

#[allow(dead_code, reason = "each program runs one of the targets")]
#[path = "../files.rs"]
mod files;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    files::imports(bytes);
});
