//! A calibration for programs: `summary.json`.

use fmc_adjustment::calibration::result::CalibrationResult;
use serde::Serialize;
use serde_json::{Map, Value};

use super::profile::Profile;
use crate::calibration::five_summary::ObservedRegion;

/// The numbers of a calibration. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResultSummary {
    /// Method as the command spells it.
    pub method: &'static str,
    /// The camera's name.
    pub camera: String,
    /// Datum, in words.
    pub datum: String,
    /// Number of observations: two for an image point.
    pub observations: usize,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Number of constraints.
    pub constraints: usize,
    /// observations - unknowns + constraints.
    pub redundancy: usize,
    /// σ0: in µm if `has_sigma` is false, otherwise a factor of σ.
    pub sigma0: f64,
    /// `true` if the observations came with σ.
    pub has_sigma: bool,
    /// σ0 in pixels where the observations came without σ.
    pub sigma0_px: Option<f64>,
    /// σ0 by group of observations.
    pub groups: Vec<GroupSummary>,
    /// Root of the mean square of the residuals of image points along an axis, µm.
    pub residual_rms_um: Option<f64>,
    /// Largest residual of an image point along an axis, µm.
    pub residual_max_um: Option<f64>,
    /// Root of the mean square of the lengths of the residual vectors, px.
    pub rms_point_px: Option<f64>,
    /// Critical value of the test of residuals.
    pub critical_value: Option<f64>,
    /// Rejected observations.
    pub rejected: Vec<RejectedObservation>,
    /// Number of iterations.
    pub iterations: usize,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Statements that are no warnings.
    pub notes: Vec<String>,
    /// Part of the sensor with points in the adjustment.
    pub observed: Option<ObservedRegion>,
    /// Parameters.
    pub parameters: Vec<ParameterSummary>,
    /// Correlations of every pair of estimated parameters.
    pub correlations: Vec<CorrelationSummary>,
    /// Images with their orientation.
    pub images: Vec<ImageSummary>,
    /// Points whose coordinates are known, but not used.
    pub check_points: Vec<CheckPointSummary>,
    /// Radial and decentring profile.
    pub profile: Profile,
    /// Files of observations.
    pub inputs: Vec<InputSummary>,
    /// Keys of one method alone.
    #[serde(flatten)]
    pub of_method: Map<String, Value>,
}

/// A parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterSummary {
    /// Name, as in the camera file.
    pub name: String,
    /// Unit; empty for a number.
    pub unit: &'static str,
    /// Value from which the adjustment started.
    pub start: Option<f64>,
    /// Value.
    pub value: f64,
    /// Standard deviation, multiplied by σ0; 0 if the parameter was held.
    pub sigma: f64,
    /// Standard deviation for the given σ of the observations.
    pub sigma_a_priori: f64,
    /// σ with which the start was an observation; left out without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prior_sigma: Option<f64>,
    /// |value|/σ; `None` if the parameter was held.
    pub significance: Option<f64>,
}

/// Correlation of two parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct CorrelationSummary {
    pub a: String,
    pub b: String,
    pub value: f64,
}

/// A group of observations.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the fields are those of `ObservationGroup`")]
pub struct GroupSummary {
    pub name: &'static str,
    pub observations: usize,
    pub redundancy: f64,
    pub sigma0: Option<f64>,
    pub rejected: usize,
}

/// A rejected observation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RejectedObservation {
    /// Group.
    pub group: &'static str,
    /// Image, if it belongs to one.
    pub image: Option<String>,
    /// Object point, if it belongs to one.
    pub point: Option<String>,
    /// Residual vector of an image point, µm.
    pub residual_um: Option<[f64; 2]>,
    /// Test value.
    pub test_value: f64,
}

/// An image with its orientation.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the fields are those of `ImageStation`")]
pub struct ImageSummary {
    pub image: String,
    pub position_m: [f64; 3],
    pub position_sigma_m: Option<[f64; 3]>,
    pub attitude_deg: [f64; 3],
    pub attitude_sigma_deg: Option<[f64; 3]>,
    pub points: usize,
    pub residual_rms_um: f64,
}

/// A check point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckPointSummary {
    /// Name.
    pub point: String,
    /// Adjusted - given, m.
    pub difference_m: [f64; 3],
    /// σ of the adjusted coordinates, multiplied by σ0, m.
    pub sigma_m: [f64; 3],
    /// Largest difference over its σ.
    pub test_value: Option<f64>,
}

/// A file of observations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputSummary {
    /// Name.
    pub file: String,
    /// CRC-32 (ISO-HDLC), eight hexadecimal digits.
    pub crc32: String,
}

impl ResultSummary {
    /// Returns the numbers of a calibration, with keys of its method.
    #[must_use]
    pub fn of(result: &CalibrationResult, of_method: Map<String, Value>) -> Self {
        let size = result.residual_size_mm();
        let pixel_mm = result.camera.sensor.pixel_um / 1e3;
        let coverage = result.coverage();
        Self {
            method: result.method,
            camera: result.camera.name.clone(),
            datum: result.datum.clone(),
            observations: result.observations,
            unknowns: result.unknowns,
            constraints: result.constraints,
            redundancy: result.redundancy(),
            sigma0: result.sigma0,
            has_sigma: result.has_sigma,
            sigma0_px: (!result.has_sigma).then(|| result.sigma0 / result.camera.sensor.pixel_um),
            groups: groups(result),
            residual_rms_um: size.map(|(rms, _)| 1e3 * rms),
            residual_max_um: size.map(|(_, largest)| 1e3 * largest),
            rms_point_px: size.map(|(rms, _)| rms * 2.0_f64.sqrt() / pixel_mm),
            critical_value: result.critical_value,
            rejected: rejected(result),
            iterations: result.iterations,
            warnings: result.warnings.clone(),
            notes: result.notes.clone(),
            observed: (coverage.points > 0).then_some(ObservedRegion {
                radius_mm: coverage.radius_mm,
                x_mm: coverage.x_mm,
                y_mm: coverage.y_mm,
            }),
            parameters: parameters(result),
            correlations: correlations(result),
            images: images(result),
            check_points: check_points(result),
            profile: Profile::of(result),
            inputs: result
                .inputs
                .iter()
                .map(|input| InputSummary {
                    file: input.file.clone(),
                    crc32: format!("{:08x}", input.crc32),
                })
                .collect(),
            of_method,
        }
    }
}

fn groups(result: &CalibrationResult) -> Vec<GroupSummary> {
    let groups = result.groups.iter();
    groups
        .map(|group| GroupSummary {
            name: group.name,
            observations: group.observations,
            redundancy: group.redundancy,
            sigma0: group.sigma0,
            rejected: group.rejected,
        })
        .collect()
}

fn parameters(result: &CalibrationResult) -> Vec<ParameterSummary> {
    let parameters = result.parameters.iter();
    parameters
        .map(|one| {
            let sigma = result.sigma(&one.name);
            ParameterSummary {
                name: one.name.clone(),
                unit: one.unit,
                start: one.start,
                value: one.value,
                sigma: sigma.unwrap_or(0.0),
                sigma_a_priori: result.sigma_a_priori(&one.name).unwrap_or(0.0),
                prior_sigma: one.prior_sigma,
                significance: sigma
                    .filter(|sigma| *sigma > 0.0)
                    .map(|sigma| one.value.abs() / sigma),
            }
        })
        .collect()
}

fn correlations(result: &CalibrationResult) -> Vec<CorrelationSummary> {
    let names: Vec<&str> = result.estimated().map(|one| one.name.as_str()).collect();
    let mut found = Vec::new();
    for (index, a) in names.iter().enumerate() {
        for b in names.iter().skip(index + 1) {
            if let Some(value) = result.correlation(a, b) {
                found.push(CorrelationSummary {
                    a: (*a).to_owned(),
                    b: (*b).to_owned(),
                    value,
                });
            }
        }
    }
    found
}

fn rejected(result: &CalibrationResult) -> Vec<RejectedObservation> {
    let of_images = result.image_residuals.iter().filter(|one| one.is_rejected);
    let others = result.other_residuals.iter().filter(|one| one.is_rejected);
    of_images
        .map(|one| RejectedObservation {
            group: "image",
            image: Some(one.image.to_string()),
            point: Some(one.point.to_string()),
            residual_um: Some(one.vector_mm().map(|mm| 1e3 * mm)),
            test_value: one.test_value(),
        })
        .chain(others.map(|one| RejectedObservation {
            group: one.group,
            image: one.image.as_deref().map(str::to_owned),
            point: one.point.as_deref().map(str::to_owned),
            residual_um: None,
            test_value: one.tested.test_value,
        }))
        .collect()
}

fn images(result: &CalibrationResult) -> Vec<ImageSummary> {
    let images = result.images.iter();
    images
        .map(|one| ImageSummary {
            image: one.image.to_string(),
            position_m: one.position_m,
            position_sigma_m: one.position_sigma_m,
            attitude_deg: one.attitude_deg,
            attitude_sigma_deg: one.attitude_sigma_deg,
            points: one.points,
            residual_rms_um: 1e3 * one.residual_rms_mm,
        })
        .collect()
}

fn check_points(result: &CalibrationResult) -> Vec<CheckPointSummary> {
    use fmc_adjustment::calibration::result::network::PointRole;
    let checks = result
        .points
        .iter()
        .filter(|one| one.role == PointRole::Check);
    checks
        .filter_map(|one| {
            let [x, y, z] = one.position_m;
            let [given_x, given_y, given_z] = one.given_m?;
            Some(CheckPointSummary {
                point: one.point.to_string(),
                difference_m: [x - given_x, y - given_y, z - given_z],
                sigma_m: one.sigma_m,
                test_value: one.test_value,
            })
        })
        .collect()
}
