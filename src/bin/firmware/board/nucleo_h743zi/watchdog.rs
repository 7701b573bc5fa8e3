//! The independent watchdog, with the interval that it has after a reset: 0.5 s.

use embassy_stm32::pac::{self, iwdg::vals::Key};

/// Its interval: 4096 periods of the 32 kHz oscillator divided by 4, ms. A tenth more is allowed
/// for an oscillator that is slow.
const INTERVAL_MS: u32 = 4096 * 4 / 32;
const LONGEST_INTERVAL_MS: u32 = INTERVAL_MS + INTERVAL_MS / 10;

/// Longest time from the last round that is kept until it bites, ms. It is fed until rounds are
/// overdue; the last one may have begun as late, and may not have come to its end.
pub(super) const BITES_WITHIN_MS: u32 = LONGEST_INTERVAL_MS + super::ROUNDS_WITHIN_MS;

/// Starts it, before any step that could wait for ever. It stands still while a debugger holds the
/// processor.
pub(super) fn start() {
    pac::DBGMCU.apb4fzr1().modify(|w| w.set_iwdg1(true));
    pac::IWDG1.kr().write(|w| w.set_key(Key::START));
}

/// Keeps it from resetting the board for another interval.
pub(super) fn feed() {
    pac::IWDG1.kr().write(|w| w.set_key(Key::RESET));
}
