//! A calibration's `summary.json`, as far as a certificate states it.

use std::collections::BTreeMap;

use fmc_camera::geometry::grid::GridChecksums;
use fmc_camera_file::InputError;
use fmc_report::hash;
use serde::Deserialize;
use serde_json::Value;

/// Largest difference between a parameter of the summary and the camera file, as a share of it:
/// rounding of either file.
const SAME: f64 = 1e-6;

/// A parameter of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimatedParameter {
    /// Name, as in the camera file.
    pub name: String,
    /// Value, in the camera file's unit; distortion as measured - ideal.
    pub value: f64,
    /// Standard deviation; `None` if the parameter was held, or none is given.
    pub sigma: Option<f64>,
}

/// Part of the sensor that observed points cover.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct ObservedRegion {
    /// Largest distance from the principal point, mm.
    pub radius_mm: f64,
    /// Smallest and largest x, mm in the sensor frame.
    pub x_mm: [f64; 2],
    /// Smallest and largest y, mm in the sensor frame.
    pub y_mm: [f64; 2],
}

/// Residual grid that a calibration held.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct HeldGrid {
    /// Part: `lens` or `sensor`.
    #[serde(rename = "frame")]
    pub part: String,
    /// CRC-32 with which its file ends, eight hexadecimal digits.
    pub crc32: String,
}

/// Statements of a calibration about itself; those that its summary does not have are `None` or
/// empty.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationSummary {
    /// Name of the file that messages use.
    pub file: String,
    /// Name that the certificate states, without folders.
    pub label: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Method.
    pub method: Option<String>,
    /// Name of the camera.
    pub camera: Option<String>,
    /// Datum.
    pub datum: Option<String>,
    /// Number of observations: two for an image point.
    pub observations: Option<u64>,
    /// Number of unknowns.
    pub unknowns: Option<u64>,
    /// Redundancy.
    pub redundancy: Option<f64>,
    /// σ0.
    pub sigma0: Option<f64>,
    /// Unit of σ0: µm where the observations came without σ.
    pub sigma0_unit: &'static str,
    /// Root of the mean square of the residuals, µm along an axis.
    pub rms_um: Option<f64>,
    /// Largest residual, µm along an axis.
    pub largest_um: Option<f64>,
    /// Number of observations rejected as gross errors.
    pub rejected: Option<u64>,
    /// Number of iterations.
    pub iterations: Option<u64>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Part of the sensor with observed points.
    pub observed: Option<ObservedRegion>,
    /// Residual grids that were held.
    pub held_grids: Vec<HeldGrid>,
    /// Parameters.
    pub parameters: Vec<EstimatedParameter>,
    /// Correlations between two parameters.
    pub correlations: BTreeMap<(String, String), f64>,
}

/// The keys that are read, of every method; others are left alone.
#[derive(Deserialize)]
struct Written {
    method: Option<String>,
    camera: Option<String>,
    datum: Option<Value>,
    /// A number, or the name of a file.
    observations: Option<Value>,
    points: Option<u64>,
    accepted: Option<u64>,
    unknowns: Option<u64>,
    redundancy: Option<f64>,
    sigma0: Option<f64>,
    has_sigma: Option<bool>,
    residual_rms_um: Option<f64>,
    residual_max_um: Option<f64>,
    residuals: Option<Vec<Residuals>>,
    rejected: Option<Vec<Value>>,
    iterations: Option<u64>,
    #[serde(default)]
    warnings: Vec<String>,
    observed: Option<ObservedRegion>,
    #[serde(default)]
    held_grids: Vec<HeldGrid>,
    #[serde(default)]
    parameters: Vec<Parameter>,
    #[serde(default)]
    correlations: Vec<Correlation>,
    /// Parameters of `calibrate five`.
    #[serde(default)]
    coefficients: BTreeMap<String, Coefficient>,
}

#[derive(Deserialize)]
struct Residuals {
    rms_um: f64,
    max_um: f64,
}

#[derive(Deserialize)]
struct Parameter {
    name: String,
    value: f64,
    sigma: Option<f64>,
}

#[derive(Deserialize)]
struct Correlation {
    a: String,
    b: String,
    value: f64,
}

#[derive(Deserialize)]
struct Coefficient {
    value: f64,
    standard_deviation: Option<f64>,
    #[serde(default)]
    correlations: BTreeMap<String, f64>,
}

impl CalibrationSummary {
    /// Reads the bytes of a summary; `file` is the name that messages use.
    ///
    /// # Errors
    /// [`InputError`] for text that is no summary, one without parameters, a parameter stated
    /// twice, a σ that is negative and a correlation beyond ±1.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, InputError> {
        let refused = |fault: String| InputError::invalid(format!("{file}: {fault}"));
        let written: Written = serde_json::from_slice(bytes)
            .map_err(|error| refused(format!("no summary of a calibration: {error}")))?;
        let (parameters, correlations) = written.estimates();
        if parameters.is_empty() {
            return Err(refused(
                "no summary of a calibration: it has no `parameters` and no `coefficients`"
                    .to_owned(),
            ));
        }
        for (index, parameter) in parameters.iter().enumerate() {
            let EstimatedParameter { name, sigma, .. } = parameter;
            if parameters
                .iter()
                .skip(index + 1)
                .any(|other| other.name == *name)
            {
                return Err(refused(format!("{name} is stated twice")));
            }
            if sigma.is_some_and(|sigma| sigma < 0.0) {
                return Err(refused(format!("σ of {name} is negative")));
            }
        }
        if let Some(((a, b), value)) = correlations.iter().find(|(_, value)| value.abs() > 1.000_1)
        {
            return Err(refused(format!(
                "the correlation of {a} and {b} is {value}"
            )));
        }
        Ok(Self {
            file: file.to_owned(),
            label: file.to_owned(),
            sha256: hash::sha256(bytes),
            observations: written.observations(),
            rms_um: written.rms_um(),
            largest_um: written.largest_um(),
            sigma0_unit: if written.has_sigma == Some(false) {
                "µm"
            } else {
                ""
            },
            rejected: written
                .rejected
                .as_ref()
                .map(|rejected| rejected.len() as u64),
            datum: written
                .datum
                .as_ref()
                .and_then(Value::as_str)
                .map(str::to_owned),
            method: written.method,
            camera: written.camera,
            unknowns: written.unknowns,
            redundancy: written.redundancy,
            sigma0: written.sigma0,
            iterations: written.iterations,
            warnings: written.warnings,
            observed: written.observed,
            held_grids: written.held_grids,
            parameters,
            correlations,
        })
    }

    /// Checks that a parameter has the value of the camera file.
    ///
    /// # Errors
    /// [`InputError`] naming both.
    pub fn check_same(
        &self,
        parameter: &EstimatedParameter,
        in_file: f64,
    ) -> Result<(), InputError> {
        let EstimatedParameter { name, value, sigma } = parameter;
        let allowed = (SAME * in_file.abs()).max(1e-3 * sigma.unwrap_or_default());
        if (value - in_file).abs() <= allowed {
            return Ok(());
        }
        Err(InputError::invalid(format!(
            "{}: {name} = {value}, and the camera file has {in_file}",
            self.file
        ))
        .with_help("take the camera file that this calibration has written"))
    }

    /// Checks that the residual grids that were held are those of the camera file, each with the
    /// CRC-32 with which its file ends.
    ///
    /// # Errors
    /// [`InputError`] naming the part and both.
    pub fn check_grids(&self, in_file: GridChecksums) -> Result<(), InputError> {
        if self.held_grids.is_empty() {
            return Ok(());
        }
        for (part, known) in [("lens", in_file.lens), ("sensor", in_file.sensor)] {
            let held = self.held_grids.iter().find(|grid| grid.part == part);
            let held = held.map(|grid| grid.crc32.to_lowercase());
            let known = known.map(|crc32| format!("{crc32:08x}"));
            if held != known {
                let named = |crc32: Option<String>| {
                    crc32.map_or("none".to_owned(), |crc32| {
                        format!("that with CRC-32 {crc32}")
                    })
                };
                return Err(InputError::invalid(format!(
                    "{}: held residual grid of the {part}: {}, and the camera file has {}",
                    self.file,
                    named(held),
                    named(known)
                ))
                .with_help("take the camera file that this calibration has written"));
            }
        }
        Ok(())
    }

    /// Returns the correlation of two parameters: 1 of a parameter with itself.
    #[must_use]
    pub fn correlation(&self, a: &str, b: &str) -> Option<f64> {
        if a == b {
            return Some(1.0);
        }
        let of = |a: &str, b: &str| self.correlations.get(&(a.to_owned(), b.to_owned()));
        of(a, b).or_else(|| of(b, a)).copied()
    }
}

impl Written {
    fn estimates(&self) -> (Vec<EstimatedParameter>, BTreeMap<(String, String), f64>) {
        let estimated = |name: &str, value: f64, sigma: Option<f64>| EstimatedParameter {
            name: name.to_owned(),
            value,
            // A parameter that was held has none.
            sigma: sigma.filter(|sigma| *sigma != 0.0),
        };
        let mut parameters: Vec<_> = self
            .parameters
            .iter()
            .map(|one| estimated(&one.name, one.value, one.sigma))
            .collect();
        let mut correlations: BTreeMap<_, _> = self
            .correlations
            .iter()
            .map(|one| ((one.a.clone(), one.b.clone()), one.value))
            .collect();
        for (name, one) in &self.coefficients {
            parameters.push(estimated(name, one.value, one.standard_deviation));
            for (other, value) in one.correlations.iter().filter(|(other, _)| *other > name) {
                correlations.insert((name.clone(), other.clone()), *value);
            }
        }
        (parameters, correlations)
    }

    fn observations(&self) -> Option<u64> {
        let points = self.accepted.or(self.points);
        self.observations
            .as_ref()
            .and_then(Value::as_u64)
            .or_else(|| points.map(|points| 2 * points))
    }

    fn rms_um(&self) -> Option<f64> {
        self.residual_rms_um.or_else(|| {
            let residuals = self.residuals.as_ref().filter(|list| !list.is_empty())?;
            let mut count = 0.0;
            let mut squares = 0.0;
            for one in residuals {
                count += 1.0;
                squares += one.rms_um * one.rms_um;
            }
            Some(f64::sqrt(squares / count))
        })
    }

    fn largest_um(&self) -> Option<f64> {
        self.residual_max_um.or_else(|| {
            let residuals = self.residuals.as_ref()?.iter();
            residuals.map(|one| one.max_um).reduce(f64::max)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_of_a_bundle_is_read() {
        let text = r#"{"method":"bundle","sigma0":1.02,"redundancy":812,"datum":"control",
            "observations":840,"parameters":[{"name":"principal_distance_mm","value":51.3712,"sigma":0.0007},
            {"name":"k1","value":-1.6e-5,"sigma":2e-8},{"name":"k2","value":0.0,"sigma":0.0}],
            "correlations":[{"a":"k1","b":"principal_distance_mm","value":-0.4}],
            "rejected":[{"image":"a","point":"b"}],"iterations":6,"warnings":["few rays"],
            "observed":{"radius_mm":31.0,"x_mm":[-25.0,25.0],"y_mm":[-19.0,19.0]}}"#;
        let summary = CalibrationSummary::parse("s.json", text.as_bytes()).unwrap();
        assert_eq!(summary.observations, Some(840));
        assert_eq!(summary.rejected, Some(1));
        assert_eq!(summary.parameters[2].sigma, None);
        assert_eq!(
            summary.correlation("principal_distance_mm", "k1"),
            Some(-0.4)
        );
        assert_eq!(summary.correlation("k1", "k2"), None);
        assert!(summary.check_same(&summary.parameters[0], 51.3712).is_ok());
        let error = summary
            .check_same(&summary.parameters[0], 51.3713)
            .unwrap_err();
        assert!(
            error
                .to_string()
                .contains("51.3712, and the camera file has 51.3713")
        );
    }

    #[test]
    fn what_is_no_summary_is_refused() {
        for (text, word) in [
            ("", "no summary"),
            ("[1]", "no summary"),
            ("{}", "no `parameters`"),
            (
                r#"{"parameters":[{"name":"k1","value":1e999}]}"#,
                "no summary",
            ),
            (
                r#"{"parameters":[{"name":"k1","value":1,"sigma":-1}]}"#,
                "negative",
            ),
            (
                r#"{"parameters":[{"name":"k1","value":1},{"name":"k1","value":1}]}"#,
                "twice",
            ),
            (
                r#"{"parameters":[{"name":"k1","value":1}],"correlations":[{"a":"k1","b":"k2","value":2}]}"#,
                "correlation",
            ),
        ] {
            let error = CalibrationSummary::parse("s.json", text.as_bytes()).unwrap_err();
            assert!(error.to_string().contains(word), "{error}");
        }
    }
}
