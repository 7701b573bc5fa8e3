//! Pins of mechanism, shutter, trigger and time pulse: named and reserved, not driven yet.

use embassy_stm32::{
    Peri,
    peripherals::{
        PA0, PB3, PB10, PB11, PB15, PC6, PC8, PC9, PC10, PD12, PD13, PE9, PE10, PE12, TIM1, TIM2,
        TIM3, TIM4,
    },
    timer::{Ch1, Ch2, Ch3, Ch4, GeneralInstance4Channel, TimerChannel, TimerPin},
};

/// One pin for each signal; `docs/board.md` says where each comes out.
#[expect(dead_code, reason = "reserved for the drive")]
pub(super) struct DrivePins {
    /// Encoder track A.
    pub(super) encoder_a: Peri<'static, PD12>,
    /// Encoder track B.
    pub(super) encoder_b: Peri<'static, PD13>,
    /// Speed of a motor that is driven by pulse width.
    pub(super) motor_pwm: Peri<'static, PE9>,
    /// Its direction.
    pub(super) motor_direction: Peri<'static, PE10>,
    /// Power stage on.
    pub(super) motor_enable: Peri<'static, PE12>,
    /// Steps of a motor that is driven by steps.
    pub(super) step: Peri<'static, PC6>,
    /// Their direction.
    pub(super) step_direction: Peri<'static, PB15>,
    /// Limit switch at the negative end of the travel.
    pub(super) limit_low: Peri<'static, PC8>,
    /// Limit switch at the positive end.
    pub(super) limit_high: Peri<'static, PC9>,
    /// Opens the shutter.
    pub(super) shutter_command: Peri<'static, PC10>,
    /// Request for an exposure.
    pub(super) trigger: Peri<'static, PA0>,
    /// Pulse per second of the navigation receiver.
    pub(super) time_pulse: Peri<'static, PB3>,
    /// Shutter sensor, opening edge.
    pub(super) shutter_opened: Peri<'static, PB10>,
    /// Shutter sensor, closing edge.
    pub(super) shutter_closed: Peri<'static, PB11>,
}

/// Compiles only if the chip connects the pin to this channel of the timer.
const fn connected<Pin: TimerPin<T, C>, T: GeneralInstance4Channel, C: TimerChannel>() {}

const _: () = {
    connected::<PD12, TIM4, Ch1>();
    connected::<PD13, TIM4, Ch2>();
    connected::<PE9, TIM1, Ch1>();
    connected::<PC6, TIM3, Ch1>();
    connected::<PA0, TIM2, Ch1>();
    connected::<PB3, TIM2, Ch2>();
    connected::<PB10, TIM2, Ch3>();
    connected::<PB11, TIM2, Ch4>();
};
