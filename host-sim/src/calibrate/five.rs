//! The five-coefficient model from observed distortions: robust, with everything a reader needs to
//! judge it.

use fmc_camera::flight::camera::Camera;
use fmc_camera::geometry::estimation::adjustment::{Adjustment, MIN_REGRESSOR_MM, MIN_SPREAD};
use fmc_camera::geometry::estimation::fit::{Fit, FitError};
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::estimation::parameter::{PARAMETERS, Parameter};
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera_file::InputError;
use fmc_camera_file::fitted_block::Decentring;
use fmc_camera_file::{CameraFile, FittedTable, Per};

use super::measurement::{Measurement, known_lens, measurements};
use super::robust_start::robust_start;
use super::snooping::{Snooped, snoop};
use super::units;
use crate::formats::observations::ObservationTable;

/// A calibration and what it rests on.
#[derive(Debug, Clone)]
pub struct FiveCalibration {
    /// What messages call the file of observations.
    pub file: String,
    /// Whether the observations came with σ.
    pub has_sigma: bool,
    /// In the order of the file.
    pub measurements: Vec<Measurement>,
    /// The test of each measurement.
    pub tested: Vec<Tested>,
    /// The fit to those accepted.
    pub fit: Fit<f64>,
    /// Test values above this are rejected.
    pub critical: f64,
    /// Different exposures among the measurements.
    pub exposures: usize,
    /// Whether c̄ is zero in every exposure, so that the dynamic terms vanish.
    pub centred: bool,
    /// The camera.
    pub camera: CameraFile,
}

/// The test of one measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    /// Observed less fitted distortion, mm.
    pub residual_mm: [f64; 2],
    /// The larger standardised component.
    pub test_value: f64,
    /// Whether it is part of the fit.
    pub passes: bool,
}

impl FiveCalibration {
    /// Determines the coefficients.
    ///
    /// # Errors
    /// [`InputError`] naming file, line, column, value and allowed range, or the parameters that the
    /// observations cannot separate.
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
        // What all of them cannot determine, fewer cannot either.
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

    /// The coefficients as the camera file holds them.
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

    /// The static decentring, where it was estimated.
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

    /// Measurements with their tests.
    pub fn rows(&self) -> impl Iterator<Item = (&Measurement, &Tested)> {
        self.measurements.iter().zip(&self.tested)
    }

    /// Those that are no part of the fit.
    pub fn rejected(&self) -> impl Iterator<Item = (&Measurement, &Tested)> {
        self.rows().filter(|(_, tested)| !tested.passes)
    }
}

/// Different exposures.
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

/// An adjustment of measurements that have been checked.
pub(super) fn adjusted<'a>(
    lens: &KnownLens<f64>,
    options: FitOptions,
    measurements: impl IntoIterator<Item = &'a Measurement>,
) -> Adjustment<f64> {
    let mut adjustment = Adjustment::new(*lens, options);
    for measurement in measurements {
        // Checked when it was read.
        let _ = adjustment.observe(measurement.observation());
    }
    adjustment
}

/// The model's derivatives by the parameters at a measurement, rows x and y, in powers of mm.
fn derivatives(lens: &KnownLens<f64>, measurement: &Measurement) -> [[f64; PARAMETERS]; 2] {
    let [x0, y0] = lens.principal_point_mm;
    let [x, y] = measurement.row.point_mm;
    let (x, y) = (x - x0, y - y0);
    let sign = f64::from(lens.axis.sign());
    let [ex, ey] = if lens.axis.is_x() {
        [1.0, 0.0]
    } else {
        [0.0, 1.0]
    };
    let r2 = x * x + y * y;
    let along = x * ex + y * ey;
    let s = sign * measurement.regressor_mm;
    let row = |part: f64, e: f64| {
        [
            part,
            part * r2,
            part * r2 * r2,
            s * along * part,
            s * r2 * e,
            r2 * e + 2.0 * along * part,
        ]
    };
    [row(x, ex), row(y, ey)]
}

/// Observed less fitted distortion, in units of σ.
pub(super) fn residuals_in_sigma(
    lens: &KnownLens<f64>,
    fit: &Fit<f64>,
    measurement: &Measurement,
) -> [f64; 2] {
    let [x0, y0] = lens.principal_point_mm;
    let [x, y] = measurement.row.point_mm;
    let (x, y) = (x - x0, y - y0);
    let r2 = x * x + y * y;
    let [_, _, _, k3] = lens.k;
    let [p1, p2] = lens.p;
    let [b1, b2] = lens.b;
    // The decentring along the axis is one of the parameters.
    let (p1, p2) = if lens.axis.is_x() {
        (0.0, p2)
    } else {
        (p1, 0.0)
    };
    let held = [
        x * k3 * r2.powi(3) + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y + b1 * x + b2 * y,
        y * k3 * r2.powi(3) + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y,
    ];
    let mut residuals = measurement.row.distortion_mm;
    for ((residual, held), row) in residuals
        .iter_mut()
        .zip(held)
        .zip(derivatives(lens, measurement))
    {
        let fitted: f64 = row
            .into_iter()
            .zip(fit.values)
            .map(|(derivative, value)| derivative * value)
            .sum();
        *residual = (*residual - held - fitted) / measurement.row.sigma_mm;
    }
    residuals
}

/// h = aᵀQa/σ²: the variance of the fitted distortion as a fraction of the observed one's.
pub(super) fn residual_variances(
    lens: &KnownLens<f64>,
    fit: &Fit<f64>,
    measurement: &Measurement,
) -> [f64; 2] {
    if fit.sigma0 <= 0.0 {
        return [0.0; 2];
    }
    let scale = 1.0 / (fit.sigma0 * measurement.row.sigma_mm);
    derivatives(lens, measurement).map(|row| {
        let mut weighted = row;
        for (part, deviation) in weighted.iter_mut().zip(fit.standard_deviations) {
            *part *= deviation * scale;
        }
        weighted
            .iter()
            .zip(&fit.correlations)
            .map(|(first, correlations)| {
                let inner: f64 = weighted
                    .iter()
                    .zip(correlations)
                    .map(|(second, correlation)| second * correlation)
                    .sum();
                first * inner
            })
            .sum()
    })
}

/// A fit that there is not, with what of the file made it so.
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
