//! Result of the exact model of a line camera.

use std::sync::Arc;

use fmc_camera_file::DistortionTable;
use fmc_camera_file::static_block::StaticCalibration;
use nalgebra::DMatrix;

use super::exact::{FilePolynomial, LineCamera};
use super::line_group::LineGroup;
use super::request::{AnglesRequest, LineAxis};
use crate::calibration::gross_errors::{Searched, rejection_warning};
use crate::calibration::result::CalibrationResult;
use crate::calibration::result::parameter_estimate::ParameterEstimate;
use crate::calibration::result::residual::{ImageResidual, ObservationGroup, TestedResidual};

/// σ by which principal points of two bands may differ before it is said.
const BANDS_DIFFER: f64 = 4.0;

pub(super) fn result(
    request: &AnglesRequest<'_>,
    searched: &Searched<LineCamera<'_>, 1>,
    bands: &[LineGroup],
) -> CalibrationResult {
    let adjusted = &searched.adjusted;
    let [f, p, _, _, offset] = adjusted.model.unknowns;
    let polynomial = adjusted
        .model
        .distortion()
        .polynomial(adjusted.model.radius_mm());
    let [k1, k2, k3] = polynomial.k;
    let camera = request.camera;
    let [x0, y0] = camera.principal_point_mm;
    let (point, names, across) = match request.along {
        LineAxis::X => ([p, y0], ["x0_mm", "y0_mm"], y0),
        LineAxis::Y => ([x0, p], ["y0_mm", "x0_mm"], x0),
    };
    let [along_name, across_name] = names;
    let nominal = camera.principal_distance_mm;
    let started = |name: &str, value: f64| ParameterEstimate::estimated(name, None, value);
    let parameters = vec![
        ParameterEstimate::estimated("principal_distance_mm", Some(nominal), f),
        started(along_name, p),
        started("k1", k1),
        started("k2", k2),
        started("k3", k3),
        started("angle_offset_rad", offset),
        ParameterEstimate::held(across_name, across),
    ];
    let residuals = residuals(request, searched);
    let accepted = residuals.iter().filter(|one| !one.is_rejected).count();
    let tested = searched
        .tested
        .iter()
        .zip(&searched.accepted)
        .map(|([tested], accepted)| (*tested, !accepted));
    let mut result = CalibrationResult {
        method: "angles",
        camera: camera.clone(),
        calibrated: StaticCalibration {
            principal_distance_mm: f,
            principal_point_mm: point,
            distortion: DistortionTable {
                k1,
                k2,
                k3,
                ..DistortionTable::default()
            },
            flatness_um: None,
        },
        inputs: vec![request.input.clone()],
        parameters,
        cofactors: cofactors(&adjusted.cofactors, &polynomial),
        sigma0: adjusted.sigma0,
        has_sigma: true,
        groups: vec![ObservationGroup::new("line", tested)],
        datum: "the angles of the turntable; its zero is an unknown".to_owned(),
        observations: accepted,
        unknowns: adjusted.model.unknowns.len(),
        constraints: 0,
        iterations: adjusted.iterations,
        critical_value: searched.critical,
        warnings: Vec::new(),
        notes: vec![
            format!(
                "camera file and parameters are those of the exact model; one line of the sensor determines neither {across_name} nor decentring nor affinity, and K0, P1, P2, B1, B2 are zero"
            ),
            format!(
                "K1, K2, K3 follow the two coefficients of the exact model to {:.3} µm along the line",
                1e3 * polynomial.left_mm
            ),
            "the 2 µm of a collimating lens, 1/7 of them in a camera of a seventh of its principal distance, are in no budget".to_owned(),
        ],
        image_residuals: residuals,
        other_residuals: Vec::new(),
        images: Vec::new(),
        points: Vec::new(),
    };
    result.warnings.extend(rejection_warning(&result));
    result.warnings.extend(band_warning(bands));
    result
}

fn residuals(
    request: &AnglesRequest<'_>,
    searched: &Searched<LineCamera<'_>, 1>,
) -> Vec<ImageResidual> {
    let [x0, y0] = request.camera.principal_point_mm;
    request
        .observations
        .iter()
        .zip(&searched.tested)
        .zip(&searched.accepted)
        .map(|((one, [tested]), accepted)| {
            // The other component was not observed.
            let none = TestedResidual::default();
            let (measured_mm, components) = match request.along {
                LineAxis::X => ([one.l_mm, y0], [*tested, none]),
                LineAxis::Y => ([x0, one.l_mm], [none, *tested]),
            };
            let name = [&one.band, &one.repeat]
                .into_iter()
                .filter_map(|name| name.as_deref())
                .collect::<Vec<_>>()
                .join("/");
            ImageResidual {
                line: one.line,
                image: Arc::from(if name.is_empty() { "1" } else { name.as_str() }),
                point: Arc::from(one.angle_deg.to_string()),
                measured_mm,
                components,
                is_rejected: !accepted,
            }
        })
        .collect()
}

/// Returns the cofactor matrix of f, p, K1, K2, K3 of the camera file and W0.
fn cofactors(of_unknowns: &DMatrix<f64>, polynomial: &FilePolynomial) -> DMatrix<f64> {
    let mut rows = vec![[1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0]];
    for (by_k1, by_k2) in polynomial.by_k1.into_iter().zip(polynomial.by_k2) {
        rows.push([0.0, 0.0, by_k1, by_k2, 0.0]);
    }
    rows.push([0.0, 0.0, 0.0, 0.0, 1.0]);
    let rows: Vec<f64> = rows.into_iter().flatten().collect();
    let carried = DMatrix::from_row_slice(6, 5, &rows);
    &carried * of_unknowns * carried.transpose()
}

/// Returns a warning if principal points of bands differ by more than their σ explain.
fn band_warning(bands: &[LineGroup]) -> Option<String> {
    let points: Vec<(&str, f64, f64)> = bands
        .iter()
        .filter_map(|group| {
            let exact = group.methods.iter().find(|one| one.name == "exact")?;
            let p = exact.parameters.iter().find(|one| one.name == "p_mm")?;
            Some((group.band.as_deref()?, p.value, p.sigma?))
        })
        .collect();
    let by_value = |a: &&(&str, f64, f64), b: &&(&str, f64, f64)| a.1.total_cmp(&b.1);
    let (least, most) = (
        points.iter().min_by(by_value)?,
        points.iter().max_by(by_value)?,
    );
    let sigma = least.2.hypot(most.2);
    (most.1 - least.1 > BANDS_DIFFER * sigma).then(|| {
        format!(
            "the principal points of the bands {} and {} differ by {:.1} µm; each band has one of its own, and the camera file has their mean",
            least.0,
            most.0,
            1e3 * (most.1 - least.1)
        )
    })
}
