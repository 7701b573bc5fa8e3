//! The log: defmt's frames, encoded here for every board, which transports their bytes.

use core::cell::{Cell, UnsafeCell};

use critical_section::RestoreState;
use defmt::Encoder;

use super::chosen;

defmt::timestamp!("{=u32:us}", chosen::now_us());

#[defmt::global_logger]
struct Logger;

struct State {
    encoder: UnsafeCell<Encoder>,
    restore: Cell<RestoreState>,
}

// SAFETY: used only between `acquire` and `release`, with interrupts masked. NMI and faults are not
// masked; if their handlers log, they do not return, so that the code they interrupted does not go
// on with a state that they changed.
unsafe impl Sync for State {}

static STATE: State = State {
    encoder: UnsafeCell::new(Encoder::new()),
    restore: Cell::new(RestoreState::invalid()),
};

// SAFETY: `acquire` masks interrupts, `release` ends that; there is one core, so no other code runs
// between the two.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: released in `release`, which defmt calls after every `acquire`.
        STATE.restore.set(unsafe { critical_section::acquire() });
        encode(|encoder| encoder.start_frame(chosen::carry_log));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        encode(|encoder| encoder.end_frame(chosen::carry_log));
        // SAFETY: the state is that of the `acquire` before.
        unsafe { critical_section::release(STATE.restore.get()) }
    }

    unsafe fn write(bytes: &[u8]) {
        encode(|encoder| encoder.write(bytes, chosen::carry_log));
    }
}

fn encode(act: impl FnOnce(&mut Encoder)) {
    // SAFETY: between `acquire` and `release`, and neither encoder nor board logs: the only
    // reference.
    act(unsafe { &mut *STATE.encoder.get() });
}
