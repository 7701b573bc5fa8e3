//! Transport of the log: the second UART.

use core::sync::atomic::{AtomicBool, Ordering};

use super::uart::LOG;

/// Number of looks at the transmitter for which a byte may wait. A missing reader costs this wait
/// once; then bytes are dropped until the transmitter is free again, and the decoder goes on with
/// the next whole frame.
const LOOKS: u32 = 10_000;

static STALLED: AtomicBool = AtomicBool::new(false);

/// Switches the UART on.
pub(super) fn start() {
    LOG.start();
}

/// Transmits bytes, or drops them.
pub(in super::super) fn carry_log(bytes: &[u8]) {
    for &byte in bytes {
        let stalled = STALLED.load(Ordering::Relaxed);
        let mut looks = 0..if stalled { 1 } else { LOOKS };
        STALLED.store(!looks.any(|_| LOG.put(byte)), Ordering::Relaxed);
    }
}
