//! The watchdog: an NMI if the main loop has not come round for a quarter of a second;
//! [`super::fault`] resets then.
//!
//! It could reset by itself at the second expiry, and on a board would. In QEMU time can jump:
//! while the processor sleeps, QEMU's time follows the PC's, and after a stop of a second both
//! expiries would have passed.

use super::clock::CYCLES_PER_US;
use super::registers::{WATCHDOG_CLEAR, WATCHDOG_CONTROL, WATCHDOG_LOAD, WATCHDOG_LOCK};

const PERIOD_US: u32 = 250_000;

/// Longest time from the last byte that the main loop took until the reset, ms: one expiry is
/// forgiven.
pub(super) const BITES_WITHIN_MS: u32 = 2 * PERIOD_US / 1000 + 1;
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

/// Unlocks the registers for `act` alone: they are locked between accesses, so that code that runs
/// wild is unlikely to feed the watchdog.
fn unlocked(act: impl FnOnce()) {
    WATCHDOG_LOCK.write(KEY);
    act();
    WATCHDOG_LOCK.write(0);
}
