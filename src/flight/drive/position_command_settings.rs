//! Settings of an analogue position command and of its absolute sensor.

use crate::geometry::range::{OutOfRange, Quantity};

/// Largest part of the command's limit at which the calibrated position may lie.
const LARGEST_ZERO: f32 = 0.9;

/// Settings of an amplifier that follows a position, and of the sensor that shows the position.
///
/// Scale, sign and age of the sensor's readings and the delay of the command are those of
/// [`DriveSettings`](super::settings::DriveSettings).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PositionCommandSettings {
    /// Travel of the stage from command 0 to command 1, in the middle of its hysteresis, µm.
    pub command_travel_um: f32,
    /// Command at the calibrated position, -1 to 1.
    pub command_zero: f32,
    /// Largest command to either side, 0 to 1.
    pub max_command: f32,
    /// Time by which the stage lags behind its command at constant speed, s: 2ζ/ω of a stage with
    /// resonance ω and damping ratio ζ.
    pub lag_s: f32,
    /// Distance by which it lags under acceleration, in parts of the acceleration, s²: 1/ω².
    pub acceleration_lag_s2: f32,
    /// Rate at which the correction takes over what the command leaves of the following error, 1/s.
    pub correction_rate_per_s: f32,
    /// Largest correction, µm: hysteresis, creep and scale of the command.
    pub max_correction_um: f32,
    /// Reading of the sensor at the calibrated position, counts.
    pub sensor_zero_counts: f32,
    /// Smallest and largest reading of a sensor that works, counts: beyond, it is saturated or its
    /// wire is broken.
    pub sensor_least_counts: f32,
    /// See [`Self::sensor_least_counts`].
    pub sensor_most_counts: f32,
    /// σ of one reading, µm.
    pub sensor_noise_um: f32,
    /// Time after which an unchanged reading is that of a sensor that has failed, s; 0: never, for
    /// a sensor whose noise does not reach a count.
    pub sensor_frozen_s: f32,
}

impl Default for PositionCommandSettings {
    /// A voice coil of ±2.5 mm under an amplifier without lag, with a sensor of 16 bits.
    fn default() -> Self {
        Self {
            command_travel_um: 2500.0,
            command_zero: 0.0,
            max_command: 1.0,
            lag_s: 0.0,
            acceleration_lag_s2: 0.0,
            correction_rate_per_s: 60.0,
            max_correction_um: 100.0,
            sensor_zero_counts: 0.0,
            sensor_least_counts: -32_000.0,
            sensor_most_counts: 32_000.0,
            sensor_noise_um: 0.05,
            sensor_frozen_s: 0.1,
        }
    }
}

impl PositionCommandSettings {
    /// Settings that exclude nothing, for a mechanism with an absolute sensor whose implementation
    /// of [`FmcDrive`](super::FmcDrive) has settings of its own: all but the noise.
    pub const UNUSED: Self = Self {
        command_travel_um: 100_000.0,
        command_zero: 0.0,
        max_command: 1.0,
        lag_s: 0.0,
        acceleration_lag_s2: 0.0,
        correction_rate_per_s: 0.0,
        max_correction_um: 0.0,
        sensor_zero_counts: 0.0,
        sensor_least_counts: -8e6,
        sensor_most_counts: 8e6,
        sensor_noise_um: 0.05,
        sensor_frozen_s: 0.0,
    };

    /// Returns the settings, if each is in its range.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        Quantity::CommandTravelUm.check(self.command_travel_um)?;
        let most = Quantity::MaxCommand.check(self.max_command)?;
        let largest = LARGEST_ZERO * most;
        Quantity::CommandZero.check_within(self.command_zero, -largest, largest)?;
        Quantity::LagS.check(self.lag_s)?;
        Quantity::AccelerationLagS2.check(self.acceleration_lag_s2)?;
        Quantity::CorrectionRatePerS.check(self.correction_rate_per_s)?;
        Quantity::MaxCorrectionUm.check(self.max_correction_um)?;
        Quantity::SensorZeroCounts.check(self.sensor_zero_counts)?;
        Quantity::SensorLeastCounts.check(self.sensor_least_counts)?;
        Quantity::SensorMostCounts.check(self.sensor_most_counts)?;
        Quantity::SensorNoiseUm.check(self.sensor_noise_um)?;
        Quantity::SensorFrozenS.check(self.sensor_frozen_s)?;
        Ok(self)
    }

    /// Checks that command and sensor reach both ends of a stroke, with steps of the sensor in µm.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the travel of the command or the zero of the sensor.
    pub(crate) fn check_reach(&self, half_stroke_um: f32, step_um: f32) -> Result<(), OutOfRange> {
        let free = self.max_command - libm::fabsf(self.command_zero);
        let (_, most_um) = Quantity::CommandTravelUm.range();
        let least_um = half_stroke_um / free;
        Quantity::CommandTravelUm.check_within(self.command_travel_um, least_um, most_um)?;
        let half = half_stroke_um / step_um;
        let [least, most] = [
            self.sensor_least_counts + half,
            self.sensor_most_counts - half,
        ];
        Quantity::SensorZeroCounts.check_within(self.sensor_zero_counts, least, most)?;
        Ok(())
    }
}
