//! Counter of the instructions of the camera's work on an emulated Cortex-M.
//!
//! Under `-icount shift=0` an instruction takes one nanosecond of the emulated time, so that the
//! system timer counts instructions, exactly and repeatably: 40 to a tick, 31.25 on the Cortex-M55.
//! They are instructions, not cycles.
//!
//! It prints a line `kernel,unit,repetitions,instructions` for each kernel over semihosting.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod aircraft;
#[cfg(target_os = "none")]
mod counter;
#[cfg(target_os = "none")]
mod flight;
#[cfg(target_os = "none")]
mod fold;
#[cfg(target_os = "none")]
mod geometry;
#[cfg(target_os = "none")]
mod grid;
#[cfg(target_os = "none")]
mod interrupts;
#[cfg(target_os = "none")]
mod link;
#[cfg(target_os = "none")]
mod mesh;
#[cfg(target_os = "none")]
mod other_crate;
#[cfg(target_os = "none")]
#[path = "../../../tests/kernel/src/panic.rs"]
mod panic;
#[cfg(target_os = "none")]
#[path = "../../../src/bin/firmware/board/receive_ring.rs"]
mod receive_ring;
#[cfg(target_os = "none")]
mod sensors;
#[cfg(target_os = "none")]
mod signature;
#[cfg(target_os = "none")]
mod specimen;
#[cfg(target_os = "none")]
#[allow(dead_code, reason = "the guard is the firmware's")]
#[path = "../../../src/bin/firmware/board/stack.rs"]
mod stack;

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn count() -> ! {
    use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};

    let counted = cortex_m::Peripherals::take().and_then(|peripherals| {
        let mut counter = counter::Counter::new(peripherals.SYST);
        counter.is_calibrated().then_some(())?;
        geometry::count(&mut counter)?;
        fold::count(&mut counter)?;
        grid::count(&mut counter)?;
        mesh::count(&mut counter)?;
        other_crate::count(&mut counter)?;
        flight::count(&mut counter)?;
        interrupts::count(&mut counter)?;
        aircraft::count(&mut counter)?;
        signature::count(&mut counter)?;
        link::count(&mut counter)
    });
    exit(if counted.is_some() {
        EXIT_SUCCESS
    } else {
        EXIT_FAILURE
    });
    loop {
        cortex_m::asm::wfi();
    }
}
