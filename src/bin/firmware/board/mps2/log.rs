//! The log: defmt's frames on the second UART.

use core::cell::{Cell, UnsafeCell};

use critical_section::RestoreState;
use defmt::Encoder;

use super::{clock, uart::LOG};

/// How long a byte may wait for the transmitter, in looks at it. A reader that is missing costs this once; then bytes
/// are dropped until the transmitter is free again, and the decoder goes on with the next whole frame.
const LOOKS: u32 = 10_000;

defmt::timestamp!("{=u32:us}", clock::now_us());

/// Switches the UART on.
pub(super) fn start() {
    LOG.start();
}

#[defmt::global_logger]
struct Logger;

struct State {
    encoder: UnsafeCell<Encoder>,
    restore: Cell<RestoreState>,
    stalled: Cell<bool>,
}

// SAFETY: used only between `acquire` and `release`, with interrupts masked. NMI and faults are not masked; where
// their handlers log they do not return, so that what they interrupted does not go on with a state that they changed.
unsafe impl Sync for State {}

static STATE: State = State {
    encoder: UnsafeCell::new(Encoder::new()),
    restore: Cell::new(RestoreState::invalid()),
    stalled: Cell::new(false),
};

// SAFETY: `acquire` masks interrupts, `release` ends that; one core, so nobody else is between the two.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: released in `release`, which defmt calls after every `acquire`.
        STATE.restore.set(unsafe { critical_section::acquire() });
        encode(|encoder| encoder.start_frame(transmit));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        encode(|encoder| encoder.end_frame(transmit));
        // SAFETY: the state is that of the `acquire` before.
        unsafe { critical_section::release(STATE.restore.get()) }
    }

    unsafe fn write(bytes: &[u8]) {
        encode(|encoder| encoder.write(bytes, transmit));
    }
}

fn encode(act: impl FnOnce(&mut Encoder)) {
    // SAFETY: between `acquire` and `release`, and neither encoder nor `transmit` logs: the only reference.
    act(unsafe { &mut *STATE.encoder.get() });
}

fn transmit(bytes: &[u8]) {
    for &byte in bytes {
        let mut looks = 0..if STATE.stalled.get() { 1 } else { LOOKS };
        STATE.stalled.set(!looks.any(|_| LOG.put(byte)));
    }
}
