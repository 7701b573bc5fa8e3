//! The link: the first UART, received by interrupt into a ring.

use core::sync::atomic::{AtomicBool, Ordering, compiler_fence};

use cortex_m::{asm, interrupt::InterruptNumber, peripheral::NVIC};

use super::super::receive_ring::ReceiveRing;
use super::uart::LINK;
use super::wires;

/// Number of looks at the transmitter within which the last byte may leave before a reset.
const LOOKS_AT_THE_END: u32 = 100_000;

static RECEIVED: ReceiveRing = ReceiveRing::new();
static ASLEEP: AtomicBool = AtomicBool::new(false);

/// The link's receive interrupt.
#[derive(Clone, Copy)]
pub(super) struct Receive;

impl Receive {
    pub(super) const NUMBER: u16 = 0;
}

// SAFETY: the number is that of the first UART's receive interrupt on this machine, and never
// changes.
unsafe impl InterruptNumber for Receive {
    fn number(self) -> u16 {
        Self::NUMBER
    }
}

/// Switches UART and interrupt on.
pub(super) fn start(_: &mut NVIC) {
    LINK.start_with_interrupt();
    // SAFETY: the interrupt shares the ring with the main loop, and every writer has interrupts
    // masked.
    unsafe { NVIC::unmask(Receive) }
}

/// Moves the UART's bytes into the ring; called by the interrupt. If the ring is full, the byte
/// stays in the UART, which counts the bytes that overwrite it as lost. QEMU holds back bytes for
/// which the UART has no room, so that none is lost there.
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

/// Takes the next byte.
pub(super) fn receive() -> Option<u8> {
    if RECEIVED.is_empty() {
        // A byte that came before the interrupt was switched on, or stayed in the UART, makes no
        // further request, and would keep out all others.
        cortex_m::interrupt::free(|_| collect());
    }
    RECEIVED.pop()
}

/// Returns the number of bytes lost since the last call.
pub(super) fn overruns() -> u32 {
    RECEIVED.take_lost()
}

/// Transmits bytes from the start of `bytes` as far as the UART takes them now, and returns their
/// number.
pub(super) fn send(bytes: &[u8]) -> usize {
    bytes.iter().take_while(|byte| LINK.put(**byte)).count()
}

/// Sleeps until an interrupt. Interrupts are masked from the look at the rings to the sleep, which
/// a masked interrupt ends as well, so that none is missed.
pub(super) fn wait() {
    cortex_m::interrupt::free(|_| {
        if RECEIVED.is_empty() && !LINK.holds_byte() && wires::are_silent() {
            ASLEEP.store(true, Ordering::Relaxed);
            // The compiler does not know that an exception reads the flag during the sleep.
            compiler_fence(Ordering::SeqCst);
            asm::wfi();
            compiler_fence(Ordering::SeqCst);
            ASLEEP.store(false, Ordering::Relaxed);
        }
    });
}

/// Returns `true` if the main loop sleeps, as seen from an exception that is not masked.
pub(super) fn is_asleep() -> bool {
    ASLEEP.load(Ordering::Relaxed)
}

/// Waits until the last byte has left, or a while.
pub(super) fn finish() {
    let mut looks = 0..LOOKS_AT_THE_END;
    while !LINK.is_ready() && looks.next().is_some() {}
}
