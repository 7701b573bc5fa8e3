//! Ranges of the quantities that describe a camera and of the settings with which it is flown.

use core::fmt;

/// Largest change of principal distance for which the correction is shown to be invertible, as a
/// fraction κ of the distance from exit pupil to image (1 mm at 100 mm: hundreds of times the depth
/// of focus).
pub const MAX_FOCUS_FRACTION: f32 = 0.01;

/// Largest number of rows by which the charge of a TDI sensor may move in one exposure.
pub const MAX_ROWS: f32 = 1024.0;

/// Defines the enum of the quantities, each with its name and its least and largest value.
macro_rules! quantities {
    ($($variant:ident = $name:literal, $least:expr, $most:expr;)+) => {
        /// A quantity of the calibration, the mechanism, the exposure or the settings of a flight
        /// that is checked on input.
        ///
        /// The name is the one of the camera file and of the documents. The order is that of the
        /// numbers on the wire: new quantities are added at the end.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[expect(missing_docs, reason = "each variant is the field of the same name")]
        pub enum Quantity {
            $($variant),+
        }

        impl Quantity {
            /// All quantities, in the order of the numbers on the wire.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The name in the camera file and in messages, with its unit.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }

            /// The allowed range, both ends included. Polynomial coefficients have no range: any
            /// finite number passes here, and the invertibility check judges the set.
            #[must_use]
            pub const fn range(self) -> (f32, f32) {
                match self {
                    $(Self::$variant => ($least, $most)),+
                }
            }
        }
    };
}

quantities! {
    PrincipalDistanceMm = "principal_distance_mm", 5.0, 5000.0;
    ExitPupilMm = "exit_pupil_mm", 1.0, 100_000.0;
    PrincipalPointX = "principal_point_mm[0]", -250.0, 250.0;
    PrincipalPointY = "principal_point_mm[1]", -250.0, 250.0;
    WidthPx = "width_px", 1.0, 100_000.0;
    HeightPx = "height_px", 1.0, 100_000.0;
    PixelUm = "pixel_um", 0.5, 100.0;
    K0 = "k0", f32::MIN, f32::MAX;
    K1 = "k1", f32::MIN, f32::MAX;
    K2 = "k2", f32::MIN, f32::MAX;
    K3 = "k3", f32::MIN, f32::MAX;
    P1 = "p1", f32::MIN, f32::MAX;
    P2 = "p2", f32::MIN, f32::MAX;
    B1 = "b1", f32::MIN, f32::MAX;
    B2 = "b2", f32::MIN, f32::MAX;
    Km0 = "km0", f32::MIN, f32::MAX;
    Km1 = "km1", f32::MIN, f32::MAX;
    Km2 = "km2", f32::MIN, f32::MAX;
    Kd1 = "kd1", f32::MIN, f32::MAX;
    Pm1 = "pm1", f32::MIN, f32::MAX;
    AccelerationMmS2 = "acceleration_mm_s2", 1.0, 1e6;
    SettlingMs = "settling_ms", 0.0, 1000.0;
    StrokeMm = "stroke_mm", 0.001, 100.0;
    FlatnessUm = "flatness_um", -1000.0, 1000.0;
    FirstTransfer = "first_transfer", 0.0, 1.0;
    TdiRows = "TDI rows per exposure", 0.0, MAX_ROWS;
    OpeningFraction = "opening_fraction", 0.0, 1.0;
    ClosingFraction = "closing_fraction", 0.0, 1.0;
    VhPerS = "vh_per_s", 0.0, 10.0;
    ExposureS = "exposure_s", 1e-6, 10.0;
    OpeningOffsetMm = "opening_offset_mm", -50.0, 50.0;
    CentroidOffsetMm = "centroid_offset_mm", -50.0, 50.0;
    TravelMm = "travel_mm", -100.0, 100.0;
    FocusShiftUm = "focus_shift_um", -100_000.0, 100_000.0;
    XMm = "x_mm", -500.0, 500.0;
    YMm = "y_mm", -500.0, 500.0;
    DxUm = "dx_um", -100_000.0, 100_000.0;
    DyUm = "dy_um", -100_000.0, 100_000.0;
    SigmaUm = "sigma_um", 1e-4, 1e4;
    ReliefPercent = "relief_percent", -100.0, 90.0;
    PitchDeg = "pitch_deg", -45.0, 45.0;
    RollDeg = "roll_deg", -45.0, 45.0;
    DriftDeg = "drift_deg", -45.0, 45.0;
    PitchRateDegS = "pitch_rate_deg_s", -60.0, 60.0;
    RollRateDegS = "roll_rate_deg_s", -60.0, 60.0;
    YawRateDegS = "yaw_rate_deg_s", -60.0, 60.0;
    JerkMmS3 = "jerk_mm_s3", 1.0, 1e12;
    MaxSpeedMmS = "max_speed_mm_s", 1e-3, 1e5;
    GroundSpeedMS = "ground_speed_m_s", 0.0, 1000.0;
    HeightAboveGroundM = "height_above_ground_m", 0.0, 100_000.0;
    AltitudeM = "altitude_m", -1000.0, 100_000.0;
    TerrainHeightM = "terrain_height_m", -1000.0, 10_000.0;
    SourcePeriodS = "source_period_s", 0.001, 3600.0;
    SourceValidityS = "source_validity_s", 0.001, 3600.0;
    SourceSlew = "source_slew", 1e-6, 1e6;
    SourceSigma = "source_sigma", 1e-6, 1e6;
    SourceFrozenS = "source_frozen_s", 0.0, 3600.0;
    DisagreementPercent = "disagreement_percent", 0.01, 100.0;
    SmearBudgetPx = "smear_budget_px", 0.01, 100.0;
    SpeedTolerancePercent = "speed_tolerance_percent", 0.01, 100.0;
    FollowingToleranceUm = "following_tolerance_um", 0.1, 10_000.0;
    JumpToleranceUm = "jump_tolerance_um", 0.01, 10_000.0;
    ShutterLatencyS = "shutter_latency_s", 0.0, 1.0;
    ShutterToleranceS = "shutter_tolerance_s", 1e-5, 0.1;
    TriggerIntervalS = "trigger_interval_s", 0.0, 3600.0;
    TimePulseSigmaS = "time_pulse_sigma_s", 0.0, 0.01;
    EncoderStepUm = "encoder_step_um", 1e-3, 100.0;
    PositionGainPerS = "position_gain_per_s", 0.0, 1e4;
    SpeedGainPerMmS = "speed_gain_per_mm_s", 0.0, 1e3;
    IntegralRatePerS = "integral_rate_per_s", 0.0, 1e4;
    SlopeWeight = "slope_weight", 0.01, 1.0;
    SpeedFeedPerMmS = "speed_feed_per_mm_s", 0.0, 10.0;
    AccelerationFeedPerMmS2 = "acceleration_feed_per_mm_s2", 0.0, 1.0;
    FrictionFeed = "friction_feed", 0.0, 1.0;
    MaxDuty = "max_duty", 0.01, 1.0;
    RestBandUm = "rest_band_um", 0.0, 1000.0;
    LearningRatePerS = "learning_rate_per_s", 0.0, 100.0;
    ReadingAgeS = "reading_age_s", 0.0, 0.01;
    DutyDelayS = "duty_delay_s", 0.0, 0.01;
    MassKg = "mass_kg", 1e-3, 100.0;
    ForceN = "force_n", 1e-3, 1e4;
    DampingNSM = "damping_n_s_m", 0.0, 1e4;
    FrictionN = "friction_n", 0.0, 1e3;
    StepsPerMm = "steps_per_mm", 1.0, 100_000.0;
    PulseRateHz = "pulse_rate_hz", 100.0, 1e6;
    MaxStepRateHz = "max_step_rate_hz", 1.0, 500_000.0;
    HomingOffsetMm = "homing_offset_mm", -100.0, 100.0;
    HomingSpeedMmS = "homing_speed_mm_s", 1e-3, 1e5;
    HomingTravelMm = "homing_travel_mm", 0.0, 200.0;
    PlayUm = "play_um", 0.0, 1000.0;
    EncoderScalePpm = "encoder_scale_ppm", 0.0, 10_000.0;
    ZeroSigmaUm = "zero_sigma_um", 0.0, 1000.0;
    ReadingAgeSigmaS = "reading_age_sigma_s", 0.0, 0.01;
    SourceLatencyS = "source_latency_s", 0.0, 5.0;
    SourceChange = "source_change", 1e-6, 1e6;
    AttitudeSigmaDeg = "attitude_sigma_deg", 0.0, 45.0;
    RateSigmaDegS = "rate_sigma_deg_s", 0.0, 60.0;
    IndexMm = "index_mm", -50.0, 50.0;
    IndexSigmaUm = "index_sigma_um", 0.0, 1000.0;
    ShortestPulseNs = "shortest_pulse_ns", 0.0, 100_000.0;
    ShortestTrackNs = "shortest_track_ns", 0.0, 100_000.0;
    ReceiverBaud = "receiver_baud", 2400.0, 1e6;
    AutopilotBaud = "autopilot_baud", 2400.0, 1e6;
    CommandTravelUm = "command_travel_um", 1.0, 100_000.0;
    CommandZero = "command_zero", -0.9, 0.9;
    MaxCommand = "max_command", 0.01, 1.0;
    LagS = "lag_s", 0.0, 0.1;
    AccelerationLagS2 = "acceleration_lag_s2", 0.0, 0.01;
    CorrectionRatePerS = "correction_rate_per_s", 0.0, 1000.0;
    MaxCorrectionUm = "max_correction_um", 0.0, 10_000.0;
    SensorZeroCounts = "sensor_zero_counts", -8e6, 8e6;
    SensorLeastCounts = "sensor_least_counts", -8e6, 8e6;
    SensorMostCounts = "sensor_most_counts", -8e6, 8e6;
    SensorNoiseUm = "sensor_noise_um", 0.0, 100.0;
    SensorFrozenS = "sensor_frozen_s", 0.0, 10.0;
    FollowingSigmaUm = "following_sigma_um", 0.0, 1000.0;
    TemperatureC = "temperature_c", -100.0, 100.0;
    FocusTableRows = "rows of the focus table", 2.0, 16.0;
}

impl Quantity {
    /// Returns `value` if it is a number inside [`Self::range`].
    ///
    /// # Errors
    /// [`OutOfRange`] with the value and the range, also for a NaN or an infinity.
    pub const fn check(self, value: f32) -> Result<f32, OutOfRange> {
        let (min, max) = self.range();
        self.check_within(value, min, max)
    }

    /// Returns `value` if it is a number in `[min, max]`, for ranges that follow from other
    /// quantities.
    ///
    /// # Errors
    /// [`OutOfRange`] with the value and the range, also for a NaN or an infinity.
    pub(crate) const fn check_within(
        self,
        value: f32,
        min: f32,
        max: f32,
    ) -> Result<f32, OutOfRange> {
        if value >= min && value <= max {
            Ok(value)
        } else {
            Err(OutOfRange {
                quantity: self,
                value,
                min,
                max,
            })
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A quantity is not a number, or lies outside its range.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OutOfRange {
    /// The quantity.
    pub quantity: Quantity,
    /// Its value, in the unit of its name.
    pub value: f32,
    /// Smallest allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            quantity,
            value,
            min,
            max,
        } = self;
        if *min <= f32::MIN && *max >= f32::MAX {
            write!(f, "{quantity} = {value} is not a finite number")
        } else {
            write!(f, "{quantity} = {value} is outside {min} to {max}")
        }
    }
}

impl core::error::Error for OutOfRange {}

/// Checks that the values of quantities are finite numbers.
///
/// # Errors
/// [`OutOfRange`] for the first that is not.
#[inline(never)]
pub(crate) fn check_finite(quantities: &[Quantity], values: &[f32]) -> Result<(), OutOfRange> {
    for (quantity, value) in quantities.iter().zip(values) {
        quantity.check_within(*value, f32::MIN, f32::MAX)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_inside_and_nan_and_infinity_are_not() {
        let (min, max) = Quantity::VhPerS.range();
        assert_eq!(Quantity::VhPerS.check(min), Ok(min));
        assert_eq!(Quantity::VhPerS.check(max), Ok(max));
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.1] {
            assert!(Quantity::VhPerS.check(bad).is_err());
        }
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(Quantity::K1.check(bad).is_err());
        }
    }
}
