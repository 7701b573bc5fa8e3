//! Fuzz target of frames in TIFF files: `cargo xtask fuzz raster`.

#![no_main]

#[path = "../raster.rs"]
mod raster;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    raster::raster(bytes);
});
