//! The camera for programs in C: a static library without heap and without variables of its own,
//! with the header `include/fmc_camera.h`. `docs/c.md` is its guide.
//!
//! Objects (camera, frame, mesh, flight) lie in storage of the caller, whose first word is a tag.
//! Every function checks its pointers before it looks behind them, returns an [`fmc_status`], and
//! fills an [`fmc_error`] when it refuses. All code that trusts a pointer is in `memory`.

#![no_std]
#![expect(
    non_camel_case_types,
    reason = "types have the names that they have in C"
)]

// The tests run on a PC, and a program there brings its own way to end.
#[cfg(not(any(target_os = "none", target_family = "wasm")))]
extern crate std;

mod calibration_blob;
mod camera;
mod camera_record;
mod code;
#[cfg(control)]
mod control;
mod error;
#[cfg(test)]
mod error_sentences;
mod error_text;
mod event;
mod exposure;
mod flight;
mod flight_settings;
mod frame;
mod frame_record;
mod memory;
mod mesh;
mod points;
mod record_bytes;
mod record_code;
mod refusal;
mod text;
mod version;

pub use calibration_blob::*;
pub use camera::*;
pub use camera_record::*;
pub use code::*;
pub use error::*;
pub use error_text::*;
pub use event::*;
pub use exposure::*;
pub use flight::*;
pub use flight_settings::*;
pub use frame::*;
pub use frame_record::*;
pub use mesh::*;
pub use points::*;
pub use record_bytes::*;
pub use record_code::*;
pub use refusal::{Failure, Refusal};
pub use version::*;

/// Links only where no panic can be reached: the symbol that it names is defined nowhere.
#[cfg(any(target_os = "none", target_family = "wasm"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        safe fn fmc_camera_can_panic() -> !;
    }
    fmc_camera_can_panic()
}
