//! Errors of a calibration that the camera refuses, at their place in the camera file.

use fmc_camera::geometry::calibration::{CalibrationError, Polynomial};
use fmc_camera::geometry::range::Quantity;

use crate::input_error::InputError;
use crate::toml_text::TomlText;

/// Creates the error of a calibration that the camera refuses.
pub(crate) fn invalid_calibration(text: &TomlText, error: &CalibrationError) -> InputError {
    match error {
        CalibrationError::OutOfRange(range) => {
            let reason = match range.quantity {
                Quantity::FlatnessUm => format!("a term at half the stroke: {range} µm"),
                _ => range.to_string(),
            };
            text.invalid(key_path(range.quantity), &format!("({reason})"))
        }
        CalibrationError::Folds { polynomial, .. } => {
            let table = match polynomial {
                Polynomial::Static => "distortion",
                Polynomial::Fitted => "fitted",
            };
            text.invalid_table(table, &error.to_string())
        }
    }
}

/// Returns the path of a quantity in the camera file.
const fn key_path(quantity: Quantity) -> &'static [&'static str] {
    match quantity {
        Quantity::PrincipalDistanceMm => &["principal_distance_mm"],
        Quantity::ExitPupilMm => &["exit_pupil_mm"],
        Quantity::PrincipalPointX | Quantity::PrincipalPointY => &["principal_point_mm"],
        Quantity::WidthPx => &["sensor", "width_px"],
        Quantity::HeightPx => &["sensor", "height_px"],
        Quantity::PixelUm => &["sensor", "pixel_um"],
        Quantity::K0 => &["distortion", "k0"],
        Quantity::K1 => &["distortion", "k1"],
        Quantity::K2 => &["distortion", "k2"],
        Quantity::K3 => &["distortion", "k3"],
        Quantity::P1 => &["distortion", "p1"],
        Quantity::P2 => &["distortion", "p2"],
        Quantity::B1 => &["distortion", "b1"],
        Quantity::B2 => &["distortion", "b2"],
        Quantity::Km0 => &["fitted", "km0"],
        Quantity::Km1 => &["fitted", "km1"],
        Quantity::Km2 => &["fitted", "km2"],
        Quantity::Kd1 => &["fitted", "kd1"],
        Quantity::Pm1 => &["fitted", "pm1"],
        Quantity::AccelerationMmS2 => &["fmc", "acceleration_mm_s2"],
        Quantity::SettlingMs => &["fmc", "settling_ms"],
        Quantity::JerkMmS3 => &["fmc", "jerk_mm_s3"],
        Quantity::MaxSpeedMmS => &["fmc", "max_speed_mm_s"],
        Quantity::StrokeMm => &["fmc", "stroke_mm"],
        Quantity::FlatnessUm => &["fmc", "flatness_um"],
        Quantity::FirstTransfer | Quantity::TdiRows => &["fmc", "first_transfer"],
        Quantity::OpeningFraction => &["shutter", "opening_fraction"],
        Quantity::ClosingFraction => &["shutter", "closing_fraction"],
        Quantity::VhPerS => &["limits", "vh_per_s"],
        Quantity::ExposureS => &["limits", "exposure_s"],
        Quantity::OpeningOffsetMm | Quantity::CentroidOffsetMm | Quantity::TravelMm => {
            &["fmc", "stroke_mm"]
        }
        Quantity::FocusShiftUm => &["focus", "focus_shift_um"],
        Quantity::TemperatureC | Quantity::FocusTableRows => &["focus", "temperature_c"],
        // Of observations, exposures, sources of V/H and settings of a flight: in no camera file.
        _ => &[],
    }
}
