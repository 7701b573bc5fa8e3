//! Pins of a stepper: named and reserved, not driven yet.

use embassy_stm32::{
    Peri,
    peripherals::{PB15, PC6, TIM3},
    timer::{Ch1, GeneralInstance4Channel, TimerChannel, TimerPin},
};

/// One pin for each signal; `docs/board.md` has their connectors.
#[expect(dead_code, reason = "reserved for a stepper")]
pub(super) struct StepPins {
    /// Steps.
    pub(super) step: Peri<'static, PC6>,
    /// Their direction.
    pub(super) step_direction: Peri<'static, PB15>,
}

/// Compiles only if the chip connects the pin to this channel of the timer.
const fn connected<Pin: TimerPin<T, C>, T: GeneralInstance4Channel, C: TimerChannel>() {}

const _: () = connected::<PC6, TIM3, Ch1>();
