//! The watchdog: an NMI where the main loop has not come round for a quarter of a second; [`super::fault`] resets then.
//!
//! It could reset by itself at the second expiry, and on a board would. Here time can jump: while the processor sleeps,
//! QEMU's follows the PC's, and a QEMU that was stopped for a second would find both expiries behind it.

use super::clock::CYCLES_PER_US;
use super::registers::{WATCHDOG_CLEAR, WATCHDOG_CONTROL, WATCHDOG_LOAD, WATCHDOG_LOCK};

const PERIOD_US: u32 = 250_000;
const KEY: u32 = 0x1acc_e551;
const INTERRUPT: u32 = 0b01;

/// Switches it on.
pub(super) fn start() {
    unlocked(|| {
        WATCHDOG_LOAD.write(CYCLES_PER_US * PERIOD_US);
        WATCHDOG_CONTROL.write(INTERRUPT);
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
