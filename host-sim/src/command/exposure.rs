//! The exposure that several commands take as arguments.

use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::exposure::{CorrectionModel, Exposure, FlightDirection};
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera::geometry::range::{OutOfRange, Quantity};
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, GridFiles};
use fmc_reference::exposure::{ExposureRequest, FocusFormula};

use crate::cli::{DirectionName, ExposureArgs, FocusSignName, ModelName};
use crate::device::DeviceError;
use crate::failure::{Failure, note};

impl ExposureArgs {
    /// Reads the camera file with its residual grids, and prints a note on every option that has no
    /// effect on this camera.
    ///
    /// # Errors
    /// [`Failure`] of the camera file or of a grid, or for the fitted model of a camera without
    /// one.
    pub(super) fn read_camera_with_grids(&self) -> Result<(CameraFile, GridFiles), Failure> {
        let (camera, grids) = super::read_camera_with_grids(&self.camera)?;
        self.check(&camera)?;
        Ok((camera, grids))
    }

    /// Checks that the camera has the model, and prints the notes.
    fn check(&self, camera: &CameraFile) -> Result<(), Failure> {
        if self.model == ModelName::Fitted && camera.fitted.is_none() {
            return Err(Failure::bad_input(format!(
                "{}: --model fitted needs a [fitted] table, and there is none",
                self.camera.display()
            )));
        }
        super::note_unused_strategy(&self.camera, camera);
        if self.model != ModelName::Exact && self.focus_shift_um != 0.0 {
            note(format_args!(
                "note: --focus-shift-um has no effect on the coordinates with --model static or fitted"
            ));
        }
        Ok(())
    }

    /// Exposure that the camera is asked for.
    pub(super) fn exposure(&self) -> Exposure {
        Exposure {
            vh_per_s: single(self.vh.per_s()),
            exposure_s: single(self.exposure_s()),
            opening_offset_mm: self.opening_offset_mm.map(single),
            focus_shift_um: single(self.focus_shift_um),
            focus_sign: match self.focus_sign {
                FocusSignName::Physical => FocusSign::Physical,
                FocusSignName::Printed => FocusSign::Printed,
            },
            model: match self.model {
                ModelName::Exact => CorrectionModel::Exact,
                ModelName::Fitted => CorrectionModel::Fitted,
                ModelName::Static => CorrectionModel::Static,
            },
            direction: self.direction(),
        }
    }

    /// Exposure time, s.
    fn exposure_s(&self) -> f64 {
        // It is missing only where frames stand for it, and then it is not asked for.
        self.exposure.unwrap_or(f64::NAN)
    }

    /// Direction of flight.
    pub(super) const fn direction(&self) -> FlightDirection {
        match self.direction {
            DirectionName::Forward => FlightDirection::Forward,
            DirectionName::Reverse => FlightDirection::Reverse,
        }
    }

    /// Exposure that the reference is asked for.
    pub(super) fn request(&self) -> ExposureRequest {
        ExposureRequest {
            vh_per_s: self.vh.per_s(),
            exposure_s: self.exposure_s(),
            opening_offset_mm: self.opening_offset_mm,
            focus_shift_mm: self.focus_shift_um / 1000.0,
            focus_formula: match self.focus_sign {
                FocusSignName::Physical => FocusFormula::Physical,
                FocusSignName::Printed => FocusFormula::Printed,
            },
            direction: self.direction(),
        }
    }

    /// Turns a refusal of the camera into a failure, with the option or the key that caused it.
    pub(super) fn refused(&self, camera: &CameraFile, error: &DeviceError) -> Failure {
        let file = self.camera.display();
        match error {
            DeviceError::Frame(FrameError::OutOfRange(range)) => {
                let (option, origin) = match range.quantity {
                    Quantity::VhPerS | Quantity::ExposureS => {
                        return self.outside_limits(camera, range);
                    }
                    Quantity::OpeningOffsetMm => ("--opening-offset-mm", "stroke_mm of "),
                    Quantity::TdiRows => ("--vh and --exposure", ""),
                    Quantity::FocusShiftUm => (
                        "--focus-shift-um with the run-out",
                        "1 % of the distances of ",
                    ),
                    _ => return Failure::bad_input(format!("{range} ({file})")),
                };
                Failure::bad_input(format!("{option}: {range} ({origin}{file})"))
            }
            DeviceError::Frame(error @ FrameError::Stroke(_)) => Failure::bad_input(format!(
                "{file}: [fmc] stroke_mm is too short for {} --exposure {}: {error}",
                self.vh,
                self.exposure_s()
            )),
            DeviceError::Frame(error @ FrameError::Speed { .. }) => Failure::bad_input(format!(
                "{file}: [fmc] max_speed_mm_s is too small for {}: {error}",
                self.vh
            )),
            DeviceError::Frame(_)
            | DeviceError::Calibration(_)
            | DeviceError::Grids(_)
            | DeviceError::NoGrids
            | DeviceError::PolynomialMesh => Failure::bad_input(format!("{file}: {error}")),
            _ => error.clone().into(),
        }
    }

    /// Returns the failure of a V/H or an exposure time outside the camera's limits.
    fn outside_limits(&self, camera: &CameraFile, range: &OutOfRange) -> Failure {
        let OutOfRange {
            quantity,
            value,
            min,
            max,
        } = range;
        let origin = camera.limits.origin(*quantity, &self.camera.display());
        let fault = match quantity {
            Quantity::VhPerS => {
                format!(
                    "{}: V/H {value} is outside {min} to {max} 1/s",
                    self.vh.names()
                )
            }
            _ if camera.limits.is_exposure_default() => format!(
                "--exposure: {value} s is outside 1/{} to 1/{} s",
                min.recip().round(),
                max.recip().round()
            ),
            _ => format!("--exposure: {value} s is outside {min} to {max} s"),
        };
        Failure::bad_input(format!("{fault} ({origin})"))
    }
}
