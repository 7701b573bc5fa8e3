//! Interrupts, from the instruction that requests one to the one after it. The core's own work on
//! entry and exit (12 cycles each on a Cortex-M4) consists of no instructions, and the registers of
//! the device depend on the board.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cortex_m::asm;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use fmc_camera::flight::ring::Ring;

use crate::counter::Counter;
use crate::receive_ring::ReceiveRing;

const TIMES: u32 = 100;

static RECEIVED: ReceiveRing = ReceiveRing::new();
static EDGES: Ring<u32, 128> = Ring::new();
static SERVED: AtomicU32 = AtomicU32::new(0);
/// `true` if the next interrupt is an edge, `false` if it is a byte.
static IS_EDGE: AtomicBool = AtomicBool::new(false);

/// An interrupt that no device of the machine requests.
#[derive(Clone, Copy)]
struct Spare;

// SAFETY: the number is below the 32 that every emulated core has.
unsafe impl InterruptNumber for Spare {
    fn number(self) -> u16 {
        31
    }
}

/// Handles a byte or an edge.
#[exception]
unsafe fn DefaultHandler(_: i16) {
    if IS_EDGE.load(Ordering::Relaxed) {
        EDGES.push(1000);
    } else {
        RECEIVED.push(0x55);
    }
    SERVED.fetch_add(1, Ordering::Relaxed);
}

/// Requests the interrupt, and returns after it.
fn interrupt() {
    NVIC::pend(Spare);
    asm::dsb();
    asm::isb();
}

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    // SAFETY: the data that the interrupt shares are atomic.
    unsafe { NVIC::unmask(Spare) };
    for (kernel, unit, is_edge) in [
        ("interrupt_receive", "byte", false),
        ("interrupt_capture", "edge", true),
    ] {
        SERVED.store(0, Ordering::Relaxed);
        IS_EDGE.store(is_edge, Ordering::Relaxed);
        counter.count(kernel, (TIMES, unit), || {
            for _ in 0..TIMES {
                interrupt();
            }
            (SERVED.load(Ordering::Relaxed) == TIMES).then_some(())
        })?;
    }
    NVIC::mask(Spare);
    counter.count("receive_ring_pop", (TIMES, "byte"), || {
        (0..TIMES).try_for_each(|_| RECEIVED.pop().map(drop))
    })?;
    counter.count("stamp_ring_pop", (TIMES, "edge"), || {
        (0..TIMES).try_for_each(|_| EDGES.pop().map(drop))
    })?;
    if EDGES.take_lost() > 0 {
        return None;
    }
    (RECEIVED.is_empty() && RECEIVED.has_room() && RECEIVED.take_lost() == 0).then_some(())
}
