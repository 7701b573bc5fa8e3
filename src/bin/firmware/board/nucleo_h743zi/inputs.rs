//! Lines that the control loop reads: limit switches, and the processor's own monitor of its
//! supply.

use embassy_stm32::{
    Peri,
    gpio::{Input, Pull},
    pac::{self, gpio::Gpio, timer::vals::FilterValue},
    peripherals::{PC8, PC9},
};
use fmc_camera::flight::{
    bring_up::LineLevels,
    input_filter::filter_code,
    input_levels::InputLevels,
    input_settings::{InputSettings, LimitLevel},
};

use super::{clock, force, line::Line};

/// Switches between line and ground.
const LIMIT_LOW: Line = Line::new(pac::GPIOC, 8);
const LIMIT_HIGH: Line = Line::new(pac::GPIOC, 9);

/// The monitor's threshold, PLS of the manual RM0433: 2.85 V of the 3.3 V.
const THRESHOLD: u8 = 0b110;

/// The lines in operation.
pub(super) struct Inputs {
    _switches: [Input<'static>; 2],
    at_end: LimitLevel,
}

impl Inputs {
    /// Switches the monitor on, which takes the force off by itself, as a lock-up of the processor
    /// does.
    pub(super) fn start(limit_low: Peri<'static, PC8>, limit_high: Peri<'static, PC9>) -> Self {
        pac::PWR.cr1().modify(|w| {
            w.set_pls(THRESHOLD);
            w.set_pvde(true);
        });
        force::connect_protections();
        Self {
            _switches: [
                Input::new(limit_low, Pull::Up),
                Input::new(limit_high, Pull::Up),
            ],
            at_end: LimitLevel::High,
        }
    }

    /// Takes the settings of the switches over.
    pub(super) fn set_inputs(&mut self, inputs: &InputSettings) {
        self.at_end = inputs.limit_switch;
    }

    /// Returns the present levels. The supply also counts as low if it has been so since the last
    /// call, as the force has gone off.
    pub(super) fn levels(&self) -> InputLevels {
        let is_end = |line: Line| line.is_high() == (self.at_end == LimitLevel::High);
        InputLevels {
            limit_low: is_end(LIMIT_LOW),
            limit_high: is_end(LIMIT_HIGH),
            supply_low: force::take_supply_break() || pac::PWR.csr1().read().pvdo(),
        }
    }
}

/// Returns the levels of all lines, those of the timers as well.
pub(super) fn lines() -> LineLevels {
    let port = |port: Gpio| {
        let levels = port.idr().read().0;
        move |line: u32| levels.wrapping_shr(line) & 1 != 0
    };
    let [port_a, port_b, port_c, port_d, port_e] =
        [pac::GPIOA, pac::GPIOB, pac::GPIOC, pac::GPIOD, pac::GPIOE].map(port);
    LineLevels {
        trigger: port_a(0),
        time_pulse: port_b(3),
        shutter_opened: port_b(10),
        shutter_closed: port_b(11),
        index: port_d(14),
        encoder_a: port_d(12),
        encoder_b: port_d(13),
        limit_low: port_c(8),
        limit_high: port_c(9),
        brake: port_e(15),
    }
}

/// Returns the filter of a timer's input for the shortest pulse that counts, ns.
pub(super) fn filter_of(shortest_ns: f32) -> FilterValue {
    FilterValue::from_bits(filter_code(shortest_ns, clock::TIMER_MHZ))
}
