//! Interrupts, from the instruction that asks for one to the one after it. What the core itself does on the way in and
//! out (12 cycles each on a Cortex-M4) is no instruction, and the registers of the device are the board's.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::asm;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;

use crate::counter::Counter;
use crate::receive_ring::ReceiveRing;

const BYTES: u32 = 100;

static RECEIVED: ReceiveRing = ReceiveRing::new();
static SERVED: AtomicU32 = AtomicU32::new(0);

/// An interrupt that no device of the machine asks for.
#[derive(Clone, Copy)]
struct Spare;

// SAFETY: the number is below the 32 that every emulated core has.
unsafe impl InterruptNumber for Spare {
    fn number(self) -> u16 {
        31
    }
}

/// A byte has come.
#[exception]
unsafe fn DefaultHandler(_: i16) {
    RECEIVED.push(0x55);
    SERVED.fetch_add(1, Ordering::Relaxed);
}

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    // SAFETY: what the interrupt shares is atomic.
    unsafe { NVIC::unmask(Spare) };
    counter.count("interrupt_receive", (BYTES, "byte"), || {
        for _ in 0..BYTES {
            NVIC::pend(Spare);
            asm::dsb();
            asm::isb();
        }
        (SERVED.load(Ordering::Relaxed) == BYTES).then_some(())
    })?;
    NVIC::mask(Spare);
    counter.count("receive_ring_pop", (BYTES, "byte"), || {
        (0..BYTES).try_for_each(|_| RECEIVED.pop().map(drop))
    })?;
    (RECEIVED.is_empty() && RECEIVED.has_room() && RECEIVED.take_lost() == 0).then_some(())
}
