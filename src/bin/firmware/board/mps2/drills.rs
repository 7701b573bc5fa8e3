//! Accidents on request, for tests: bytes on the log's UART.

use core::{
    hint::black_box,
    sync::atomic::{AtomicBool, Ordering},
};

use cortex_m::asm;

use super::{clock, uart::LOG};

/// The next tick's interrupt is to overflow the stack.
static IN_INTERRUPT: AtomicBool = AtomicBool::new(false);

/// Carries out the request of a byte, if there is one.
pub(super) fn run() {
    match LOG.take() {
        Some(b'f') => asm::udf(),
        Some(b'h') => loop {
            asm::nop();
        },
        Some(b'i') => IN_INTERRUPT.store(true, Ordering::Relaxed),
        Some(b'o') => overflow(0),
        // The tick that wakes the main loop stops.
        Some(b's') => clock::stop_tick(),
        _ => {}
    }
}

/// Carries out the request of an accident in an interrupt, in which it is called.
pub(super) fn run_in_interrupt() {
    if IN_INTERRUPT.load(Ordering::Relaxed) {
        overflow(0);
    }
}

/// Calls itself until the stack is full. The check of the stack finds this circle of calls.
#[inline(never)]
#[expect(unconditional_recursion, reason = "the overflow is the purpose")]
fn overflow(depth: u32) {
    let frame = black_box([depth; 8]);
    overflow(depth.wrapping_add(1));
    black_box(frame);
}
