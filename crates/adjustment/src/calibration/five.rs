//! Robust calibration of the five-coefficient model from observed distortions, with the data by
//! which a reader can judge it.

use fmc_camera::flight::camera::Camera;
use fmc_camera::geometry::estimation::adjustment::{MIN_REGRESSOR_MM, MIN_SPREAD};
use fmc_camera::geometry::estimation::fit::{Fit, FitError};
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera_file::fitted_block::Decentring;
use fmc_camera_file::{CameraFile, FittedTable, InputError, Per};

use super::measurement::{Measurement, known_lens, measurements};
use super::residual::{Tested, adjusted};
use super::robust_start::robust_start;
use super::snooping::{Snooped, snoop};
use super::units;
use crate::observation::ObservationTable;

/// A calibration with the data that it rests on.
#[derive(Debug, Clone)]
pub struct FiveCalibration {
    /// Name that messages use for the file of observations.
    pub file: String,
    /// `true` if the observations have a σ.
    pub has_sigma: bool,
    /// Measurements in the order of the file.
    pub measurements: Vec<Measurement>,
    /// The test of each measurement.
    pub tested: Vec<Tested>,
    /// Fit to the accepted measurements.
    pub fit: Fit<f64>,
    /// Critical value: measurements with a larger test value are rejected.
    pub critical: f64,
    /// Number of different exposures among the measurements.
    pub exposures: usize,
    /// `true` if c̄ is zero in every exposure, so that the dynamic terms vanish.
    pub centred: bool,
    /// Camera file.
    pub camera: CameraFile,
}

impl FiveCalibration {
    /// Determines the coefficients.
    ///
    /// # Errors
    /// [`InputError`] that names file, line, column, value and allowed range, or the parameters
    /// that the observations cannot separate.
    pub fn new(
        table: &ObservationTable,
        camera: &CameraFile,
        validated: &Camera,
        options: FitOptions,
    ) -> Result<Self, InputError> {
        let measurements = measurements(table, camera, validated, options.regressor)?;
        let lens = known_lens(camera);
        let exposures = exposures(&measurements);
        let failure =
            |error: FitError| fit_failure(&table.file, &measurements, &lens, options, error);
        if measurements.len() >= 3 {
            units::check(&table.file, &measurements, camera)?;
            units::check_sign(&table.file, &measurements, camera)?;
        }
        for measurement in &measurements {
            measurement.observation().checked(&lens).map_err(|error| {
                InputError::invalid(format!(
                    "{}, line {}: {error}",
                    table.file, measurement.row.line
                ))
            })?;
        }
        // A part of the measurements cannot determine what all of them cannot.
        adjusted(&lens, options, &measurements)
            .fit()
            .map_err(failure)?;
        let start = robust_start(&lens, options, &measurements).map_err(failure)?;
        let Snooped {
            fit,
            tested,
            critical,
        } = snoop(&lens, options, &measurements, &start).map_err(failure)?;
        units::check_sigma(&table.file, table.has_sigma, fit.sigma0, &measurements)?;
        let centred = measurements
            .iter()
            .all(|measurement| measurement.centroid_mm.abs() < f64::from(MIN_REGRESSOR_MM));
        Ok(Self {
            file: table.file.clone(),
            has_sigma: table.has_sigma,
            measurements,
            tested,
            fit,
            critical,
            exposures,
            centred,
            camera: camera.clone(),
        })
    }

    /// Returns the coefficients in the form of the camera file.
    #[must_use]
    pub fn fitted_table(&self) -> FittedTable {
        FittedTable {
            km0: self.fit.value(Parameter::Km0),
            km1: self.fit.value(Parameter::Km1),
            km2: self.fit.value(Parameter::Km2),
            kd1: self.fit.value(Parameter::Kd1),
            pm1: self.fit.value(Parameter::Pm1),
            per: match self.fit.options.regressor {
                Regressor::Travel => Per::Travel,
                Regressor::Centroid => Per::Centroid,
            },
        }
    }

    /// Returns the static decentring if it was estimated.
    #[must_use]
    pub fn decentring(&self) -> Option<Decentring> {
        let along_x = {
            let [ex, _] = self.camera.fmc.axis.unit();
            ex != 0.0
        };
        (self.fit.options.decentring == StaticDecentring::Estimate).then_some(Decentring {
            key: if along_x { "p1" } else { "p2" },
            per_mm: self.fit.value(Parameter::Decentring),
        })
    }

    /// Returns the measurements with their tests.
    pub fn rows(&self) -> impl Iterator<Item = (&Measurement, &Tested)> {
        self.measurements.iter().zip(&self.tested)
    }

    /// Returns the measurements that are not part of the fit.
    pub fn rejected(&self) -> impl Iterator<Item = (&Measurement, &Tested)> {
        self.rows().filter(|(_, tested)| !tested.passes)
    }
}

/// Counts the different exposures.
fn exposures(measurements: &[Measurement]) -> usize {
    let mut exposures: Vec<[u64; 3]> = measurements
        .iter()
        .map(|measurement| {
            let row = &measurement.row;
            [row.vh_per_s, row.exposure_s, row.opening_offset_mm].map(f64::to_bits)
        })
        .collect();
    exposures.sort_unstable();
    exposures.dedup();
    exposures.len()
}

/// Creates the error of a failed fit, with the values of the file that caused it.
fn fit_failure(
    file: &str,
    measurements: &[Measurement],
    lens: &KnownLens<f64>,
    options: FitOptions,
    error: FitError,
) -> InputError {
    let range = |of: fn(&Measurement) -> f64| {
        let (least, most) = measurements.iter().map(of).fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(least, most), value| (least.min(value), most.max(value)),
        );
        format!("{least} to {most}")
    };
    let failure = InputError::invalid(format!("{file}: {error}"));
    let lines = measurements
        .last()
        .map_or(1, |measurement| measurement.row.line);
    match error {
        FitError::TooFew { needed, .. } => InputError::invalid(format!(
            "{file}, line {lines} is the last: {error}"
        ))
        .with_help(format!("at least {needed} rows with different points")),
        FitError::OnALine { .. } => InputError::invalid(format!(
            "{file}, lines 2 to {lines}: x_mm {}, y_mm {}: {error}; allowed: at least {:.3} mm",
            range(|m| {
                let [x, _] = m.row.point_mm;
                x
            }),
            range(|m| {
                let [_, y] = m.row.point_mm;
                y
            }),
            f64::from(MIN_SPREAD) * lens.radius_mm
        )),
        FitError::NoMotion { .. } => failure.with_help(
            "without the dynamic terms the static calibration, evaluated about the centroid principal point, is the model",
        ),
        FitError::Inseparable { .. } | FitError::Unobserved { .. } => {
            let regressor = match options.regressor {
                Regressor::Travel => "travel",
                Regressor::Centroid => "centroid offset",
            };
            InputError::invalid(format!(
                "{file}, lines 2 to {lines}: {error}: vh_per_s {}, exposure_s {}, opening_offset_mm {}, {regressor} {} mm",
                range(|m| m.row.vh_per_s),
                range(|m| m.row.exposure_s),
                range(|m| m.row.opening_offset_mm),
                range(|m| m.regressor_mm),
            ))
            .with_help(
                "exposures of different travel tell the dynamic terms from a static decentring, points at different \
                 distances from the principal point tell the radial terms from each other; --static-p2 known believes \
                 the calibration's decentring, and --tie has one dynamic parameter instead of two",
            )
        }
    }
}
