//! What follows a panic or a hard fault: time for the log, a mark for the next start, a reset.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;

use super::clock::CORE_MHZ;

/// Says that a fault led to the reset. No other content of the memory means anything.
const FAULT: u32 = 0xFA17_FA17;

/// Time for the debugger to collect the log.
const LOG_US: u32 = 20_000;

/// Survives a reset, since start-up code does not write this section.
#[unsafe(link_section = ".uninit.fault")]
static MARK: AtomicU32 = AtomicU32::new(0);

/// Whether a fault led to this start; the next start does not see it again.
pub(super) fn take() -> bool {
    MARK.swap(0, Ordering::Relaxed) == FAULT
}

/// Writes the memory that holds the mark, which has no content yet after power came on; reading it then could fail the
/// memory's error correction.
pub(super) fn forget() {
    MARK.store(0, Ordering::Relaxed);
}

/// Logs by `log`, unless that is what failed, and restarts.
fn restart(log: impl FnOnce()) -> ! {
    if MARK.swap(FAULT, Ordering::Relaxed) != FAULT {
        log();
        cortex_m::asm::delay(CORE_MHZ * LOG_US);
    }
    SCB::sys_reset()
}

/// Follows the log of a panic.
pub(in super::super) fn stop_after_panic() -> ! {
    restart(|| ())
}

/// Logs what the processor says of the fault.
#[exception(trampoline = false)]
unsafe fn HardFault() -> ! {
    // SAFETY: reading these registers has no effect.
    let (hard, configurable) = unsafe {
        let registers = &*SCB::PTR;
        (registers.hfsr.read(), registers.cfsr.read())
    };
    restart(|| {
        defmt::error!(
            "hard fault, HFSR {=u32:#x}, CFSR {=u32:#x}",
            hard,
            configurable
        );
    })
}
