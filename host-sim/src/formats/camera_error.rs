//! Errors of a camera file or of a scenario, with the place in its text.

use std::ops::Range;

use fmc_camera::geometry::calibration::{CalibrationError, Polynomial};
use fmc_camera::geometry::range::Quantity;
use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use super::number::clipped;
use crate::failure::Failure;

/// Lines longer than this, bytes, are not shown in a message.
const LONGEST_LINE: usize = 400;

/// The text of a camera file or a scenario, and what messages call it.
#[derive(Debug, Clone, Copy)]
pub(super) struct CameraText<'a> {
    file: &'a str,
    text: &'a str,
}

impl<'a> CameraText<'a> {
    pub(super) const fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, text }
    }

    /// Parses the text; unknown and missing keys, wrong types and syntax errors are named with
    /// their place.
    pub(super) fn deserialize<T: DeserializeOwned>(&self) -> Result<T, Failure> {
        toml::from_str(self.text).map_err(|error| {
            let span = error.span();
            let key = span.as_ref().and_then(|span| self.key_around(span));
            let message = match key {
                Some(key) => format!("{key}: {}", error.message()),
                None => error.message().to_owned(),
            };
            self.failure(span, &message)
        })
    }

    /// A key whose value is wrong: `fault` goes on after "key = value ".
    pub(super) fn invalid(&self, path: &[&str], fault: &str) -> Failure {
        let span = self.value_span(path);
        let key = path.join(".");
        let value = span
            .as_ref()
            .and_then(|span| self.text.get(span.clone()))
            .map_or_else(String::new, |value| format!(" = {}", clipped(value)));
        self.failure(span, &format!("{key}{value} {fault}"))
    }

    /// A calibration that the camera refuses.
    pub(super) fn invalid_calibration(&self, error: &CalibrationError) -> Failure {
        match error {
            CalibrationError::OutOfRange(range) => {
                let reason = match range.quantity {
                    Quantity::FlatnessUm => format!("a term at half the stroke: {range} µm"),
                    _ => range.to_string(),
                };
                self.invalid(key_path(range.quantity), &format!("({reason})"))
            }
            CalibrationError::Folds { polynomial, .. } => {
                let table = match polynomial {
                    Polynomial::Static => "distortion",
                    Polynomial::Fitted => "fitted",
                };
                let span = self.value_span(&[table]);
                self.failure(span, &format!("[{table}]: {error}"))
            }
        }
    }

    fn failure(&self, span: Option<Range<usize>>, message: &str) -> Failure {
        let Some(span) = span else {
            return Failure::bad_input(format!("{}: {message}", self.file));
        };
        let line = 1 + self
            .text
            .bytes()
            .take(span.start)
            .filter(|byte| *byte == b'\n')
            .count();
        let failure = Failure::bad_input(format!("{}, line {line}: {message}", self.file));
        // A line that no person wrote is not shown.
        let longest = self.text.lines().map(str::len).max().unwrap_or(0);
        if longest > LONGEST_LINE {
            failure
        } else {
            failure.at(self.file, self.text, span)
        }
    }

    fn value_span(&self, path: &[&str]) -> Option<Range<usize>> {
        let table = DeTable::parse(self.text).ok()?;
        let (first, rest) = path.split_first()?;
        let mut value = table.get_ref().get(*first)?;
        for key in rest {
            // A number is a place in an array.
            value = match key.parse::<usize>() {
                Ok(index) => value.get_ref().get(index)?,
                Err(_) => value.get_ref().get(*key)?,
            };
        }
        Some(value.span())
    }

    /// The dotted name of the innermost value that holds the span.
    fn key_around(&self, span: &Range<usize>) -> Option<String> {
        let table = DeTable::parse(self.text).ok()?;
        key_in(table.get_ref(), span)
    }
}

fn key_in(table: &DeTable<'_>, span: &Range<usize>) -> Option<String> {
    for (key, value) in table {
        let name = key.get_ref().as_ref();
        if let DeValue::Table(inner) = value.get_ref()
            && let Some(inner) = key_in(inner, span)
        {
            return Some(format!("{name}.{inner}"));
        }
        let around = value.span();
        if !matches!(value.get_ref(), DeValue::Table(_))
            && around.start <= span.start
            && span.end <= around.end
        {
            return Some(name.to_owned());
        }
    }
    None
}

/// Where a quantity stands in the camera file.
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
        Quantity::FocusShiftUm => &["focus_shift_um"],
        // Of observations, not of cameras.
        Quantity::XMm | Quantity::YMm | Quantity::DxUm | Quantity::DyUm | Quantity::SigmaUm => &[],
        // Of an exposure, in no camera file.
        Quantity::ReliefPercent
        | Quantity::PitchDeg
        | Quantity::RollDeg
        | Quantity::DriftDeg
        | Quantity::PitchRateDegS
        | Quantity::RollRateDegS
        | Quantity::YawRateDegS => &[],
        // Of the sources of V/H, in no camera file.
        Quantity::GroundSpeedMS
        | Quantity::HeightAboveGroundM
        | Quantity::AltitudeM
        | Quantity::TerrainHeightM
        | Quantity::SourcePeriodS
        | Quantity::SourceValidityS
        | Quantity::SourceSlew
        | Quantity::SourceSigma
        | Quantity::SourceFrozenS
        | Quantity::DisagreementPercent => &[],
    }
}
