//! Exposure of a row.

use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::exposure::{CorrectionModel, Exposure, FlightDirection};
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcTime;
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera::geometry::range::Quantity;
use fmc_camera_file::InputError;
use fmc_camera_file::number::{finite, single};

use super::heading::{Cells, Column};
use crate::{Exposed, FrameCamera};

/// Values of the exposures of a table whose row leaves them out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenExposure {
    /// V/H, 1/s.
    pub vh_per_s: Option<f64>,
    /// Exposure time, s.
    pub exposure_s: Option<f64>,
    /// Δδ, mm along the FMC axis; `None` leaves it to the run-up strategy.
    pub opening_offset_mm: Option<f64>,
    /// Focus shift beyond the run-out, µm.
    pub focus_shift_um: f64,
    /// Formula of the focus shift.
    pub focus_sign: FocusSign,
    /// Model of the correction.
    pub model: CorrectionModel,
    /// Direction of flight.
    pub direction: FlightDirection,
}

impl Default for GivenExposure {
    /// Nothing but the defaults of the options.
    fn default() -> Self {
        Self {
            vh_per_s: None,
            exposure_s: None,
            opening_offset_mm: None,
            focus_shift_um: 0.0,
            focus_sign: FocusSign::Physical,
            model: CorrectionModel::Exact,
            direction: FlightDirection::Forward,
        }
    }
}

impl GivenExposure {
    /// Returns the exposure of a row, as the camera predicts it.
    pub(super) fn exposed(
        &self,
        cells: &Cells<'_>,
        camera: &FrameCamera,
    ) -> Result<Exposed, InputError> {
        let exposure = self.exposure(cells)?;
        let frame = camera
            .camera()
            .frame(&exposure)
            .map_err(|error| refused(cells, &error))?;
        let frame_sigma = cells.non_negative(Column::FrameSigma)?;
        let common_sigma = cells.non_negative(Column::CommonSigma)?;
        let utc_sigma_s = cells.non_negative(Column::UtcSigma)?.unwrap_or_default();
        Ok(Exposed {
            interior: frame.interior,
            focus_sign: exposure.focus_sign,
            opened: None,
            closed: None,
            centroid: cells.whole(Column::Centroid)?.map(Time::from_us),
            centroid_utc: cells.whole(Column::CentroidUnix)?.map(|unix_us| UtcTime {
                unix_us,
                sigma_s: single(utc_sigma_s),
            }),
            sigma: (frame_sigma.is_some() || common_sigma.is_some()).then(|| PrincipalPointSigma {
                frame_mm: single(frame_sigma.unwrap_or_default()),
                common_mm: single(common_sigma.unwrap_or_default()),
            }),
        })
    }

    fn exposure(&self, cells: &Cells<'_>) -> Result<Exposure, InputError> {
        let height = cells.read(Column::Height, |text| match finite(text)? {
            height if height > 0.0 => Ok(height),
            _ => Err("not a positive number".to_owned()),
        })?;
        let vh = match (cells.number(Column::GroundSpeed)?, height) {
            (Some(speed), Some(height)) => Some(speed / height),
            (None, None) => cells.read(Column::Vh, quotient)?,
            (speed, _) => {
                let missing = if speed.is_some() {
                    "height"
                } else {
                    "ground_speed"
                };
                return Err(cells.refused(&format!("{missing} is empty")));
            }
        };
        let time = cells.read(Column::Exposure, |text| match quotient(text)? {
            seconds if seconds > 0.0 => Ok(seconds),
            _ => Err("not a positive time in seconds".to_owned()),
        })?;
        let missing = |column: &str| cells.refused(&format!("{column} is missing"));
        Ok(Exposure {
            vh_per_s: single(vh.or(self.vh_per_s).ok_or_else(|| missing("vh"))?),
            exposure_s: single(
                time.or(self.exposure_s)
                    .ok_or_else(|| missing("exposure"))?,
            ),
            opening_offset_mm: cells
                .number(Column::OpeningOffset)?
                .or(self.opening_offset_mm)
                .map(single),
            focus_shift_um: single(
                cells
                    .number(Column::FocusShift)?
                    .unwrap_or(self.focus_shift_um),
            ),
            focus_sign: cells
                .read(Column::FocusSign, focus_sign)?
                .unwrap_or(self.focus_sign),
            model: cells.read(Column::Model, model)?.unwrap_or(self.model),
            direction: cells
                .read(Column::Direction, direction)?
                .unwrap_or(self.direction),
        })
    }
}

/// Returns the error of an exposure that the camera refuses.
fn refused(cells: &Cells<'_>, error: &FrameError) -> InputError {
    let FrameError::OutOfRange(range) = error else {
        return cells.refused(&error.to_string());
    };
    let column = match range.quantity {
        Quantity::VhPerS => Column::Vh,
        Quantity::ExposureS => Column::Exposure,
        Quantity::OpeningOffsetMm => Column::OpeningOffset,
        Quantity::FocusShiftUm => Column::FocusShift,
        _ => return cells.refused(&range.to_string()),
    };
    cells.refused(&format!(
        "{} = {} is outside {} to {}",
        cells.column_name(column),
        range.value,
        range.min,
        range.max
    ))
}

/// Reads a number, or one over another such as 1/200.
fn quotient(text: &str) -> Result<f64, String> {
    let number = match text.split_once('/') {
        Some((numerator, denominator)) => finite(numerator)? / finite(denominator)?,
        None => finite(text)?,
    };
    if number.is_finite() {
        Ok(number)
    } else {
        Err("a fraction over zero".to_owned())
    }
}

fn focus_sign(text: &str) -> Result<FocusSign, String> {
    match text {
        "physical" => Ok(FocusSign::Physical),
        "printed" => Ok(FocusSign::Printed),
        _ => Err("must be physical or printed".to_owned()),
    }
}

fn model(text: &str) -> Result<CorrectionModel, String> {
    match text {
        "exact" => Ok(CorrectionModel::Exact),
        "fitted" => Ok(CorrectionModel::Fitted),
        "static" => Ok(CorrectionModel::Static),
        _ => Err("must be exact, fitted or static".to_owned()),
    }
}

fn direction(text: &str) -> Result<FlightDirection, String> {
    match text {
        "forward" => Ok(FlightDirection::Forward),
        "reverse" => Ok(FlightDirection::Reverse),
        _ => Err("must be forward or reverse".to_owned()),
    }
}
