//! Accidents on request, for tests: bytes on the log's UART.

use cortex_m::asm;

use super::{clock, uart::LOG};

/// Carries out the request of a byte, if there is one.
pub(super) fn run() {
    match LOG.take() {
        Some(b'f') => asm::udf(),
        Some(b'h') => loop {
            asm::nop();
        },
        // The tick that wakes the main loop stops.
        Some(b's') => clock::stop_tick(),
        _ => {}
    }
}
