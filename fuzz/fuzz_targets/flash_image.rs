//! Fuzz target of any contents of a camera's flash: `cargo xtask fuzz flash_image`.

#![no_main]

#[allow(dead_code, reason = "each program runs one of the targets")]
#[path = "../flash.rs"]
mod flash;
#[allow(dead_code, reason = "the tests of the store use all of it")]
#[path = "../../tests/store/flash_model.rs"]
mod flash_model;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    flash::flash_image(bytes);
});
