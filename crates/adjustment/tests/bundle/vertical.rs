//! Aerial images with too few control points for a resection: they are taken for vertical ones.

use std::collections::HashMap;

use fmc_adjustment::bundle::calibration::{BundleCalibration, CalibrationOptions};
use fmc_adjustment::bundle::pose::Pose;
use fmc_adjustment::bundle::tables::{
    ImagePointRow, NetworkTables, ObjectPointRow, RowRole, Table,
};
use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use nalgebra::Vector3;

use crate::data::ideal;

const F_MM: f64 = 100.0;
const HALF_MM: [f64; 2] = [45.0, 30.0];

/// Two strips of three images with tilts of up to 3°, to and fro.
fn poses() -> Vec<Pose> {
    (0..6)
        .map(|number| {
            let (strip, place) = (number / 3, f64::from(number % 3));
            let tilt = |degrees: [f64; 6]| degrees[usize::try_from(number).unwrap()].to_radians();
            let yaw = if strip == 0 { 0.0 } else { 180.0_f64 };
            Pose::from(ExteriorOrientation {
                position_m: [
                    600.0 * f64::from(strip),
                    250.0 * place,
                    1200.0 + 5.0 * place,
                ],
                attitude: [
                    tilt([1.5, -2.5, 0.5, 3.0, -1.0, 2.0]),
                    tilt([-2.0, 1.0, 2.5, -0.5, 3.0, -3.0]),
                    yaw.to_radians() + tilt([2.0, -4.0, 1.0, 3.0, -2.0, 0.5]),
                ],
            })
        })
        .collect()
}

fn ground() -> Vec<Vector3<f64>> {
    (0..12)
        .flat_map(|row| (0..14).map(move |column| (f64::from(row), f64::from(column))))
        .map(|(row, column)| {
            let (x, y) = (-400.0 + 110.0 * column, -300.0 + 95.0 * row);
            Vector3::new(x, y, 40.0 * (x / 170.0).sin() * (y / 130.0).cos())
        })
        .collect()
}

/// Returns exact image points without any image's orientation, `control` among the points.
fn tables(control: &[usize]) -> NetworkTables {
    let mut rows = Vec::new();
    for (point, ground) in ground().iter().enumerate() {
        let rays: Vec<_> = poses()
            .iter()
            .enumerate()
            .filter_map(|(image, pose)| {
                let u = pose.in_camera(ground);
                let [x, y] = [-F_MM * u.x / u.z, -F_MM * u.y / u.z];
                let is_seen = x.abs() < HALF_MM[0] && y.abs() < HALF_MM[1];
                is_seen.then_some((image, [x, y]))
            })
            .collect();
        if rays.len() > 1 || control.contains(&point) {
            rows.extend(rays.into_iter().map(|(image, measured_mm)| ImagePointRow {
                line: 0,
                image: format!("i{image}").into(),
                point: format!("p{point}").into(),
                measured_mm,
                by_grids_mm: [0.0; 2],
                sigma_mm: Some(1e-3),
            }));
        }
    }
    NetworkTables {
        image_points: Table {
            file: "image_points.csv".to_owned(),
            rows,
        },
        object_points: Table {
            file: "control.csv".to_owned(),
            rows: control
                .iter()
                .map(|&number| ObjectPointRow {
                    line: 0,
                    point: format!("p{number}").into(),
                    position_m: ground()[number].into(),
                    sigmas_m: [0.0; 3],
                    role: RowRole::Control,
                })
                .collect(),
        },
        images: None,
        scale_bars: None,
        stages: HashMap::new(),
    }
}

/// Control points of which no image shows more than three, and some image two.
fn few() -> Vec<usize> {
    let shown = |chosen: &[usize]| {
        let rows = tables(chosen).image_points.rows;
        let of = |image: usize| {
            let name = format!("i{image}");
            let own = rows.iter().filter(|row| *row.image == *name);
            own.filter(|row| {
                chosen
                    .iter()
                    .any(|point| *row.point == *format!("p{point}"))
            })
            .count()
        };
        (0..6).map(of).collect::<Vec<_>>()
    };
    let mut chosen = Vec::new();
    for point in (0..ground().len()).rev() {
        let more = [&chosen[..], &[point]].concat();
        let counts = shown(&more);
        let before = shown(&chosen);
        if counts.iter().all(|count| *count <= 3) && counts != before {
            chosen = more;
        }
    }
    let counts = shown(&chosen);
    assert!(counts.iter().all(|count| *count <= 3), "{counts:?}");
    assert!(counts.iter().any(|count| *count >= 2), "{counts:?}");
    chosen
}

#[test]
fn block_in_which_no_image_shows_four_control_points_is_oriented() {
    let tables = tables(&few());
    let options = CalibrationOptions::default();
    let found = BundleCalibration::new(&tables, ideal(F_MM), &options).unwrap();
    let network = &found.snooped.network;
    assert_eq!(network.images.len(), 6);
    for (image, pose) in network
        .images
        .iter()
        .zip(&found.snooped.solution.state.poses)
    {
        let number: usize = image.name[1..].parse().unwrap();
        let truth = &poses()[number];
        assert!(
            (pose.position_m - truth.position_m).norm() < 1e-5,
            "{}",
            image.name
        );
        let turn = pose.rotation.matrix() - truth.rotation.matrix();
        assert!(turn.norm() < 1e-8, "{}", image.name);
    }
}

#[test]
fn image_that_shows_one_control_point_alone_is_named() {
    let mut tables = tables(&few());
    // Its other points are those of no other image.
    for row in &mut tables.image_points.rows {
        if *row.image == *"i0" {
            row.point = format!("own-{}", row.point).into();
        }
    }
    let options = CalibrationOptions::default();
    let error = BundleCalibration::new(&tables, ideal(F_MM), &options).unwrap_err();
    assert!(error.to_string().contains("i0"), "{error}");
}
