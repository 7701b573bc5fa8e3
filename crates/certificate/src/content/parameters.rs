//! Parameters of the camera with their standard deviations, and how they were found.

use fmc_camera_file::{CameraFile, InputError};
use serde::Serialize;

use super::inputs::Inputs;
use super::observed::Observed;
use crate::calibration_summary::CalibrationSummary;
use crate::stated::Stated;

/// Parameters and how they were found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterSection {
    /// Columns and rows of the array, px.
    pub size_px: [i64; 2],
    /// Pixel pitch, µm.
    pub pixel_um: Option<Stated>,
    /// Format, mm.
    pub format_mm: [Option<Stated>; 2],
    /// Parameters, in the order of the camera file.
    pub values: Vec<ParameterLine>,
    /// Correlation matrices, one for each calibration that has correlations.
    pub correlations: Vec<CorrelationMatrix>,
    /// Calibrations.
    pub calibrations: Vec<CalibrationLine>,
    /// Part of the sensor with observed points.
    pub observed: Option<Observed>,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterLine {
    /// Name, as in the camera file.
    pub name: String,
    /// Symbol.
    pub symbol: String,
    /// Value; distortion as measured - ideal.
    pub value: Option<Stated>,
    /// Unit.
    pub unit: &'static str,
    /// Standard deviation.
    pub sigma: Option<Stated>,
    /// File of the calibration that states it.
    pub calibration: Option<String>,
}

/// Correlations of the parameters of one calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CorrelationMatrix {
    /// File of the calibration.
    pub calibration: String,
    /// Names of the parameters.
    pub names: Vec<String>,
    /// Rows of the matrix.
    pub rows: Vec<Vec<Option<Stated>>>,
}

/// Calibration by which parameters were found.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the fields are those of `CalibrationSummary`")]
pub struct CalibrationLine {
    pub file: String,
    pub sha256: String,
    pub method: Option<String>,
    pub datum: Option<String>,
    pub observations: Option<u64>,
    pub unknowns: Option<u64>,
    pub redundancy: Option<Stated>,
    pub sigma0: Option<Stated>,
    pub sigma0_unit: &'static str,
    pub rms_um: Option<Stated>,
    pub largest_um: Option<Stated>,
    pub rejected: Option<u64>,
    pub iterations: Option<u64>,
    pub held_grids: Vec<String>,
    pub warnings: Vec<String>,
}

impl ParameterSection {
    /// Collects the parameters.
    ///
    /// # Errors
    /// [`InputError`] for a calibration of another camera or with other residual grids, and a
    /// parameter that differs from the camera file's or has its σ from two calibrations.
    pub(super) fn new(inputs: &Inputs<'_>) -> Result<Self, InputError> {
        let Inputs {
            camera,
            calibrations,
            ..
        } = *inputs;
        let mut values: Vec<ParameterLine> =
            of_camera(camera).into_iter().map(InFile::line).collect();
        for summary in calibrations {
            add(&mut values, camera, summary)?;
        }
        Ok(Self {
            size_px: [camera.sensor.width_px, camera.sensor.height_px],
            pixel_um: Stated::exact(camera.sensor.pixel_um),
            format_mm: camera
                .half_format_mm()
                .map(|half| Stated::decimals(2.0 * half, 4)),
            values,
            correlations: calibrations.iter().filter_map(matrix).collect(),
            calibrations: calibrations.iter().map(line).collect(),
            observed: Observed::new(camera, calibrations),
        })
    }

    /// Returns the standard deviation of a parameter.
    #[must_use]
    pub fn sigma(&self, name: &str) -> Option<f64> {
        let line = self.values.iter().find(|line| line.name == name)?;
        Some(line.sigma.as_ref()?.value())
    }
}

/// A parameter of the camera file.
struct InFile {
    name: &'static str,
    symbol: &'static str,
    value: Option<f64>,
    unit: &'static str,
}

impl InFile {
    fn line(self) -> ParameterLine {
        ParameterLine {
            name: self.name.to_owned(),
            symbol: self.symbol.to_owned(),
            value: self.value.and_then(Stated::exact),
            unit: self.unit,
            sigma: None,
            calibration: None,
        }
    }
}

/// Number of parameters of the fitted model.
const FITTED: usize = 5;

/// Returns the parameters of a camera file, the distance of the exit pupil last.
fn of_camera(camera: &CameraFile) -> Vec<InFile> {
    let distortion = camera.distortion.measured_minus_ideal();
    let [x0, y0] = camera.principal_point_mm;
    let fitted = camera.fitted.clone().unwrap_or_default();
    let all = [
        (
            "principal_distance_mm",
            "f",
            camera.principal_distance_mm,
            "mm",
        ),
        ("x0_mm", "x0", x0, "mm"),
        ("y0_mm", "y0", y0, "mm"),
        ("k0", "K0", distortion.k0, ""),
        ("k1", "K1", distortion.k1, "mm⁻²"),
        ("k2", "K2", distortion.k2, "mm⁻⁴"),
        ("k3", "K3", distortion.k3, "mm⁻⁶"),
        ("p1", "P1", distortion.p1, "mm⁻¹"),
        ("p2", "P2", distortion.p2, "mm⁻¹"),
        ("b1", "B1", distortion.b1, ""),
        ("b2", "B2", distortion.b2, ""),
        ("km0", "Km0", fitted.km0, ""),
        ("km1", "Km1", fitted.km1, "mm⁻²"),
        ("km2", "Km2", fitted.km2, "mm⁻⁴"),
        ("kd1", "Kd1", fitted.kd1, "mm⁻²"),
        ("pm1", "Pm1", fitted.pm1, "mm⁻²"),
    ];
    let count = if camera.fitted.is_some() {
        all.len()
    } else {
        all.len() - FITTED
    };
    let mut found: Vec<InFile> = all
        .into_iter()
        .take(count)
        .map(|(name, symbol, value, unit)| InFile {
            name,
            symbol,
            value: Some(value),
            unit,
        })
        .collect();
    found.push(InFile {
        name: "exit_pupil_mm",
        symbol: "L",
        value: camera.exit_pupil_mm,
        unit: "mm",
    });
    found
}

/// Returns the parameters of a camera file by name, in its units; distortion as measured - ideal.
#[must_use]
pub fn in_file(camera: &CameraFile) -> Vec<(&'static str, Option<f64>)> {
    let all = of_camera(camera).into_iter();
    all.map(|one| (one.name, one.value)).collect()
}

/// Adds what a calibration states of the parameters.
fn add(
    lines: &mut Vec<ParameterLine>,
    camera: &CameraFile,
    summary: &CalibrationSummary,
) -> Result<(), InputError> {
    if let Some(name) = &summary.camera
        && *name != camera.name
    {
        return Err(InputError::invalid(format!(
            "{}: a calibration of {name:?}, and the camera file is of {:?}",
            summary.file, camera.name
        )));
    }
    summary.check_grids(camera.parameters().grids)?;
    let in_file = of_camera(camera);
    for parameter in &summary.parameters {
        let known = in_file.iter().find(|one| one.name == parameter.name);
        if let Some(value) = known.and_then(|known| known.value) {
            summary.check_same(parameter, value)?;
        }
        let Some(line) = lines.iter_mut().find(|line| line.name == parameter.name) else {
            lines.push(ParameterLine {
                name: parameter.name.clone(),
                symbol: "–".to_owned(),
                value: Stated::exact(parameter.value),
                unit: unit(&parameter.name),
                sigma: parameter.sigma.and_then(|sigma| Stated::digits(sigma, 3)),
                calibration: Some(summary.label.clone()),
            });
            continue;
        };
        if parameter.sigma.is_none() {
            continue;
        }
        if let Some(other) = &line.calibration {
            return Err(InputError::invalid(format!(
                "{}: σ of {} is stated by {other}, too",
                summary.file, parameter.name
            )));
        }
        line.sigma = parameter.sigma.and_then(|sigma| Stated::digits(sigma, 3));
        line.calibration = Some(summary.label.clone());
    }
    Ok(())
}

/// Returns the unit of a parameter that no camera file has, as the end of its name tells it.
fn unit(name: &str) -> &'static str {
    [
        ("_mm_per_mm2", "mm/mm²"),
        ("_mm_per_mm", "mm/mm"),
        ("_rad", "rad"),
        ("_deg", "°"),
        ("_um", "µm"),
        ("_mm", "mm"),
    ]
    .into_iter()
    .find(|(end, _)| name.ends_with(end))
    .map_or("", |(_, unit)| unit)
}

/// Returns the correlation matrix of a calibration; `None` if it states none.
fn matrix(summary: &CalibrationSummary) -> Option<CorrelationMatrix> {
    if summary.correlations.is_empty() {
        return None;
    }
    let names: Vec<String> = summary
        .parameters
        .iter()
        .map(|parameter| parameter.name.clone())
        .filter(|name| {
            let mut pairs = summary.correlations.keys();
            pairs.any(|(a, b)| a == name || b == name)
        })
        .collect();
    let cell = |a: &str, b: &str| Stated::decimals(summary.correlation(a, b)?, 3);
    let rows = names
        .iter()
        .map(|a| names.iter().map(|b| cell(a, b)).collect());
    Some(CorrelationMatrix {
        calibration: summary.label.clone(),
        rows: rows.collect(),
        names,
    })
}

fn line(summary: &CalibrationSummary) -> CalibrationLine {
    let digits = |value: Option<f64>| Stated::digits(value?, 4);
    CalibrationLine {
        file: summary.label.clone(),
        sha256: summary.sha256.clone(),
        method: summary.method.clone(),
        datum: summary.datum.clone(),
        observations: summary.observations,
        unknowns: summary.unknowns,
        redundancy: summary.redundancy.and_then(Stated::exact),
        sigma0: digits(summary.sigma0),
        sigma0_unit: summary.sigma0_unit,
        rms_um: digits(summary.rms_um),
        largest_um: digits(summary.largest_um),
        rejected: summary.rejected,
        iterations: summary.iterations,
        held_grids: summary
            .held_grids
            .iter()
            .map(|grid| format!("{}, CRC-32 {}", grid.part, grid.crc32))
            .collect(),
        warnings: summary.warnings.clone(),
    }
}
