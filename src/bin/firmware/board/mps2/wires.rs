//! Wires of the satellite receiver and of the autopilot: the third UART and the fourth, received by
//! interrupt into rings.

use cortex_m::{interrupt::InterruptNumber, peripheral::NVIC};
use fmc_camera::io::instruments::Wire;
use fmc_camera::io::link::deck::RigDeck;

use super::super::wire_ring::WireRing;
use super::uart::{AUTOPILOT, RECEIVER, Uart};

static FROM_RECEIVER: WireRing = WireRing::new();
static FROM_AUTOPILOT: WireRing = WireRing::new();

/// The receive interrupt of a wire's UART.
#[derive(Clone, Copy)]
pub(super) struct Receive(Wire);

// SAFETY: the numbers are those of the receive interrupts on this machine, and never change.
unsafe impl InterruptNumber for Receive {
    fn number(self) -> u16 {
        match self.0 {
            Wire::Receiver => 4,
            Wire::Autopilot => 18,
        }
    }
}

/// The wire whose UART has that receive interrupt.
pub(super) fn of_interrupt(number: i16) -> Option<Wire> {
    Wire::ALL
        .into_iter()
        .find(|wire| Receive(*wire).number().cast_signed() == number)
}

/// Switches UARTs and interrupts on.
pub(super) fn start(_: &mut NVIC) {
    for wire in Wire::ALL {
        uart(wire).start_with_interrupt();
        // SAFETY: what the interrupt shares with the main loop is the ring, and who writes to it
        // has interrupts masked.
        unsafe { NVIC::unmask(Receive(wire)) }
    }
}

/// Moves what a wire's UART holds into its ring; the interrupt. As for the link, a byte for which
/// there is no room stays in the UART.
pub(super) fn collect(wire: Wire) {
    let (uart, ring) = (uart(wire), ring(wire));
    uart.clear_interrupt();
    if uart.take_overrun() {
        ring.lose(1);
    }
    while ring.has_room()
        && let Some(byte) = uart.take()
    {
        ring.push(byte);
    }
}

/// Hands over what has come.
pub(super) fn hand_over(deck: &mut RigDeck) {
    for wire in Wire::ALL {
        let ring = ring(wire);
        while let Some(byte) = ring.pop() {
            deck.hear(wire, byte);
        }
        deck.count_lost(wire, ring.take_lost());
        if uart(wire).holds_byte() {
            // A byte that came while the ring was full makes no request any more, and would keep
            // out all others.
            cortex_m::interrupt::free(|_| collect(wire));
        }
    }
}

/// Returns `true` if nothing waits to be handed over.
pub(super) fn are_silent() -> bool {
    Wire::ALL.into_iter().all(|wire| ring(wire).is_empty())
}

const fn uart(wire: Wire) -> Uart {
    match wire {
        Wire::Receiver => RECEIVER,
        Wire::Autopilot => AUTOPILOT,
    }
}

fn ring(wire: Wire) -> &'static WireRing {
    match wire {
        Wire::Receiver => &FROM_RECEIVER,
        Wire::Autopilot => &FROM_AUTOPILOT,
    }
}
