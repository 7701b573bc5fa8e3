//! Accidents on request, for tests: bytes on the log's UART.

use cortex_m::asm;

use super::uart::LOG;

/// What a byte asks for.
pub(super) fn run() {
    match LOG.take() {
        Some(b'f') => asm::udf(),
        Some(b'h') => loop {
            asm::nop();
        },
        _ => {}
    }
}
