//! Files that do not determine a calibration.

use fmc_adjustment::bundle::calibration::{BundleCalibration, CalibrationOptions};
use fmc_adjustment::bundle::interior::{Interior, InteriorElement};
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::tables::{
    ImagePointRow, NetworkTables, ObjectPointRow, RowRole, Table,
};

use crate::data::{ideal, tables};
use crate::simulated::{Shape, Simulated};

fn checkerboard() -> NetworkTables {
    tables("checkerboard", [640.0, 480.0, 10.0])
}

fn camcal() -> NetworkTables {
    tables("camcal", [2272.0, 1704.0, 3.191_103_286_384_976_6])
}

fn options(symbols: &str) -> CalibrationOptions {
    let estimated = symbols
        .split(',')
        .map(|symbol| Parameter::Interior(InteriorElement::from_symbol(symbol).unwrap()))
        .collect();
    CalibrationOptions {
        unknowns: Unknowns {
            estimated,
            priors: Vec::new(),
        },
        ..CalibrationOptions::default()
    }
}

/// Checks that the message of the refusal has all words.
fn refused(tables: &NetworkTables, start: Interior, symbols: &str, words: &[&str]) {
    let error = BundleCalibration::new(tables, start, &options(symbols))
        .unwrap_err()
        .to_string();
    for word in words {
        assert!(error.contains(word), "{word} not in: {error}");
    }
}

#[test]
fn point_in_one_image_alone() {
    let mut tables = camcal();
    let mut kept = false;
    tables
        .image_points
        .rows
        .retain(|row| &*row.point != "75" || !std::mem::replace(&mut kept, true));
    refused(
        &tables,
        ideal(7.5),
        "f",
        &["image_points.csv", "point 75", "one image alone"],
    );
}

#[test]
fn image_without_control() {
    let mut tables = camcal();
    let mut row = tables.image_points.rows[0].clone();
    for (image, point) in [("X", "2"), ("X", "3"), ("X", "4")] {
        row.image = image.into();
        row.point = point.into();
        tables.image_points.rows.push(row.clone());
    }
    refused(&tables, ideal(7.5), "f", &["image X", "neither"]);
}

#[test]
fn names_twice() {
    let mut tables = checkerboard();
    tables
        .image_points
        .rows
        .push(tables.image_points.rows[3].clone());
    refused(&tables, ideal(8.0), "f", &["lines 5 and 5", "twice"]);
    let mut tables = checkerboard();
    tables
        .object_points
        .rows
        .push(tables.object_points.rows[3].clone());
    refused(
        &tables,
        ideal(8.0),
        "f",
        &["object_points.csv", "point 4 appears twice"],
    );
}

#[test]
fn sigma_that_is_none() {
    for sigma in [0.0, -1e-3, f64::NAN] {
        let mut tables = checkerboard();
        tables.image_points.rows[7].sigma_mm = Some(sigma);
        refused(&tables, ideal(8.0), "f", &["line 9", "greater than 0"]);
        if sigma != 0.0 {
            let mut tables = checkerboard();
            tables.object_points.rows[7].sigmas_m[1] = sigma;
            refused(&tables, ideal(8.0), "f", &["line 9", "sigma_y_m", "held"]);
        }
    }
}

#[test]
fn groups_that_share_no_point() {
    let mut tables = camcal();
    // Images 11 and above get points of their own, two of them control.
    for row in &mut tables.image_points.rows {
        if row.image.parse::<u32>().unwrap() > 10 {
            row.point = format!("b{}", row.point).into();
        }
    }
    let mut more = tables.object_points.rows.clone();
    for row in &mut more {
        row.point = format!("b{}", row.point).into();
    }
    tables.object_points.rows.extend(more);
    for row in &mut tables.object_points.rows[4..] {
        row.role = RowRole::Approximate;
    }
    refused(&tables, ideal(7.5), "f", &["2 groups", "share no point"]);
}

#[test]
fn control_that_does_not_fit_is_named_by_point() {
    for error_m in [0.001, 0.005] {
        let mut tables = checkerboard();
        tables.object_points.rows[11].position_m[0] += error_m;
        let words = [
            "control that does not fit: point 12 by -0.00",
            "check point",
        ];
        refused(&tables, ideal(8.0), "f,x0,y0,k1,k2,p1,p2", &words);
    }
}

#[test]
fn inseparable_unknowns_are_named() {
    // One image of a plane: the principal distance, the principal point and the pose are one.
    let mut tables = checkerboard();
    tables.image_points.rows.retain(|row| &*row.image == "1");
    refused(
        &tables,
        ideal(8.0),
        "f,x0,y0",
        &["cannot tell", "principal_distance_mm"],
    );
}

#[test]
fn y_downwards_is_told_by_the_residuals() {
    let simulated = Simulated::new(Shape::RESECTION, 31);
    let network = &simulated.network;
    let image_points = network
        .image_points
        .iter()
        .zip(2..)
        .map(|(observed, line)| ImagePointRow {
            line,
            image: network.images[observed.image].name.as_str().into(),
            point: network.points[observed.point].name.as_str().into(),
            measured_mm: [observed.measured_mm[0], -observed.measured_mm[1]],
            by_grids_mm: [0.0; 2],
            sigma_mm: Some(observed.sigma_mm),
        })
        .collect();
    let object_points = network
        .points
        .iter()
        .zip(2..)
        .map(|(point, line)| ObjectPointRow {
            line,
            point: point.name.as_str().into(),
            position_m: point.given_m.into(),
            sigmas_m: [0.0; 3],
            role: RowRole::Control,
        })
        .collect();
    let tables = NetworkTables {
        image_points: Table {
            file: "image_points.csv".to_owned(),
            rows: image_points,
        },
        object_points: Table {
            file: "object_points.csv".to_owned(),
            rows: object_points,
        },
        images: None,
        scale_bars: None,
        stages: std::collections::HashMap::new(),
    };
    refused(
        &tables,
        ideal(50.0),
        "f,x0,y0",
        &["image_points.csv", "y_mm reversed", "upwards"],
    );
}
