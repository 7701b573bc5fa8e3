//! Program that links for the target only if no public function of `fmc-camera` listed here can
//! reach a panic.
//!
//! The panic handler calls a function that does not exist. The linker drops unreachable code, so
//! the undefined symbol `fmc_camera_can_panic` remains, and fails the link, exactly when a listed
//! function can panic for *some* arguments: each is taken by address, so that the optimiser knows
//! nothing about them.
//!
//! A new public function of the library gets a line in the file of its area; `cargo xtask test`
//! compares the lists with the sources, and where a panic is reachable names the functions on the
//! way to it. Text output (`Display`, `Debug`) is not listed: formatting in the core library can
//! panic itself, and the flight side does without it.

#![cfg_attr(target_os = "none", no_std, no_main)]

/// Keeps functions alive, as if they were called with unknown arguments.
macro_rules! keep {
    ($($function:path),* $(,)?) => {
        $(core::hint::black_box($function as *const ());)*
    };
}

mod flash;
mod flight;
mod geometry;
mod gridded;
mod io;
#[cfg(negative_control)]
mod negative_control;
mod pin;

fn keep_everything() {
    geometry::keep();
    gridded::keep();
    flight::keep();
    io::keep();
    #[cfg(negative_control)]
    negative_control::keep();
}

#[cfg(not(target_os = "none"))]
fn main() {
    keep_everything();
}

/// The root from which the linker keeps code; never run.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
extern "C" fn entry() {
    keep_everything();
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        safe fn fmc_camera_can_panic() -> !;
    }
    fmc_camera_can_panic()
}
