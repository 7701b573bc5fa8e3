//! Wires of the satellite receiver and of the autopilot: USART2 and UART7, 8 data bits, no parity,
//! interrupt on reception. Nothing is sent on them.

use embassy_stm32::{
    Peri, bind_interrupts,
    gpio::{AfType, Flex, Pull},
    interrupt::typelevel::{self, Interrupt as _},
    pac::{self, usart::Usart},
    peripherals::{PD6, PE7, UART7, USART2},
    rcc,
    usart::RxPin,
};
use fmc_camera::io::instruments::Wire;

use super::super::wire_ring::WireRing;
use super::{Deck, clock};

/// Speed of the receiver's wire.
const RECEIVER_BAUD: u32 = 38_400;

/// Speed of the autopilot's wire.
const AUTOPILOT_BAUD: u32 = 57_600;

static FROM_RECEIVER: WireRing = WireRing::new();
static FROM_AUTOPILOT: WireRing = WireRing::new();

bind_interrupts!(struct Interrupts {
    USART2 => Receiver;
    UART7 => Autopilot;
});

/// Both wires, listened to.
pub(super) struct Wires {
    _pins: [Flex<'static>; 2],
}

impl Wires {
    /// Starts to receive.
    pub(super) fn start(
        _peripherals: (Peri<'static, USART2>, Peri<'static, UART7>),
        receiver: Peri<'static, PD6>,
        autopilot: Peri<'static, PE7>,
    ) -> Self {
        let functions = (
            RxPin::<USART2>::af_num(&*receiver),
            RxPin::<UART7>::af_num(&*autopilot),
        );
        let mut pins = [Flex::new(receiver), Flex::new(autopilot)];
        let [receiver, autopilot] = &mut pins;
        receiver.set_as_af_unchecked(functions.0, AfType::input(Pull::Up));
        autopilot.set_as_af_unchecked(functions.1, AfType::input(Pull::Up));
        rcc::enable_and_reset::<USART2>();
        rcc::enable_and_reset::<UART7>();
        listen(pac::USART2, const { divider(RECEIVER_BAUD) });
        listen(pac::UART7, const { divider(AUTOPILOT_BAUD) });
        // SAFETY: the handlers share nothing with other code but atomics and registers that they
        // alone use.
        unsafe {
            typelevel::USART2::enable();
            typelevel::UART7::enable();
        }
        Self { _pins: pins }
    }
}

/// Hands over what has come since the last round.
pub(super) fn hand_over(deck: &mut Deck) {
    for (wire, ring) in [
        (Wire::Receiver, &FROM_RECEIVER),
        (Wire::Autopilot, &FROM_AUTOPILOT),
    ] {
        while let Some(byte) = ring.pop() {
            deck.hear(wire, byte);
        }
        deck.count_lost(wire, ring.take_lost());
    }
}

/// The divider of the peripherals' clock nearest to a speed; both err by less than 0.1 %.
const fn divider(baud: u32) -> u16 {
    let divider = (clock::PERIPHERAL_HZ + baud / 2) / baud;
    assert!(divider >= 16 && divider <= u16::MAX as u32);
    #[expect(clippy::cast_possible_truncation, reason = "asserted")]
    let divider = divider as u16;
    divider
}

fn listen(registers: Usart, divider: u16) {
    registers.brr().write(|w| w.set_brr(divider));
    registers.cr1().write(|w| {
        w.set_fifoen(true);
        w.set_re(true);
        w.set_rxneie(true);
        w.set_ue(true);
    });
}

/// Moves what a wire has brought into its ring, up to what the ring holds: what comes on top of it
/// is lost and counted.
fn collect(wire: Usart, ring: &WireRing) {
    loop {
        let status = wire.isr().read();
        if status.ore() {
            wire.icr().write(|w| w.set_ore(true));
            ring.lose(1);
        }
        if !status.rxne() {
            break;
        }
        let [byte, _] = wire.rdr().read().dr().to_le_bytes();
        ring.push(byte);
    }
}

/// Receive interrupt of the receiver's wire.
struct Receiver;

impl typelevel::Handler<typelevel::USART2> for Receiver {
    unsafe fn on_interrupt() {
        collect(pac::USART2, &FROM_RECEIVER);
    }
}

/// Receive interrupt of the autopilot's wire.
struct Autopilot;

impl typelevel::Handler<typelevel::UART7> for Autopilot {
    unsafe fn on_interrupt() {
        collect(pac::UART7, &FROM_AUTOPILOT);
    }
}
