//! Table, interpolations and camera file of a two-dimensional direct linear transformation.

use std::sync::Arc;

use fmc_camera_file::DistortionTable;
use fmc_camera_file::static_block::StaticCalibration;
use nalgebra::DMatrix;

use super::distortion_table::{Dlt2d, Gauge, TableRow};
use super::homography::{EIGHT, Homographies, Pair, apply};
use super::interpolation::{InterpolatedTable, main_term};
use super::request::{Dlt2dRequest, PlaneTarget};
use crate::calibration::dlt3d::COEFFICIENT_NAMES;
use crate::calibration::gross_errors::rejection_warning;
use crate::calibration::result::CalibrationResult;
use crate::calibration::result::parameter_estimate::ParameterEstimate;
use crate::calibration::result::residual::{ImageResidual, ObservationGroup};

pub(super) fn outcome(
    request: &Dlt2dRequest<'_>,
    homographies: &Homographies<'_>,
    gauge: Gauge,
) -> Dlt2d {
    let searched = &homographies.searched;
    let accepted: Vec<(&PlaneTarget, &Pair)> = request
        .targets
        .iter()
        .zip(searched.adjusted.model.pairs)
        .zip(&searched.accepted)
        .filter_map(|(both, accepted)| accepted.then_some(both))
        .collect();
    let rows: Vec<TableRow> = accepted
        .iter()
        .map(|(target, pair)| {
            let [x, y] = target.measured_mm;
            let less = |homography| {
                let [u, v] = apply(homography, pair.plane);
                [x - u, y - v]
            };
            TableRow {
                target: target.target.clone(),
                measured_mm: target.measured_mm,
                distortion_mm: less(&homographies.table),
                of_camera_mm: less(&searched.adjusted.model.homography),
            }
        })
        .collect();
    let points: Vec<[f64; 2]> = rows.iter().map(|row| row.measured_mm).collect();
    let values: Vec<[f64; 2]> = rows.iter().map(|row| row.distortion_mm).collect();
    let plane: Vec<[f64; 2]> = accepted.iter().map(|(_, pair)| pair.plane).collect();
    let main = main_term(&points, &values, request.camera.principal_point_mm);
    let (main_term, remainder) = main.unzip();
    let table = InterpolatedTable::new(points, values, &plane);
    let remainder = remainder.map(|values| table.with_values(values));
    Dlt2d {
        focus: request.focus.clone(),
        result: result(request, homographies, &gauge),
        rows,
        gauge,
        eight: eight(homographies),
        main_term,
        table,
        remainder,
    }
}

/// Returns l1 to l8 of the table's homography, metres to mm.
#[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
fn eight(homographies: &Homographies<'_>) -> Option<[f64; EIGHT]> {
    let matrix = homographies.table * homographies.plane;
    let [[a, d, g], [b, e, h], [c, f, last]] = matrix.data.0;
    let size = matrix.row(2).norm();
    (last.abs() > 1e-9 * size).then(|| [-a, -b, -c, -d, -e, -f, g, h].map(|element| element / last))
}

fn result(
    request: &Dlt2dRequest<'_>,
    homographies: &Homographies<'_>,
    gauge: &Gauge,
) -> CalibrationResult {
    let searched = &homographies.searched;
    let adjusted = &searched.adjusted;
    let lens = &adjusted.model.lens;
    let [x0, y0] = lens.principal_point_mm;
    let mut parameters = vec![
        ParameterEstimate::held("principal_distance_mm", lens.principal_distance_mm),
        ParameterEstimate::held("x0_mm", x0),
        ParameterEstimate::held("y0_mm", y0),
    ];
    let [k1, k2, k3] = lens.radial;
    let [p1, p2] = lens.decentring;
    let values = [k1, k2, k3, p1, p2];
    for ((name, value), is_estimated) in COEFFICIENT_NAMES
        .into_iter()
        .zip(values)
        .zip(request.is_estimated)
    {
        parameters.push(if is_estimated {
            ParameterEstimate::estimated(name, None, value)
        } else {
            ParameterEstimate::held(name, value)
        });
    }
    let count = adjusted.model.coefficients().count();
    let cofactors = DMatrix::from_fn(count, count, |row, column| {
        let place = (EIGHT + row, EIGHT + column);
        adjusted.cofactors.get(place).copied().unwrap_or(0.0)
    });
    let image = request.focus.clone().unwrap_or_else(|| Arc::from("1"));
    let residuals: Vec<ImageResidual> = request
        .targets
        .iter()
        .zip(&searched.tested)
        .zip(&searched.accepted)
        .map(|((target, tested), accepted)| ImageResidual {
            line: target.line,
            image: image.clone(),
            point: target.target.clone(),
            measured_mm: target.measured_mm,
            components: *tested,
            is_rejected: !accepted,
        })
        .collect();
    let accepted = residuals.iter().filter(|one| !one.is_rejected).count();
    let mut result = CalibrationResult {
        method: "dlt2d",
        camera: request.camera.clone(),
        calibrated: StaticCalibration {
            principal_distance_mm: lens.principal_distance_mm,
            principal_point_mm: lens.principal_point_mm,
            distortion: DistortionTable {
                k1,
                k2,
                k3,
                p1,
                p2,
                ..request.camera.distortion.measured_minus_ideal()
            },
            flatness_um: None,
        },
        inputs: vec![request.input.clone()],
        parameters,
        cofactors,
        sigma0: adjusted.sigma0,
        has_sigma: request.has_sigma,
        groups: vec![ObservationGroup::of_image_points(&residuals)],
        datum: "the plane coordinates of the targets; a homography between plane and image is free"
            .to_owned(),
        observations: 2 * accepted,
        unknowns: EIGHT + count,
        constraints: 0,
        iterations: adjusted.iterations,
        critical_value: searched.critical,
        warnings: Vec::new(),
        notes: notes(request, gauge),
        image_residuals: residuals,
        other_residuals: Vec::new(),
        images: Vec::new(),
        points: Vec::new(),
    };
    result.warnings.extend(rejection_warning(&result));
    result.warnings.extend(result.coverage().warning());
    let warnings = result.correlation_warnings();
    result.warnings.extend(warnings);
    for name in request.corners.into_iter().flatten() {
        let corner = result
            .image_residuals
            .iter()
            .find(|one| *one.point == **name);
        if corner.is_some_and(|one| one.is_rejected) {
            result.warnings.push(format!(
                "corner {name} does not fit the other targets; the whole table has its error"
            ));
        }
    }
    result
}

fn notes(request: &Dlt2dRequest<'_>, gauge: &Gauge) -> Vec<String> {
    let [x0, y0] = gauge.principal_point_mm;
    let [b1, b2] = gauge.affinity;
    let how = match request.corners {
        Some(names) => format!("zero at the corners {}", names.join(", ")),
        None => "the least one, by least squares of all targets".to_owned(),
    };
    vec![
        "f and principal point are those of the camera file: one image of a plane cannot determine them".to_owned(),
        "so are K0, B1 and B2, which the homography would take".to_owned(),
        format!(
            "table.csv is {how}; it belongs to f = {:.6} mm, (x0, y0) = ({x0:.6}, {y0:.6}) mm, B1 = {b1:.3e}, B2 = {b2:.3e}, the optical axis turned by {:.6}°, and to no other interior orientation",
            gauge.principal_distance_mm, gauge.axis_deg
        ),
    ]
}
