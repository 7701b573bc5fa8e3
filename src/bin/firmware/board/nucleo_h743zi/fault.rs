//! Handlers of a panic, a hard fault or an unexpected exception: they leave time for the log, set a
//! mark for the next start, and reset.

use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;
use fmc_camera::io::link::message::ResetCause;

use super::super::{cause, hard_fault::HardFault};
use super::{
    clock::{self, CORE_MHZ},
    control_loop,
};

/// Time for the debugger to collect the log.
const LOG_US: u32 = 20_000;

/// Longest time from the handler's entry until the reset, ms: the delay counts instructions, which
/// may take twice as long.
pub(super) const RESETS_WITHIN_MS: u32 = 2 * LOG_US / 1000;

/// Logs by `log`, unless the log itself failed, and restarts.
fn restart(start: ResetCause, log: impl FnOnce()) -> ! {
    restart_noted(start, !control_loop::is_overdue(), log)
}

/// As [`restart`]; `is_punctual` is `true` if rounds have come until now, by a clock that runs.
fn restart_noted(start: ResetCause, is_punctual: bool, log: impl FnOnce()) -> ! {
    control_loop::stop();
    if !matches!(
        cause::noted(),
        ResetCause::Fault | ResetCause::StackOverflow
    ) {
        if is_punctual {
            cause::note_punctual(start);
        } else {
            cause::note(start);
        }
        log();
        cortex_m::asm::delay(CORE_MHZ * LOG_US);
    }
    SCB::sys_reset()
}

/// Restarts after the log of a panic.
pub(in super::super) fn stop_after_panic() -> ! {
    restart(ResetCause::Fault, || ())
}

/// Restarts after a hard fault, of which a stack overflow is one.
pub(in super::super) fn stop_after_fault(fault: &HardFault) -> ! {
    restart(fault.cause, || fault.log())
}

/// Restarts after the clock of the ST-LINK has failed. Without it start-up waits until the watchdog
/// restarts it, again and again.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    clock::note_failure();
    restart_noted(ResetCause::Fault, false, || {
        defmt::error!("the clock of the ST-LINK has failed");
    })
}

/// Restarts at once: to wait here would keep out `SysTick`, which guards the motor, and the
/// shutter's compare.
#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    restart(ResetCause::Fault, || {
        defmt::error!("unexpected exception {=i16}", number);
    })
}
