//! Lens whose focus follows its temperature, and the thermometer that tells the camera.

use fmc_camera_file::number::single;

use super::clock::{Clocked, microseconds, seconds};
use super::file::TemperatureTable;
use super::scenario::MissionScenario;

/// Temperature at which the polynomial of the focus shift has its origin, °C.
const ORIGIN_C: f64 = 20.0;

/// Temperature and focus of the lens.
#[derive(Debug, Clone)]
pub(super) struct Lens {
    /// `None` for a lens that keeps its focus.
    table: Option<TemperatureTable>,
    run_out_um: [f64; 4],
}

impl Lens {
    /// Creates the lens of a scenario.
    pub(super) fn of(scenario: &MissionScenario) -> Self {
        Self {
            table: scenario.written.temperature.clone(),
            run_out_um: scenario.written.detector.run_out_um,
        }
    }

    /// Temperature at a time, °C; `None` for a lens that keeps its focus.
    pub(super) fn celsius(&self, time_s: f64) -> Option<f64> {
        let table = self.table.as_ref()?;
        Some(table.start_c + table.rate_c_per_s * time_s)
    }

    /// Δz of the detector at a time and an offset of the stage, mm, positive away from the lens.
    pub(super) fn focus_shift_mm(&self, time_s: f64, offset_mm: f64) -> f64 {
        let run_out_um = polynomial(&self.run_out_um, offset_mm);
        let focus_um = match (&self.table, self.celsius(time_s)) {
            (Some(table), Some(celsius)) => polynomial(&table.focus_shift_um, celsius - ORIGIN_C),
            _ => 0.0,
        };
        (run_out_um + focus_um) / 1000.0
    }
}

/// Returns the value of a polynomial, lowest power first.
fn polynomial(coefficients: &[f64], at: f64) -> f64 {
    coefficients
        .iter()
        .rev()
        .fold(0.0, |value, coefficient| value * at + coefficient)
}

/// Thermometer at the lens, on a line to the camera.
#[derive(Debug, Clone)]
pub(super) struct Thermometer {
    lens: Lens,
    clock: Option<Clocked>,
}

impl Thermometer {
    /// Creates the thermometer of a scenario.
    pub(super) fn of(scenario: &MissionScenario) -> Self {
        let table = scenario.written.temperature.as_ref();
        let told_every_s = table.map_or(0.0, |table| table.told_every_s);
        Self {
            lens: Lens::of(scenario),
            clock: (told_every_s > 0.0).then(|| Clocked {
                period_us: microseconds(told_every_s),
                // After the camera has been armed.
                next_us: 300_000,
            }),
        }
    }

    /// Returns the temperature that is told by a time, °C; `None` between two of them.
    pub(super) fn told(&mut self, to_us: u64) -> Option<f32> {
        let clock = self.clock.as_mut()?;
        if clock.next_us > to_us {
            return None;
        }
        let celsius = self.lens.celsius(seconds(clock.next_us));
        clock.next_us += clock.period_us;
        celsius.map(single)
    }
}
