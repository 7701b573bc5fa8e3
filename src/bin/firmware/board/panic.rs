//! Handlers of a panic. None is reachable: with `--cfg link_check` the handler calls a function
//! that exists nowhere, and the image links only if the linker can drop the handler.

use core::panic::PanicInfo;

#[cfg(all(negative_control, not(link_check)))]
compile_error!("negative_control is for the link check");

#[cfg(not(link_check))]
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let (file, line) = info
        .location()
        .map_or(("?", 0), |place| (place.file(), place.line()));
    defmt::error!("panic at {=str}:{=u32}", file, line);
    super::stop_after_panic()
}

#[cfg(link_check)]
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    fmc_camera_can_panic()
}

#[cfg(link_check)]
unsafe extern "C" {
    safe fn fmc_camera_can_panic() -> !;
}

/// Handles a `defmt::panic!`, which nothing calls. Without this handler defmt's linker script would
/// keep the default, which panics, even though it is never called.
#[defmt::panic_handler]
fn panic_of_the_log() -> ! {
    #[cfg(link_check)]
    fmc_camera_can_panic();
    #[cfg(not(link_check))]
    super::stop_after_panic()
}

/// A panic for the negative control of the link check.
#[cfg(negative_control)]
#[allow(clippy::indexing_slicing, reason = "the panic is the purpose")]
pub(super) fn can_panic() -> u8 {
    let table = core::hint::black_box([0; 4]);
    table[core::hint::black_box(4)]
}
