//! Handlers of faults, panics and the watchdog.

use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;
use cortex_m_semihosting::debug;

use super::super::{cause, hard_fault::HardFault};
use super::{link, watchdog, wires};
use fmc_camera::io::link::message::ResetCause;

/// Ends QEMU with failure, so that the process that waits for the camera learns of it at once.
fn stop(start: ResetCause) -> ! {
    cause::note(start);
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}

/// Stops after the log of a panic.
#[allow(dead_code, reason = "the link check's panic handler does without")]
pub(in super::super) fn stop_after_panic() -> ! {
    stop(ResetCause::Fault)
}

/// Restarts after a stack overflow, as a board does after any fault; ends QEMU after any other.
pub(in super::super) fn stop_after_fault(fault: &HardFault) -> ! {
    let is_overflow = fault.cause == ResetCause::StackOverflow;
    if is_overflow {
        cause::note(fault.cause);
    }
    fault.log();
    if is_overflow {
        SCB::sys_reset()
    }
    stop(fault.cause)
}

/// One expiry has been forgiven since the main loop fed the watchdog last.
pub(super) static FORGIVEN: AtomicBool = AtomicBool::new(false);

/// Handles the watchdog's expiry. If the main loop is asleep, time may have jumped: that is
/// forgiven once, and a main loop that works wakes within a millisecond.
#[exception]
unsafe fn NonMaskableInt() {
    if link::is_asleep() && !FORGIVEN.swap(true, Ordering::Relaxed) {
        watchdog::feed();
        return;
    }
    defmt::error!("main loop stands still");
    cause::note(ResetCause::Watchdog);
    SCB::sys_reset()
}

/// Handles all interrupts; those of the link and of the wires are enabled.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    if number == link::Receive::NUMBER.cast_signed() {
        link::collect();
    } else if let Some(wire) = wires::of_interrupt(number) {
        wires::collect(wire);
    } else {
        defmt::error!("unexpected exception {=i16}", number);
        stop(ResetCause::Fault)
    }
}
