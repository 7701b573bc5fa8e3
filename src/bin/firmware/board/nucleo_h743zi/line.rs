//! Single lines of the ports, operated from interrupts as well as from the main loop.

use core::convert::Infallible;

use embassy_stm32::{
    Peri,
    gpio::{AfType, Flex},
    pac::gpio::{Gpio, regs::Bsrr},
    timer::{GeneralInstance4Channel, TimerChannel, TimerPin},
};
use embedded_hal::digital::{ErrorType, OutputPin};

/// A line of a port that has been set up as input or output.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    port: Gpio,
    number: u8,
}

impl Line {
    /// Returns the line of a port with this number, below 16.
    pub(super) const fn new(port: Gpio, number: u8) -> Self {
        Self { port, number }
    }

    /// Sets an output by one store, which no interrupt can divide.
    pub(super) fn set(self, is_high: bool) {
        let half = if is_high { 0 } else { 16 };
        self.port
            .bsrr()
            .write_value(Bsrr(1_u32.wrapping_shl(u32::from(self.number) + half)));
    }

    /// Pulls an input up, or down.
    pub(super) fn pull(self, up: bool) {
        let place = 2 * u32::from(self.number);
        let pull: u32 = if up { 0b01 } else { 0b10 };
        self.port.pupdr().modify(|w| {
            w.0 = w.0 & !0b11_u32.wrapping_shl(place) | pull.wrapping_shl(place);
        });
    }

    /// Reads an input.
    pub(super) fn is_high(self) -> bool {
        self.port
            .idr()
            .read()
            .0
            .wrapping_shr(u32::from(self.number))
            & 1
            != 0
    }
}

impl ErrorType for Line {
    type Error = Infallible;
}

impl OutputPin for Line {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}

/// Gives a pin to a channel of a timer; compiles only if the chip connects the two.
pub(super) fn attach<Pin, Instance, Channel>(
    pin: Peri<'static, Pin>,
    function: AfType,
) -> Flex<'static>
where
    Pin: TimerPin<Instance, Channel>,
    Instance: GeneralInstance4Channel,
    Channel: TimerChannel,
{
    let number = TimerPin::<Instance, Channel>::af_num(&*pin);
    let mut pin = Flex::new(pin);
    pin.set_as_af_unchecked(number, function);
    pin
}
