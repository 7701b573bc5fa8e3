//! The quantities a camera is described by, and the range in which each of them is believable.

use core::fmt;

/// A quantity of the calibration, the mechanism or the exposure that is checked on the way in.
///
/// The name is the one of the camera file and of the documents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
#[expect(missing_docs, reason = "each variant is the field of the same name")]
pub enum Quantity {
    PrincipalDistanceMm,
    ExitPupilMm,
    PrincipalPointX,
    PrincipalPointY,
    WidthPx,
    HeightPx,
    PixelUm,
    K0,
    K1,
    K2,
    K3,
    P1,
    P2,
    B1,
    B2,
    Km0,
    Km1,
    Km2,
    Kd1,
    Pm1,
    AccelerationMmS2,
    SettlingMs,
    StrokeMm,
    FlatnessUm,
    FirstTransfer,
    TdiRows,
    OpeningFraction,
    ClosingFraction,
    VhPerS,
    ExposureS,
    OpeningOffsetMm,
    CentroidOffsetMm,
    TravelMm,
    FocusShiftUm,
    XMm,
    YMm,
    DxUm,
    DyUm,
    SigmaUm,
    ReliefPercent,
    PitchDeg,
    RollDeg,
    DriftDeg,
    PitchRateDegS,
    RollRateDegS,
    YawRateDegS,
    JerkMmS3,
    MaxSpeedMmS,
    GroundSpeedMS,
    HeightAboveGroundM,
    AltitudeM,
    TerrainHeightM,
    SourcePeriodS,
    SourceValidityS,
    SourceSlew,
    SourceSigma,
    SourceFrozenS,
    DisagreementPercent,
}

/// Largest principal-distance change the correction is shown invertible for, as a fraction κ of
/// the distance from exit pupil to image (1 mm at 100 mm: hundreds of times the depth of focus).
pub const MAX_FOCUS_FRACTION: f32 = 0.01;

/// Most rows the charge of a TDI sensor may move in one exposure.
pub const MAX_ROWS: f32 = 1024.0;

impl Quantity {
    /// The name in the camera file and in messages, with its unit.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PrincipalDistanceMm => "principal_distance_mm",
            Self::ExitPupilMm => "exit_pupil_mm",
            Self::PrincipalPointX => "principal_point_mm[0]",
            Self::PrincipalPointY => "principal_point_mm[1]",
            Self::WidthPx => "width_px",
            Self::HeightPx => "height_px",
            Self::PixelUm => "pixel_um",
            Self::K0 => "k0",
            Self::K1 => "k1",
            Self::K2 => "k2",
            Self::K3 => "k3",
            Self::P1 => "p1",
            Self::P2 => "p2",
            Self::B1 => "b1",
            Self::B2 => "b2",
            Self::Km0 => "km0",
            Self::Km1 => "km1",
            Self::Km2 => "km2",
            Self::Kd1 => "kd1",
            Self::Pm1 => "pm1",
            Self::AccelerationMmS2 => "acceleration_mm_s2",
            Self::SettlingMs => "settling_ms",
            Self::StrokeMm => "stroke_mm",
            Self::FlatnessUm => "flatness_um",
            Self::FirstTransfer => "first_transfer",
            Self::TdiRows => "TDI rows per exposure",
            Self::OpeningFraction => "opening_fraction",
            Self::ClosingFraction => "closing_fraction",
            Self::VhPerS => "vh_per_s",
            Self::ExposureS => "exposure_s",
            Self::OpeningOffsetMm => "opening_offset_mm",
            Self::CentroidOffsetMm => "centroid_offset_mm",
            Self::TravelMm => "travel_mm",
            Self::FocusShiftUm => "focus_shift_um",
            Self::XMm => "x_mm",
            Self::YMm => "y_mm",
            Self::DxUm => "dx_um",
            Self::DyUm => "dy_um",
            Self::SigmaUm => "sigma_um",
            Self::ReliefPercent => "relief_percent",
            Self::PitchDeg => "pitch_deg",
            Self::RollDeg => "roll_deg",
            Self::DriftDeg => "drift_deg",
            Self::PitchRateDegS => "pitch_rate_deg_s",
            Self::RollRateDegS => "roll_rate_deg_s",
            Self::YawRateDegS => "yaw_rate_deg_s",
            Self::JerkMmS3 => "jerk_mm_s3",
            Self::MaxSpeedMmS => "max_speed_mm_s",
            Self::GroundSpeedMS => "ground_speed_m_s",
            Self::HeightAboveGroundM => "height_above_ground_m",
            Self::AltitudeM => "altitude_m",
            Self::TerrainHeightM => "terrain_height_m",
            Self::SourcePeriodS => "source_period_s",
            Self::SourceValidityS => "source_validity_s",
            Self::SourceSlew => "source_slew",
            Self::SourceSigma => "source_sigma",
            Self::SourceFrozenS => "source_frozen_s",
            Self::DisagreementPercent => "disagreement_percent",
        }
    }

    /// The believable range, both ends included. Polynomial coefficients have none of their own:
    /// any finite number passes here and the invertibility check judges the set.
    #[must_use]
    pub const fn range(self) -> (f32, f32) {
        match self {
            Self::PrincipalDistanceMm => (5.0, 5000.0),
            Self::ExitPupilMm => (1.0, 100_000.0),
            Self::PrincipalPointX | Self::PrincipalPointY => (-250.0, 250.0),
            Self::WidthPx | Self::HeightPx => (1.0, 100_000.0),
            Self::PixelUm => (0.5, 100.0),
            Self::AccelerationMmS2 => (1.0, 1e6),
            Self::SettlingMs => (0.0, 1000.0),
            Self::StrokeMm => (0.001, 100.0),
            Self::FlatnessUm => (-1000.0, 1000.0),
            Self::FirstTransfer | Self::OpeningFraction | Self::ClosingFraction => (0.0, 1.0),
            Self::TdiRows => (0.0, MAX_ROWS),
            Self::VhPerS => (0.0, 10.0),
            Self::ExposureS => (1e-6, 10.0),
            Self::OpeningOffsetMm | Self::CentroidOffsetMm => (-50.0, 50.0),
            Self::TravelMm => (-100.0, 100.0),
            Self::FocusShiftUm => (-100_000.0, 100_000.0),
            Self::XMm | Self::YMm => (-500.0, 500.0),
            Self::DxUm | Self::DyUm => (-100_000.0, 100_000.0),
            Self::SigmaUm => (1e-4, 1e4),
            Self::ReliefPercent => (-100.0, 90.0),
            Self::PitchDeg | Self::RollDeg | Self::DriftDeg => (-45.0, 45.0),
            Self::PitchRateDegS | Self::RollRateDegS | Self::YawRateDegS => (-60.0, 60.0),
            Self::JerkMmS3 => (1.0, 1e12),
            Self::MaxSpeedMmS => (1e-3, 1e5),
            Self::GroundSpeedMS => (0.0, 1000.0),
            Self::HeightAboveGroundM => (0.0, 100_000.0),
            Self::AltitudeM => (-1000.0, 100_000.0),
            Self::TerrainHeightM => (-1000.0, 10_000.0),
            Self::SourcePeriodS | Self::SourceValidityS => (0.001, 3600.0),
            Self::SourceSlew | Self::SourceSigma => (1e-6, 1e6),
            Self::SourceFrozenS => (0.0, 3600.0),
            Self::DisagreementPercent => (0.01, 100.0),
            Self::K0
            | Self::K1
            | Self::K2
            | Self::K3
            | Self::P1
            | Self::P2
            | Self::B1
            | Self::B2
            | Self::Km0
            | Self::Km1
            | Self::Km2
            | Self::Kd1
            | Self::Pm1 => (f32::MIN, f32::MAX),
        }
    }

    /// `value`, if it is a number inside [`Self::range`].
    ///
    /// # Errors
    /// [`OutOfRange`] with the value and the range; a NaN or an infinity is never inside.
    pub const fn check(self, value: f32) -> Result<f32, OutOfRange> {
        let (min, max) = self.range();
        self.check_within(value, min, max)
    }

    /// `value`, if it is a number in `[min, max]`: for ranges that follow from other quantities.
    ///
    /// # Errors
    /// [`OutOfRange`] with the value and the range; a NaN or an infinity is never inside.
    pub const fn check_within(self, value: f32, min: f32, max: f32) -> Result<f32, OutOfRange> {
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
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct OutOfRange {
    /// Which quantity.
    pub quantity: Quantity,
    /// What it was, in the unit of its name.
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
