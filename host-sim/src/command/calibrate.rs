//! `calibrate`: parameters of a camera from observations.

pub(super) mod angles;
pub(super) mod dlt2d;
pub(super) mod dlt3d;
mod flight_records;
pub(super) mod grid;
mod hand_over;
mod held_grids;
pub(super) mod network;
mod report;

use std::io;
use std::path::Path;

use fmc_adjustment::calibration::five::FiveCalibration;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera_file::{InputError, fitted_block};
use fmc_report::calibration::{
    five_summary, five_table, residual_field, residual_plot, residuals_csv,
};
use fmc_report::figure::FigureError;

use crate::cli::{FiveArgs, RegressOn, StaticP2};
use crate::failure::{Failure, note};
use crate::formats::observations;
use crate::formats::output::{self, OutputFolder};

/// Runs `calibrate five`.
pub(super) fn five(args: &FiveArgs) -> Result<(), Failure> {
    let (camera, validated) = super::read_camera(&args.camera, super::FIVE_KNOW_NO_GRIDS)?;
    let camera_name = args
        .camera
        .file_name()
        .map_or_else(|| "camera.toml".into(), |name| name.to_string_lossy());
    if let Some(folder) = &args.out {
        let out = folder.join(&*camera_name);
        output::check_not_the_input(Some(&out), &args.camera)?;
    }
    let table = observations::read(&args.observations, &camera)?;
    let calibration = FiveCalibration::new(&table, &camera, &validated, options(args))?;
    let fitted = fitted(&calibration, args)?;
    let outputs = args
        .out
        .as_deref()
        .map(|folder| Outputs::of_five(&calibration, &fitted, args, folder))
        .transpose()?;
    output::write(None, |sink| {
        sink.write_all(five_table::text(&calibration).as_bytes())
    })?;
    outputs.map_or(Ok(()), Outputs::write)?;
    fitted.concluded(args.out.is_some())
}

/// Camera file of a calibration.
enum CalibratedCamera {
    /// Its text.
    Usable(String),
    /// The parameters are no usable camera: field, value and allowed range.
    Unusable(InputError),
}

impl CalibratedCamera {
    /// Returns the camera file, or what is wrong with the parameters.
    fn of(made: Result<String, InputError>) -> Self {
        made.map_or_else(Self::Unusable, Self::Usable)
    }

    /// Ends a command: a result that is no usable camera is a failed check, whatever the method.
    fn concluded(self, has_folder: bool) -> Result<(), Failure> {
        match self {
            Self::Usable(_) => Ok(()),
            Self::Unusable(error) => Err(Failure::check(if has_folder {
                format!("no camera file is written, the reports are: {error}")
            } else {
                format!("the result is no usable camera: {error}")
            })),
        }
    }
}

fn fitted(calibration: &FiveCalibration, args: &FiveArgs) -> Result<CalibratedCamera, Failure> {
    let camera = args.camera.as_path();
    let text = std::fs::read_to_string(camera).map_err(|error| Failure::reading(camera, &error))?;
    Ok(CalibratedCamera::of(fitted_block::with_coefficients(
        &camera.display().to_string(),
        &text,
        &calibration.fitted_table(),
        calibration.decentring(),
    )))
}

fn options(args: &FiveArgs) -> FitOptions {
    FitOptions {
        regressor: match args.regress_on {
            RegressOn::Travel => Regressor::Travel,
            RegressOn::Centroid => Regressor::Centroid,
        },
        tied: args.tie,
        decentring: match args.static_p2 {
            StaticP2::Hold => StaticDecentring::Hold,
            StaticP2::Estimate => StaticDecentring::Estimate,
            StaticP2::Known => StaticDecentring::Known,
        },
    }
}

/// Files of a calibration, all prepared before the first is written.
struct Outputs {
    folder: OutputFolder,
    files: Vec<(String, Vec<u8>)>,
    /// Files that these results do not have: those of former ones are removed.
    former: Vec<String>,
}

impl Outputs {
    fn of_five(
        calibration: &FiveCalibration,
        fitted: &CalibratedCamera,
        args: &FiveArgs,
        folder: &Path,
    ) -> Result<Self, Failure> {
        let making = |error: io::Error| Failure::writing("report", &error);
        let mut residuals = Vec::new();
        residuals_csv::write(calibration, &mut residuals)
            .map_err(|error| making(io::Error::other(error)))?;
        let mut summary = serde_json::to_vec_pretty(&five_summary::FiveSummary::of(calibration))
            .map_err(|error| making(error.into()))?;
        summary.push(b'\n');
        let mut files = vec![
            ("residuals.csv".to_owned(), residuals),
            ("summary.json".to_owned(), summary),
        ];
        let drawing = |error: FigureError| Failure::device_or_io(format!("figure: {error}"));
        files.push((
            "residual-vectors.svg".to_owned(),
            residual_field::residual_vectors(calibration)
                .map_err(drawing)?
                .into_bytes(),
        ));
        for against in residual_plot::Against::ALL {
            let svg = residual_plot::residuals_against(calibration, against).map_err(drawing)?;
            files.push((against.file_name().to_owned(), svg.into_bytes()));
        }
        Self::checked(
            files,
            fitted,
            &args.camera,
            &[&args.observations],
            folder,
            "calibrate five",
        )
    }

    /// Adds the camera file, where there is one, checks that no file replaces another or an input,
    /// and makes the folder.
    fn checked(
        mut files: Vec<(String, Vec<u8>)>,
        calibrated: &CalibratedCamera,
        camera: &Path,
        inputs: &[&Path],
        folder: &Path,
        command: &str,
    ) -> Result<Self, Failure> {
        let camera_name = camera
            .file_name()
            .map_or_else(|| "camera.toml".into(), |name| name.to_string_lossy())
            .into_owned();
        let mut former = Vec::new();
        match calibrated {
            CalibratedCamera::Usable(text) => {
                files.insert(0, (camera_name, text.as_bytes().to_vec()));
            }
            CalibratedCamera::Unusable(_) => former.push(camera_name),
        }
        for (index, (name, _)) in files.iter().enumerate() {
            let out = folder.join(name);
            output::check_not_the_input(Some(&out), camera)?;
            for input in inputs {
                output::check_not_an_input(&out, input)?;
            }
            if files.iter().skip(index + 1).any(|(other, _)| other == name) {
                return Err(Failure::bad_input(format!(
                    "--camera {}: a report of {command} is called {name}, too; rename the camera file",
                    camera.display()
                )));
            }
        }
        Ok(Self {
            folder: OutputFolder::create(folder)?,
            files,
            former,
        })
    }

    fn write(self) -> Result<(), Failure> {
        for name in &self.former {
            let former = self.folder.path().join(name);
            if former.exists() {
                std::fs::remove_file(&former)
                    .map_err(|error| Failure::writing(former.display(), &error))?;
            }
        }
        for (name, contents) in &self.files {
            self.folder.write(name, |sink| sink.write_all(contents))?;
        }
        let names: Vec<&str> = self.files.iter().map(|(name, _)| name.as_str()).collect();
        note(format_args!(
            "{}: {}",
            self.folder.path().display(),
            names.join(", ")
        ));
        Ok(())
    }
}
