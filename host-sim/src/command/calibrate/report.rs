//! Files and text of a calibration, whatever its method.

use std::io;
use std::path::Path;

use fmc_adjustment::calibration::failure::CalibrationFailure;
use fmc_adjustment::calibration::result::CalibrationResult;
use fmc_camera_file::InputError;
use fmc_report::calibration::result::files::{self, FilesError};
use fmc_report::calibration::result::of_method::OfMethod;
use fmc_report::calibration::result::table;

use super::held_grids::{HeldGrids, add_files};
use super::{CalibratedCamera, Outputs};
use crate::cli::CalibrationFiles;
use crate::failure::Failure;
use crate::formats::output;

impl From<CalibrationFailure> for Failure {
    fn from(failure: CalibrationFailure) -> Self {
        match failure {
            CalibrationFailure::Input(error) => error.into(),
            CalibrationFailure::NotConverged { .. } => Self::check(failure.to_string()),
        }
    }
}

/// Checks the day of the calibration: it is printed as it is.
pub(super) fn check_date(args: &CalibrationFiles) -> Result<(), Failure> {
    let Some(date) = &args.date else {
        return Ok(());
    };
    let parts: Vec<&str> = date.split('-').collect();
    let number = |index: usize, digits: usize| {
        let text = parts.get(index).filter(|text| text.len() == digits)?;
        let is_number = text.bytes().all(|byte| byte.is_ascii_digit());
        is_number.then(|| text.parse::<u32>().ok()).flatten()
    };
    let is_day = parts.len() == 3
        && number(0, 4).is_some()
        && number(1, 2).is_some_and(|month| (1..=12).contains(&month))
        && number(2, 2).is_some_and(|day| (1..=31).contains(&day));
    if is_day {
        Ok(())
    } else {
        Err(Failure::bad_input(format!(
            "--date {date}: is no day; allowed: YYYY-MM-DD"
        )))
    }
}

/// Files of a calibration, and the camera file among them or what is wrong with the parameters.
pub(super) struct Prepared {
    calibrated: CalibratedCamera,
    outputs: Option<Outputs>,
}

impl Prepared {
    /// Prepares the files of a calibration; those of `--out`, if there is a folder.
    ///
    /// There is no camera file if the parameters are no usable camera: a warning of the result
    /// says why. One with residual grids that were held names copies of them.
    pub(super) fn of(
        result: &mut CalibrationResult,
        mut of_method: OfMethod,
        held: &HeldGrids,
        args: &CalibrationFiles,
        observations: &[&Path],
        folder: Option<&Path>,
    ) -> Result<Self, Failure> {
        let text = camera_text(&args.camera)?;
        let file = args.camera.display().to_string();
        let made = held.camera_file(&file, &text, &result.calibrated);
        held.state(result, &mut of_method);
        let copies = made.as_ref().map_or(&[][..], |(_, copies)| copies);
        let former = if held.is_empty() {
            Vec::new()
        } else {
            add_files(&mut of_method, copies)
        };
        let made = made.map(|(text, _)| text);
        let prepared = Self::with_camera(result, of_method, made, args, observations, folder)?;
        Ok(prepared.without(former))
    }

    /// Prepares the files of a calibration whose camera file is made already, or cannot be.
    pub(super) fn with_camera(
        result: &mut CalibrationResult,
        of_method: OfMethod,
        made: Result<String, InputError>,
        args: &CalibrationFiles,
        observations: &[&Path],
        folder: Option<&Path>,
    ) -> Result<Self, Failure> {
        let camera = args.camera.as_path();
        let calibrated = CalibratedCamera::of(made);
        if let CalibratedCamera::Unusable(error) = &calibrated {
            result
                .warnings
                .push(format!("the result is no usable camera: {error}"));
        }
        let outputs = folder
            .map(|folder| {
                let all = files::files(result, args.date.as_deref(), of_method).map_err(failed)?;
                let command = format!("calibrate {}", result.method);
                Outputs::checked(all, &calibrated, camera, observations, folder, &command)
            })
            .transpose()?;
        Ok(Self {
            calibrated,
            outputs,
        })
    }

    /// Adds names of files that a former calibration may have left, and this one does not have.
    pub(super) fn without(mut self, former: impl IntoIterator<Item = String>) -> Self {
        if let Some(outputs) = &mut self.outputs {
            outputs.former.extend(former);
        }
        self
    }

    /// Writes the files and ends the command.
    pub(super) fn write(self) -> Result<(), Failure> {
        let has_folder = self.outputs.is_some();
        self.outputs.map_or(Ok(()), Outputs::write)?;
        self.calibrated.concluded(has_folder)
    }
}

/// Reads the text of a camera file.
pub(super) fn camera_text(camera: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(camera).map_err(|error| Failure::reading(camera, &error))
}

/// Returns the failure of a file that cannot be made.
pub(super) fn failed(error: FilesError) -> Failure {
    match error {
        FilesError::Page(error) => Failure::device_or_io(format!("figure: {error}")),
        error => Failure::writing("report", &io::Error::other(error)),
    }
}

/// Prints a result with the tables of its method.
pub(super) fn print(result: &CalibrationResult, tables: &[String]) -> Result<(), Failure> {
    output::write(None, |sink| {
        sink.write_all(table::text(result).as_bytes())?;
        for table in tables {
            sink.write_all(table.as_bytes())?;
        }
        Ok(())
    })
}
