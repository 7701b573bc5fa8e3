//! Observations with the motion in their exposures.

use fmc_camera::flight::camera::{Camera, FrameError};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, InputError};
use fmc_reference::exposure::{ExposurePath, ExposureRequest};
use fmc_reference::lens::Lens;

use crate::observation::{ObservationRow, ObservationTable};

/// An observation of one point of one exposure, in double precision.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Row of the file.
    pub row: ObservationRow,
    /// δ, mm.
    pub travel_mm: f64,
    /// c̄, mm.
    pub centroid_mm: f64,
    /// δ or c̄, by which the coefficients are multiplied, mm.
    pub regressor_mm: f64,
}

impl Measurement {
    /// Returns the observation in the form of the adjustment.
    #[must_use]
    pub fn observation(&self) -> Observation<f64> {
        let [x_mm, y_mm] = self.row.point_mm;
        let [dx_mm, dy_mm] = self.row.distortion_mm;
        Observation {
            x_mm,
            y_mm,
            dx_mm,
            dy_mm,
            regressor_mm: self.regressor_mm,
            sigma_mm: self.row.sigma_mm,
        }
    }
}

/// Returns the measurements of a table.
///
/// # Errors
/// [`InputError`] that names file, line, column, value and allowed range of the first exposure that
/// the camera cannot take.
pub fn measurements(
    table: &ObservationTable,
    camera: &CameraFile,
    validated: &Camera,
    regressor: Regressor,
) -> Result<Vec<Measurement>, InputError> {
    table
        .rows
        .iter()
        .map(|row| {
            let exposure = Exposure {
                opening_offset_mm: Some(single(row.opening_offset_mm)),
                ..Exposure::new(single(row.vh_per_s), single(row.exposure_s))
            };
            validated
                .motion(&exposure)
                .map_err(|error| exposure_failure(&table.file, row, &error))?;
            let path = ExposurePath::new(
                camera,
                &ExposureRequest {
                    opening_offset_mm: Some(row.opening_offset_mm),
                    ..ExposureRequest::planned(row.vh_per_s, row.exposure_s)
                },
            );
            Ok(Measurement {
                row: row.clone(),
                travel_mm: path.travel_mm,
                centroid_mm: path.centroid_mm(),
                regressor_mm: match regressor {
                    Regressor::Travel => path.travel_mm,
                    Regressor::Centroid => path.centroid_mm(),
                },
            })
        })
        .collect()
}

fn exposure_failure(file: &str, row: &ObservationRow, error: &FrameError) -> InputError {
    let place = format!("{file}, line {}", row.line);
    match error {
        FrameError::OutOfRange(range) => {
            InputError::invalid(format!("{place}: {range} (the camera's)"))
        }
        FrameError::Speed { .. } => InputError::invalid(format!(
            "{place}: vh_per_s = {}: {error} (max_speed_mm_s of the camera)",
            row.vh_per_s
        )),
        _ => InputError::invalid(format!(
            "{place}: opening_offset_mm = {} with vh_per_s = {} and exposure_s = {}: {error} (stroke_mm of the camera)",
            row.opening_offset_mm, row.vh_per_s, row.exposure_s
        )),
    }
}

/// Returns the static calibration of a camera file, in double precision.
#[must_use]
pub fn known_lens(camera: &CameraFile) -> KnownLens<f64> {
    let lens = Lens::of(camera);
    let [half_x, half_y] = camera.half_format_mm();
    let [x0, y0] = camera.principal_point_mm;
    KnownLens {
        principal_point_mm: camera.principal_point_mm,
        k: lens.k,
        p: lens.p,
        b: lens.b,
        axis: camera.fmc.axis.into(),
        radius_mm: (half_x + x0.abs()).hypot(half_y + y0.abs()),
    }
}
