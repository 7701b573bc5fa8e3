//! The independent watchdog, with the interval that it has after a reset: 0.5 s.

use embassy_stm32::pac::{self, iwdg::vals::Key};

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
