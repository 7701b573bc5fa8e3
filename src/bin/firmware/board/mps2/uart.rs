//! A CMSDK APB UART: one byte each way, no FIFO.

use super::registers::{AUTOPILOT_UART, LINK_UART, LOG_UART, RECEIVER_UART, UartRegisters};

const TRANSMITTER_FULL: u32 = 1;
const RECEIVER_FULL: u32 = 1 << 1;
const RECEIVER_OVERRUN: u32 = 1 << 3;
const ENABLE_BOTH_WAYS: u32 = 0b11;
const ENABLE_RECEIVE_INTERRUPT: u32 = 1 << 3;
const RECEIVE_INTERRUPT: u32 = 1 << 1;
/// The smallest divisor that the UART accepts; QEMU transmits at once with any.
const BAUD_DIVISOR: u32 = 16;

/// Carries requests and answers.
pub(super) const LINK: Uart = Uart(LINK_UART);
/// Carries the log.
pub(super) const LOG: Uart = Uart(LOG_UART);
/// Carries the satellite receiver's sentences.
pub(super) const RECEIVER: Uart = Uart(RECEIVER_UART);
/// Carries the autopilot's messages.
pub(super) const AUTOPILOT: Uart = Uart(AUTOPILOT_UART);

/// A UART.
#[derive(Clone, Copy)]
pub(super) struct Uart(UartRegisters);

impl Uart {
    /// Switches it on.
    pub(super) fn start(self) {
        self.0.baud_divisor.write(BAUD_DIVISOR);
        self.0.control.write(ENABLE_BOTH_WAYS);
    }

    /// Switches it on with an interrupt for every byte received.
    pub(super) fn start_with_interrupt(self) {
        self.0.baud_divisor.write(BAUD_DIVISOR);
        self.0
            .control
            .write(ENABLE_BOTH_WAYS | ENABLE_RECEIVE_INTERRUPT);
    }

    /// Takes the byte received, if there is one.
    pub(super) fn take(self) -> Option<u8> {
        let [byte, ..] = self
            .holds_byte()
            .then(|| self.0.data.read().to_le_bytes())?;
        Some(byte)
    }

    /// Returns `true` if a byte has been received.
    pub(super) fn holds_byte(self) -> bool {
        self.0.state.read() & RECEIVER_FULL != 0
    }

    /// Returns `true` if a byte was lost because the one before it had not been taken, once per
    /// loss.
    pub(super) fn take_overrun(self) -> bool {
        let overrun = self.0.state.read() & RECEIVER_OVERRUN != 0;
        if overrun {
            self.0.state.write(RECEIVER_OVERRUN);
        }
        overrun
    }

    /// Ends the interrupt's request; a byte that arrives afterwards makes a new one.
    pub(super) fn clear_interrupt(self) {
        self.0.interrupts.write(RECEIVE_INTERRUPT);
    }

    /// Returns `true` if the transmitter takes a byte now.
    pub(super) fn is_ready(self) -> bool {
        self.0.state.read() & TRANSMITTER_FULL == 0
    }

    /// Transmits a byte; returns `false` if the transmitter is still busy with the one before.
    pub(super) fn put(self, byte: u8) -> bool {
        let ready = self.is_ready();
        if ready {
            self.0.data.write(u32::from(byte));
        }
        ready
    }
}
