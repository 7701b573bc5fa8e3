//! The watchdog: an NMI where the main loop has not come round for a second. [`super::fault`] resets then; the watchdog
//! does so itself a second later where even that does not run.

use super::clock::CYCLES_PER_US;
use super::registers::{WATCHDOG_CLEAR, WATCHDOG_CONTROL, WATCHDOG_LOAD, WATCHDOG_LOCK};

const PERIOD_US: u32 = 1_000_000;
const KEY: u32 = 0x1acc_e551;
const INTERRUPT_THEN_RESET: u32 = 0b11;

/// Switches it on.
pub(super) fn start() {
    unlocked(|| {
        WATCHDOG_LOAD.write(CYCLES_PER_US * PERIOD_US);
        WATCHDOG_CONTROL.write(INTERRUPT_THEN_RESET);
    });
}

/// Starts its period again.
pub(super) fn feed() {
    unlocked(|| WATCHDOG_CLEAR.write(0));
}

/// Locked between accesses, so that code that runs wild is unlikely to feed it.
fn unlocked(act: impl FnOnce()) {
    WATCHDOG_LOCK.write(KEY);
    act();
    WATCHDOG_LOCK.write(0);
}
