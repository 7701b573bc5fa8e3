//! Stage on flexures that follows an analogue position command: piezo or voice coil, with the
//! amplifier's own loop.

use std::f64::consts::TAU;

use serde::Deserialize;

/// A stage that follows a position command, in place of motor and screw.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PositionStage {
    /// Travel from command 0 to command 1, µm.
    pub travel_um: f64,
    /// Excess of the true travel, of which the camera does not know, per cent.
    pub travel_error_percent: f64,
    /// Resonance, Hz.
    pub resonance_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Width of the widest loop of the hysteresis, per cent of the travel.
    pub hysteresis_percent: f64,
    /// Creep after a step, per cent of it.
    pub creep_percent: f64,
    /// σ of one reading of the sensor, µm.
    pub sensor_noise_um: f64,
}

impl Default for PositionStage {
    /// A voice coil of ±2.5 mm with an LVDT.
    fn default() -> Self {
        Self {
            travel_um: 2500.0,
            travel_error_percent: 0.0,
            resonance_hz: 100.0,
            damping_ratio: 0.7,
            hysteresis_percent: 0.0,
            creep_percent: 0.0,
            sensor_noise_um: 0.05,
        }
    }
}

impl PositionStage {
    /// Each number with its name, its least and its largest value.
    pub(super) const fn ranges(&self) -> [(&'static str, f64, f64, f64); 7] {
        [
            ("position_stage.travel_um", self.travel_um, 1.0, 1e5),
            (
                "position_stage.travel_error_percent",
                self.travel_error_percent,
                -50.0,
                50.0,
            ),
            (
                "position_stage.resonance_hz",
                self.resonance_hz,
                20.0,
                5000.0,
            ),
            (
                "position_stage.damping_ratio",
                self.damping_ratio,
                0.01,
                2.0,
            ),
            (
                "position_stage.hysteresis_percent",
                self.hysteresis_percent,
                0.0,
                20.0,
            ),
            (
                "position_stage.creep_percent",
                self.creep_percent,
                0.0,
                20.0,
            ),
            (
                "position_stage.sensor_noise_um",
                self.sensor_noise_um,
                0.0,
                100.0,
            ),
        ]
    }

    /// Time by which the stage lags behind its command at constant speed, s.
    #[must_use]
    pub fn lag_s(&self) -> f64 {
        2.0 * self.damping_ratio / (TAU * self.resonance_hz)
    }

    /// Distance by which it lags under acceleration, in parts of the acceleration, s².
    #[must_use]
    pub fn acceleration_lag_s2(&self) -> f64 {
        (TAU * self.resonance_hz).powi(-2)
    }
}
