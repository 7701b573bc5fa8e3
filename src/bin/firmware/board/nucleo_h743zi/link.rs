//! The link: USART3, 8 data bits, no parity, interrupt on reception.

use embassy_stm32::{
    Peri, bind_interrupts,
    gpio::{AfType, Flex, OutputType, Pull, Speed},
    interrupt::typelevel::{self, Interrupt as _},
    pac::{self, usart::Usart},
    peripherals::{PD8, PD9, USART3},
    rcc,
    usart::{RxPin, TxPin},
};

use super::super::receive_ring::ReceiveRing;
use super::clock;

/// Speed of the link, of the build's setting `FMC_LINK_BAUD`; `build.rs` has the usual one, whose
/// nearest divider of 100 MHz errs by 0.5 %, and which every operating system offers by name.
const BAUD: u32 = match u32::from_str_radix(env!("FMC_LINK_BAUD"), 10) {
    Ok(baud) => baud,
    Err(_) => 0,
};

/// Number of looks at the transmitter within which the last byte may leave before a reset.
const LOOKS_AT_THE_END: u32 = 100_000;

/// The nearest divider.
const DIVIDER: u16 = {
    let divider = (clock::PERIPHERAL_HZ + BAUD / 2) / BAUD;
    assert!(divider >= 16 && divider <= u16::MAX as u32);
    let exact_per_mille = clock::PERIPHERAL_HZ / divider * 1000 / BAUD;
    // A receiver bears about 3 %, of both ends together.
    assert!(exact_per_mille >= 985 && exact_per_mille <= 1015);
    divider as u16
};

/// Bytes received and not yet taken.
static RECEIVED: ReceiveRing = ReceiveRing::new();

bind_interrupts!(struct Interrupts {
    USART3 => Receiver;
});

/// The link in operation.
pub(super) struct Link {
    _pins: [Flex<'static>; 2],
    registers: Usart,
    /// Bytes received and not yet taken.
    pub(super) received: &'static ReceiveRing,
}

impl Link {
    /// Starts to receive.
    pub(super) fn start(
        _peripheral: Peri<'static, USART3>,
        transmit: Peri<'static, PD8>,
        receive: Peri<'static, PD9>,
    ) -> Self {
        let functions = (
            TxPin::<USART3>::af_num(&*transmit),
            RxPin::<USART3>::af_num(&*receive),
        );
        let mut pins = [Flex::new(transmit), Flex::new(receive)];
        let [transmit, receive] = &mut pins;
        let output = AfType::output(OutputType::PushPull, Speed::Medium);
        transmit.set_as_af_unchecked(functions.0, output);
        receive.set_as_af_unchecked(functions.1, AfType::input(Pull::Up));

        rcc::enable_and_reset::<USART3>();
        let registers = pac::USART3;
        registers.brr().write(|w| w.set_brr(DIVIDER));
        registers.cr1().write(|w| {
            w.set_fifoen(true);
            w.set_te(true);
            w.set_re(true);
            w.set_rxneie(true);
            w.set_ue(true);
        });
        // SAFETY: the handler shares with other code only atomics, and registers that it alone
        // uses.
        unsafe { typelevel::USART3::enable() };
        Self {
            _pins: pins,
            registers,
            received: &RECEIVED,
        }
    }

    /// Waits until the last byte has left, or a while: the transmitter holds 16 bytes, which take
    /// 0.2 ms.
    pub(super) fn finish(&self) {
        let mut looks = 0..LOOKS_AT_THE_END;
        while !self.registers.isr().read().tc() && looks.next().is_some() {}
    }

    /// Hands over as many bytes as the transmitter takes now, and returns how many; never waits.
    pub(super) fn send(&mut self, bytes: &[u8]) -> usize {
        let taken = bytes.iter().take_while(|&&byte| {
            let ready = self.registers.isr().read().txe();
            if ready {
                self.registers.tdr().write(|w| w.set_dr(byte.into()));
            }
            ready
        });
        taken.count()
    }
}

/// Receive interrupt.
struct Receiver;

impl typelevel::Handler<typelevel::USART3> for Receiver {
    unsafe fn on_interrupt() {
        let link = pac::USART3;
        loop {
            let status = link.isr().read();
            if status.ore() {
                link.icr().write(|w| w.set_ore(true));
                RECEIVED.lose(1);
            }
            if !status.rxne() {
                break;
            }
            let [byte, _] = link.rdr().read().dr().to_le_bytes();
            RECEIVED.push(byte);
        }
    }
}
