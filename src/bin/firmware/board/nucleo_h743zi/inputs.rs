//! Lines that the control loop reads: limit switches, and the processor's own monitor of its
//! supply.

use embassy_stm32::{
    Peri,
    gpio::{Input, Pull},
    pac,
    peripherals::{PC8, PC9},
};
use fmc_camera::flight::input_levels::InputLevels;

use super::line::Line;

/// Switches that open at the ends of the travel, between line and ground: a broken wire also counts
/// as an end.
const LIMIT_LOW: Line = Line::new(pac::GPIOC, 8);
const LIMIT_HIGH: Line = Line::new(pac::GPIOC, 9);

/// The monitor's threshold, PLS of the manual RM0433: 2.85 V of the 3.3 V.
const THRESHOLD: u8 = 0b110;

/// The lines in operation.
pub(super) struct Inputs {
    _switches: [Input<'static>; 2],
}

impl Inputs {
    /// Switches the monitor on.
    pub(super) fn start(limit_low: Peri<'static, PC8>, limit_high: Peri<'static, PC9>) -> Self {
        pac::PWR.cr1().modify(|w| {
            w.set_pls(THRESHOLD);
            w.set_pvde(true);
        });
        Self {
            _switches: [
                Input::new(limit_low, Pull::Up),
                Input::new(limit_high, Pull::Up),
            ],
        }
    }
}

/// Returns the present levels.
pub(super) fn levels() -> InputLevels {
    InputLevels {
        limit_low: LIMIT_LOW.is_high(),
        limit_high: LIMIT_HIGH.is_high(),
        supply_low: pac::PWR.csr1().read().pvdo(),
    }
}
