//! Units and directions of axes that files have wrong, named by the pattern of the residuals.

use fmc_adjustment::bundle::calibration::{BundleCalibration, CalibrationOptions};
use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::tables::NetworkTables;

use crate::aerial::{CROSSED, F_MM, Flight, Platform};
use crate::data::{ideal, tables};

/// Foot, m.
const FOOT_M: f64 = 0.3048;

fn options() -> CalibrationOptions {
    let estimated = [
        InteriorElement::PrincipalDistance,
        InteriorElement::X0,
        InteriorElement::Y0,
        InteriorElement::K1,
    ];
    CalibrationOptions {
        unknowns: Unknowns {
            estimated: estimated.map(Parameter::Interior).to_vec(),
            priors: Vec::new(),
        },
        ..CalibrationOptions::default()
    }
}

/// Changes the files of a flight; with and without σ of positions and attitudes, the result names
/// the file and the mistake.
fn named(change: impl Fn(&mut NetworkTables), file: &str, words: &str) {
    for has_sigma in [true, false] {
        let mut tables = flight(has_sigma);
        change(&mut tables);
        let result = BundleCalibration::new(&tables, ideal(F_MM), &options());
        let error = result.unwrap_err().to_string();
        assert!(
            error.starts_with(file) && error.contains(words),
            "with σ {has_sigma}: {error}"
        );
    }
}

fn flight(has_sigma: bool) -> NetworkTables {
    let flight = Flight {
        strips: CROSSED.to_vec(),
        platform: Platform::default(),
        tilt_rad: 0.02,
        control: 12,
        stage: None,
    };
    let mut tables = flight.tables(11);
    if !has_sigma {
        for row in &mut tables.images.as_mut().unwrap().rows {
            row.sigmas = [None; 6];
        }
    }
    tables
}

#[test]
fn right_units_are_accepted() {
    for has_sigma in [true, false] {
        let tables = flight(has_sigma);
        let result = BundleCalibration::new(&tables, ideal(F_MM), &options()).unwrap();
        let sigma0 = result.snooped.solution.sigma0();
        assert!((sigma0 - 1.0).abs() < 0.1, "{sigma0}");
    }
}

#[test]
fn y_downwards_is_named() {
    named(
        |tables| {
            for row in &mut tables.image_points.rows {
                row.measured_mm[1] *= -1.0;
            }
        },
        "image_points.csv: ",
        "y_mm reversed",
    );
}

#[test]
fn radians_are_named() {
    named(
        |tables| {
            for row in &mut tables.images.as_mut().unwrap().rows {
                row.attitude_deg = row.attitude_deg.map(f64::to_radians);
            }
        },
        "images.csv: ",
        "as radians",
    );
}

#[test]
fn object_points_in_feet_are_named() {
    named(
        |tables| {
            for row in &mut tables.object_points.rows {
                row.position_m = row.position_m.map(|metres| metres / FOOT_M);
            }
        },
        "control.csv: ",
        "feet",
    );
}

#[test]
fn heights_in_feet_are_named() {
    named(
        |tables| {
            for row in &mut tables.object_points.rows {
                row.position_m[2] /= FOOT_M;
            }
        },
        "control.csv: ",
        "z_m as feet",
    );
}

#[test]
fn positions_in_feet_are_named() {
    named(
        |tables| {
            for row in &mut tables.images.as_mut().unwrap().rows {
                row.position_m = row.position_m.map(|metres| metres / FOOT_M);
            }
        },
        "images.csv: ",
        "feet",
    );
}

#[test]
fn heights_of_images_in_feet_are_named_or_without_influence() {
    for has_sigma in [true, false] {
        let mut tables = flight(has_sigma);
        for row in &mut tables.images.as_mut().unwrap().rows {
            row.position_m[2] /= FOOT_M;
        }
        let result = BundleCalibration::new(&tables, ideal(F_MM), &options());
        if has_sigma {
            let error = result.unwrap_err().to_string();
            assert!(
                error.starts_with("images.csv: ") && error.contains("z_m as feet"),
                "{error}"
            );
        } else {
            // Initial values are forgotten.
            let f = result.unwrap().snooped.solution.state.parameters.interior;
            assert!((f.principal_distance_mm - F_MM).abs() < 0.05);
        }
    }
}

#[test]
fn wrong_control_point_is_named_out_of_four() {
    let camcal = tables("camcal", [2272.0, 1704.0, 3.191_103_286_384_976_6]);
    let estimated = ["f", "x0", "y0", "k1", "k2", "k3", "p1", "p2"]
        .map(|symbol| Parameter::Interior(InteriorElement::from_symbol(symbol).unwrap()));
    let options = CalibrationOptions {
        unknowns: Unknowns {
            estimated: estimated.to_vec(),
            priors: Vec::new(),
        },
        ..CalibrationOptions::default()
    };
    let message = |place: usize, position_m: [f64; 3]| {
        let mut tables = camcal.clone();
        tables.object_points.rows[place].position_m = position_m;
        BundleCalibration::new(&tables, ideal(7.5), &options)
            .unwrap_err()
            .to_string()
    };
    // 1001 (0, 1, 0), 1002 (1, 1, 0), 1003 (0, 0, 0), 1004 (1, 0, 0).
    for (place, position_m, name) in [
        (2, [0.02, 0.0, 0.0], "1003"),
        (2, [0.0, 0.05, 0.0], "1003"),
        (3, [0.98, 0.0, 0.0], "1004"),
        (0, [0.0, 1.3, 0.0], "1001"),
        (1, [1.3, 1.0, 0.0], "1002"),
    ] {
        let error = message(place, position_m);
        let words = format!("does not fit: point {name} by");
        assert!(error.contains(&words), "{words} not in: {error}");
        assert!(!error.contains("too few"), "{error}");
    }
    // Swapped coordinates of 1004 are those of 1001.
    let error = message(3, [0.0, 1.0, 0.0]);
    assert!(
        error.contains("control points 1001 and 1004 have the same coordinates"),
        "{error}"
    );
    // Four heights of a square: any one of them may be wrong.
    let error = message(2, [0.0, 0.0, 0.03]);
    for word in ["1001", "1002", "1003", "1004", "too few control points"] {
        assert!(error.contains(word), "{word} not in: {error}");
    }
}
