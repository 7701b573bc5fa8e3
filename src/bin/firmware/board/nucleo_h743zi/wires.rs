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
use fmc_camera::{flight::input_settings::InputSettings, io::instruments::Wire};

use super::super::wire_ring::WireRing;
use super::{Deck, clock};

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
        let wires = Self { _pins: pins };
        wires.set_inputs(&InputSettings::default());
        // SAFETY: the handlers share nothing with other code but atomics and registers that they
        // alone use.
        unsafe {
            typelevel::USART2::enable();
            typelevel::UART7::enable();
        }
        wires
    }

    /// Takes the speeds of the settings over. A byte that is on its way is lost.
    #[expect(clippy::unused_self, reason = "the wires must be in operation")]
    pub(super) fn set_inputs(&self, inputs: &InputSettings) {
        listen(pac::USART2, divider(inputs.receiver_baud));
        listen(pac::UART7, divider(inputs.autopilot_baud));
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

/// The divider of the peripherals' clock nearest to a speed; it errs by half of itself at most: 0.5
/// % at 1,000,000 bits/s.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "100 to 41,667 within the range of the settings"
)]
fn divider(baud: f32) -> u16 {
    (clock::PERIPHERAL_HZ as f32 / baud + 0.5) as u16
}

fn listen(registers: Usart, divider: u16) {
    // The speed can be set while the port is off.
    registers.cr1().write(|w| w.set_ue(false));
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
