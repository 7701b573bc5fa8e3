//! A five-coefficient calibration for programs: `summary.json`.

use std::collections::BTreeMap;

use fmc_adjustment::calibration::five::FiveCalibration;
use fmc_camera::geometry::estimation::options::StaticDecentring;
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_camera::geometry::five_coefficient::Regressor;
use serde::Serialize;

/// The numbers of a calibration. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FiveSummary {
    /// `five`.
    pub method: &'static str,
    /// The camera's name.
    pub camera: String,
    /// The file of observations.
    pub observations: String,
    /// Points given, two observations each.
    pub points: usize,
    /// Points in the fit.
    pub accepted: u32,
    /// Different exposures.
    pub exposures: usize,
    /// `true` if `K_d1` = 2 `P_m1` was imposed.
    pub tied: bool,
    /// `travel` or `centroid`.
    pub regress_on: &'static str,
    /// `hold`, `estimate` or `known`.
    pub static_p2: &'static str,
    /// Unknowns u.
    pub unknowns: u32,
    /// 2n - u.
    pub redundancy: u32,
    /// σ0: in µm without a column `sigma_um`, otherwise a factor of σ.
    pub sigma0: f64,
    /// σ0 with n - u, as printed in Yuan et al. 2012, eq. 28.
    pub sigma0_as_printed: Option<f64>,
    /// `true` if the observations came with σ.
    pub has_sigma: bool,
    /// Condition number of the normalised design.
    pub condition: f64,
    /// Coefficients by name.
    pub coefficients: BTreeMap<&'static str, Coefficient>,
    /// Statistics of the residuals of dx and of dy, accepted points.
    pub residuals: [ResidualStatistics; 2],
    /// Limit of the test value above which an observation is rejected.
    pub critical_value: f64,
    /// Observations that are not part of the fit.
    pub rejected: Vec<Rejected>,
    /// Part of the sensor with points in the fit.
    pub observed: ObservedRegion,
}

/// Part of the sensor with observed points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ObservedRegion {
    /// Largest distance from the calibrated principal point, mm.
    pub radius_mm: f64,
    /// Smallest and largest x, mm in the sensor frame.
    pub x_mm: [f64; 2],
    /// Smallest and largest y, mm in the sensor frame.
    pub y_mm: [f64; 2],
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coefficient {
    /// Value in powers of mm.
    pub value: f64,
    /// Standard deviation; 0 if the coefficient is held.
    pub standard_deviation: f64,
    /// Correlations with the other coefficients.
    pub correlations: BTreeMap<&'static str, f64>,
}

/// Residuals of one component, µm.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct ResidualStatistics {
    /// Mean.
    pub mean_um: f64,
    /// Root mean square.
    pub rms_um: f64,
    /// Largest absolute value.
    pub max_um: f64,
}

/// An observation that was rejected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rejected {
    /// Line in the file.
    pub line: u64,
    /// Name of the observation.
    pub id: Option<String>,
    /// Residual, µm.
    pub residual_um: [f64; 2],
    /// Larger of the standardised components.
    pub test_value: f64,
}

/// Returns the name of a parameter in the camera file.
pub(super) fn name(parameter: Parameter, along_x: bool) -> &'static str {
    match parameter {
        Parameter::Km0 => "km0",
        Parameter::Km1 => "km1",
        Parameter::Km2 => "km2",
        Parameter::Kd1 => "kd1",
        Parameter::Pm1 => "pm1",
        Parameter::Decentring if along_x => "p1",
        Parameter::Decentring => "p2",
    }
}

/// Returns the parameters that were estimated.
pub(super) fn estimated(calibration: &FiveCalibration) -> Vec<Parameter> {
    let with = calibration.fit.options.decentring == StaticDecentring::Estimate;
    Parameter::ALL
        .into_iter()
        .filter(|parameter| with || *parameter != Parameter::Decentring)
        .collect()
}

/// Returns true if the FMC axis lies along x.
pub(super) fn is_along_x(calibration: &FiveCalibration) -> bool {
    let [ex, _] = calibration.camera.fmc.axis.unit();
    ex.abs() > 0.5
}

impl FiveSummary {
    /// Returns the numbers of a calibration.
    #[must_use]
    pub fn of(calibration: &FiveCalibration) -> Self {
        let fit = &calibration.fit;
        let along_x = is_along_x(calibration);
        let parameters = estimated(calibration);
        let coefficients = parameters
            .iter()
            .map(|parameter| {
                let correlations = parameters
                    .iter()
                    .map(|other| (name(*other, along_x), fit.correlation(*parameter, *other)))
                    .collect();
                let coefficient = Coefficient {
                    value: fit.value(*parameter),
                    standard_deviation: fit.standard_deviation(*parameter),
                    correlations,
                };
                (name(*parameter, along_x), coefficient)
            })
            .collect();
        Self {
            method: "five",
            camera: calibration.camera.name.clone(),
            observations: calibration.file.clone(),
            points: calibration.measurements.len(),
            accepted: fit.points,
            exposures: calibration.exposures,
            tied: fit.options.tied,
            regress_on: match fit.options.regressor {
                Regressor::Travel => "travel",
                Regressor::Centroid => "centroid",
            },
            static_p2: match fit.options.decentring {
                StaticDecentring::Hold => "hold",
                StaticDecentring::Estimate => "estimate",
                StaticDecentring::Known => "known",
            },
            unknowns: fit.unknowns,
            redundancy: fit.redundancy(),
            sigma0: fit.sigma0,
            sigma0_as_printed: fit.sigma0_as_printed,
            has_sigma: calibration.has_sigma,
            condition: fit.condition,
            coefficients,
            residuals: residual_statistics(calibration),
            critical_value: calibration.critical,
            rejected: calibration
                .rejected()
                .map(|(measurement, tested)| Rejected {
                    line: measurement.row.line,
                    id: measurement.row.id.as_deref().map(str::to_owned),
                    residual_um: tested.residual_mm.map(|mm| 1e3 * mm),
                    test_value: tested.test_value,
                })
                .collect(),
            observed: observed(calibration),
        }
    }
}

/// Returns the region of the points in the fit.
fn observed(calibration: &FiveCalibration) -> ObservedRegion {
    let [x0, y0] = calibration.camera.principal_point_mm;
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let mut region = ObservedRegion {
        radius_mm: 0.0,
        x_mm: none,
        y_mm: none,
    };
    for (measurement, _) in calibration.rows().filter(|(_, tested)| tested.passes) {
        let [x, y] = measurement.row.point_mm;
        region.radius_mm = region.radius_mm.max((x - x0).hypot(y - y0));
        for (range, value) in [(&mut region.x_mm, x), (&mut region.y_mm, y)] {
            let [least, most] = *range;
            *range = [least.min(value), most.max(value)];
        }
    }
    region
}

fn residual_statistics(calibration: &FiveCalibration) -> [ResidualStatistics; 2] {
    let mut statistics = [ResidualStatistics::default(); 2];
    let points = f64::from(calibration.fit.points.max(1));
    for (_, tested) in calibration.rows().filter(|(_, tested)| tested.passes) {
        for (statistics, mm) in statistics.iter_mut().zip(tested.residual_mm) {
            let um = 1e3 * mm;
            statistics.mean_um += um / points;
            statistics.rms_um += um * um / points;
            statistics.max_um = statistics.max_um.max(um.abs());
        }
    }
    for statistics in &mut statistics {
        statistics.rms_um = statistics.rms_um.sqrt();
    }
    statistics
}
