//! The link: the first UART, received by interrupt into a ring.

use core::sync::atomic::{AtomicBool, Ordering, compiler_fence};

use cortex_m::{asm, interrupt::InterruptNumber, peripheral::NVIC};

use super::super::receive_ring::ReceiveRing;
use super::uart::LINK;

/// How long the last byte may take to leave before a reset, in looks at the transmitter.
const LOOKS_AT_THE_END: u32 = 100_000;

static RECEIVED: ReceiveRing = ReceiveRing::new();
static ASLEEP: AtomicBool = AtomicBool::new(false);

/// The link's receive interrupt.
#[derive(Clone, Copy)]
pub(super) struct Receive;

impl Receive {
    pub(super) const NUMBER: u16 = 0;
}

// SAFETY: the number is that of the first UART's receive interrupt on this machine, and never changes.
unsafe impl InterruptNumber for Receive {
    fn number(self) -> u16 {
        Self::NUMBER
    }
}

/// Switches UART and interrupt on.
pub(super) fn start(_: &mut NVIC) {
    LINK.start_with_interrupt();
    // SAFETY: what the interrupt shares with the main loop is the ring, and who writes to it has interrupts masked.
    unsafe { NVIC::unmask(Receive) }
}

/// Moves what the UART holds into the ring; the interrupt. Where the ring is full, the byte stays in the UART, which
/// counts as lost what comes on top of it; QEMU keeps back what the UART has no room for, so that nothing is lost
/// there.
pub(super) fn collect() {
    LINK.clear_interrupt();
    if LINK.take_overrun() {
        RECEIVED.lose(1);
    }
    while RECEIVED.has_room()
        && let Some(byte) = LINK.take()
    {
        RECEIVED.push(byte);
    }
}

/// The next byte.
pub(super) fn receive() -> Option<u8> {
    if RECEIVED.is_empty() {
        // A byte that came before the interrupt was switched on, or stayed in the UART, makes no request any more, and
        // would keep out all others.
        cortex_m::interrupt::free(|_| collect());
    }
    RECEIVED.pop()
}

/// Bytes lost since asked last.
pub(super) fn overruns() -> u32 {
    RECEIVED.take_lost()
}

/// Transmits from the start of `bytes` what the UART takes now, and says how many that were.
pub(super) fn send(bytes: &[u8]) -> usize {
    bytes.iter().take_while(|byte| LINK.put(**byte)).count()
}

/// Sleeps until an interrupt. Interrupts are masked from the look at the ring to the sleep, which ends by a masked
/// one as well: none is slept through.
pub(super) fn wait() {
    cortex_m::interrupt::free(|_| {
        if RECEIVED.is_empty() && !LINK.holds_byte() {
            ASLEEP.store(true, Ordering::Relaxed);
            // The compiler does not know that an exception looks at the flag while this sleeps.
            compiler_fence(Ordering::SeqCst);
            asm::wfi();
            compiler_fence(Ordering::SeqCst);
            ASLEEP.store(false, Ordering::Relaxed);
        }
    });
}

/// Whether the main loop sleeps, as seen from an exception that is not masked.
pub(super) fn is_asleep() -> bool {
    ASLEEP.load(Ordering::Relaxed)
}

/// Waits until the last byte has left, or a while.
pub(super) fn finish() {
    let mut looks = 0..LOOKS_AT_THE_END;
    while !LINK.is_ready() && looks.next().is_some() {}
}
