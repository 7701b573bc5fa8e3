//! The motor: TIM1 makes the pulse width and the enable, a line sets the direction, and TIM4 counts
//! the encoder and latches its count at the index mark.

use core::convert::Infallible;

use embassy_stm32::{
    Peri,
    gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed},
    pac::{
        self,
        timer::{
            regs::SrGp16,
            vals::{CcmrInputCcs, CcmrOutputCcs, FilterValue, OcmGp, Sms},
        },
    },
    peripherals::{PD12, PD13, PD14, PE9, PE10, PE12, PE15, TIM1, TIM4},
    rcc,
    timer::{Ch1, Ch2, Ch3},
};
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use fmc_camera::flight::{
    drive::{
        MAX_LATCHES,
        enabled_drive::EnabledDrive,
        pwm_encoder::{Pins, PwmEncoder},
        quadrature::{QuadratureCounter, WideCount},
    },
    event::ShutterEdge,
    input_settings::{Edge, InputSettings},
};
use heapless::Vec;

use super::{
    force::{Enable, ForcePins},
    inputs::filter_of,
    latches::Latched,
    line::{Line, attach},
};

/// Steps of the pulse width: 200 MHz over 20 kHz, which is inaudible.
const FULL_DUTY: u16 = 10_000;

/// Low is positive duty.
const DIRECTION: Line = Line::new(pac::GPIOE, 10);

/// The index mark, where its pull is set.
const INDEX_LINE: Line = Line::new(pac::GPIOD, 14);

/// The drive of the library's camera.
pub(crate) type Drive = EnabledDrive<PwmEncoder<MotorPwm, Line, Encoder>, Enable>;

/// Returns the drive, without force, with the default settings.
pub(super) fn drive() -> Drive {
    let pins = Pins {
        pwm: MotorPwm,
        direction: DIRECTION,
        counter: Encoder {
            count: WideCount::new(),
            latched: Latched::default(),
        },
    };
    EnabledDrive::new(PwmEncoder::unprepared(pins), Enable::new())
}

/// The pins of the motor.
pub(super) struct MotorPins {
    pub(super) pwm: Peri<'static, PE9>,
    pub(super) direction: Peri<'static, PE10>,
    pub(super) enable: Peri<'static, PE12>,
    pub(super) brake: Peri<'static, PE15>,
    pub(super) encoder_a: Peri<'static, PD12>,
    pub(super) encoder_b: Peri<'static, PD13>,
    pub(super) index: Peri<'static, PD14>,
}

/// Pins and timers in operation.
pub(super) struct Motor {
    _direction: Output<'static>,
    force: ForcePins,
    _timed: [Flex<'static>; 4],
}

impl Motor {
    /// Starts both timers; there is no force.
    pub(super) fn start(
        _timers: (Peri<'static, TIM1>, Peri<'static, TIM4>),
        pins: MotorPins,
    ) -> Self {
        rcc::enable_and_reset::<TIM1>();
        rcc::enable_and_reset::<TIM4>();
        start_pulses();
        start_encoder();
        let pulses = AfType::output(OutputType::PushPull, Speed::Medium);
        let tracks = AfType::input(Pull::Up);
        let mark = AfType::input(Pull::Down);
        Self {
            _direction: Output::new(pins.direction, Level::Low, Speed::Low),
            force: ForcePins::start(pins.enable, pins.brake),
            _timed: [
                attach::<_, TIM1, Ch1>(pins.pwm, pulses),
                attach::<_, TIM4, Ch1>(pins.encoder_a, tracks),
                attach::<_, TIM4, Ch2>(pins.encoder_b, tracks),
                attach::<_, TIM4, Ch3>(pins.index, mark),
            ],
        }
    }

    /// Takes the settings of brake, encoder and index mark over.
    pub(super) fn set_inputs(&mut self, inputs: &InputSettings) {
        let pulses = filter_of(inputs.shortest_pulse_ns);
        self.force.set_brake(inputs.brake, pulses.to_bits());
        let is_falling = inputs.index == Edge::Falling;
        INDEX_LINE.pull(is_falling);
        let timer = pac::TIM4;
        timer.ccer().modify(|w| w.set_cce(INDEX, false));
        let tracks = filter_of(inputs.shortest_track_ns);
        timer.ccmr_input(0).modify(|w| {
            for track in 0..2 {
                w.set_icf(track, tracks);
            }
        });
        timer
            .ccmr_input(INDEX / 2)
            .modify(|w| w.set_icf(INDEX % 2, pulses));
        timer.ccer().modify(|w| w.set_ccp(INDEX, is_falling));
        timer.sr().write_value(SrGp16(0));
        timer.ccer().modify(|w| w.set_cce(INDEX, true));
    }
}

/// Starts the pulses, edge-aligned, from duty 0. The timer stops, and its output is low, while a
/// debugger holds the processor.
fn start_pulses() {
    let timer = pac::TIM1;
    pac::DBGMCU.apb2fzr1().modify(|w| w.set_tim1(true));
    timer.psc().write_value(0);
    timer.arr().write(|w| w.set_arr(FULL_DUTY - 1));
    timer.ccr(0).write(|w| w.set_ccr(0));
    timer.ccmr_output(0).modify(|w| {
        w.set_ccs(0, CcmrOutputCcs::OUTPUT);
        w.set_ocm(0, OcmGp::PWM_MODE1);
        // A new width acts at once: 0 must end the pulse before the direction changes.
        w.set_ocpe(0, false);
    });
    timer.ccer().modify(|w| w.set_cce(0, true));
    timer.egr().write(|w| w.set_ug(true));
    timer.cr1().modify(|w| w.set_cen(true));
}

/// Channel of TIM4 that latches the count at the rising edge of the index mark.
const INDEX: usize = 2;

/// Counts every edge of both tracks; 8 samples at 200 MHz reject pulses shorter than 40 ns.
fn start_encoder() {
    let timer = pac::TIM4;
    timer.arr().write(|w| w.set_arr(u16::MAX));
    timer.ccmr_input(0).modify(|w| {
        for track in 0..2 {
            w.set_ccs(track, CcmrInputCcs::TI4);
            w.set_icf(track, FilterValue::FCK_INT_N8);
        }
    });
    timer.ccmr_input(INDEX / 2).modify(|w| {
        w.set_ccs(INDEX % 2, CcmrInputCcs::TI4);
        w.set_icf(INDEX % 2, FilterValue::FCK_INT_N8);
    });
    timer.ccer().modify(|w| w.set_cce(INDEX, true));
    timer.smcr().modify(|w| w.set_sms(Sms::ENCODER_MODE_3));
    timer.cr1().modify(|w| w.set_cen(true));
}

/// Channel 1 of TIM1.
pub(crate) struct MotorPwm;

impl ErrorType for MotorPwm {
    type Error = Infallible;
}

impl SetDutyCycle for MotorPwm {
    fn max_duty_cycle(&self) -> u16 {
        FULL_DUTY
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        pac::TIM1.ccr(0).write(|w| w.set_ccr(duty));
        Ok(())
    }
}

/// The count of TIM4, which the control loop reads every millisecond.
pub(crate) struct Encoder {
    count: WideCount,
    latched: Latched,
}

impl QuadratureCounter for Encoder {
    fn count(&mut self) -> i32 {
        let count = self.count.extend(pac::TIM4.cnt().read().cnt());
        self.latched.look();
        count
    }

    fn take_index(&mut self) -> Option<i32> {
        let status = pac::TIM4.sr().read();
        if !status.ccif(INDEX) {
            return None;
        }
        // Reading the register clears its flag.
        let latched = pac::TIM4.ccr(INDEX).read().ccr();
        if status.ccof(INDEX) {
            // A sensor that bounces has latched again: the first edge is lost.
            let mut overrun = SrGp16(u32::MAX);
            overrun.set_ccof(INDEX, false);
            pac::TIM4.sr().write_value(overrun);
            return None;
        }
        Some(self.count.near(latched))
    }

    fn take_latched(&mut self, edge: ShutterEdge) -> Option<i32> {
        let latched = self.latched.take(edge)?;
        Some(self.count.near(latched))
    }

    fn take_latches(&mut self) -> Vec<(f32, i32), MAX_LATCHES> {
        let mut counts = Vec::new();
        for (age_s, latched) in self.latched.between() {
            let _ = counts.push((age_s, self.count.near(latched)));
        }
        counts
    }
}
