//! Real data of `tests/data`, see its NOTICE.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use fmc_adjustment::bundle::interior::{Interior, InteriorElement};
use fmc_adjustment::bundle::network_of_tables::{TabledNetwork, Unknowns};
use fmc_adjustment::bundle::orientation::network_orientation::orient;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::tables::{
    ImagePointRow, NetworkTables, ObjectPointRow, RowRole, Table,
};

/// Returns the path of a file of a data set.
pub(crate) fn path(set: &str, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(set)
        .join(name)
}

type Row = HashMap<String, String>;

fn rows(set: &str, name: &str) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(path(set, name)).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

/// Reads the tables of a data set; pixels become millimetres of a sensor of this size.
pub(crate) fn tables(set: &str, [width, height, pixel_um]: [f64; 3]) -> NetworkTables {
    let image_points = rows(set, "image_points.csv");
    let object_points = rows(set, "object_points.csv");
    NetworkTables {
        image_points: Table {
            file: "image_points.csv".to_owned(),
            rows: image_points
                .iter()
                .zip(2..)
                .map(|(row, line)| {
                    let in_pixels = row.contains_key("col_px");
                    let pitch = pixel_um / 1000.0;
                    let measured_mm = if in_pixels {
                        [
                            (number(row, "col_px") - (width - 1.0) / 2.0) * pitch,
                            ((height - 1.0) / 2.0 - number(row, "row_px")) * pitch,
                        ]
                    } else {
                        [number(row, "x_mm"), number(row, "y_mm")]
                    };
                    let sigma_mm = if in_pixels {
                        number(row, "sigma_px") * pitch
                    } else {
                        number(row, "sigma_um") / 1000.0
                    };
                    ImagePointRow {
                        line,
                        image: row["image"].clone().into(),
                        point: row["point"].clone().into(),
                        measured_mm,
                        by_grids_mm: [0.0; 2],
                        sigma_mm: Some(sigma_mm),
                    }
                })
                .collect(),
        },
        object_points: Table {
            file: "object_points.csv".to_owned(),
            rows: object_points
                .iter()
                .zip(2..)
                .map(|(row, line)| ObjectPointRow {
                    line,
                    point: row["point"].clone().into(),
                    position_m: ["x_m", "y_m", "z_m"].map(|column| number(row, column)),
                    sigmas_m: ["sigma_x_m", "sigma_y_m", "sigma_z_m"]
                        .map(|column| number(row, column)),
                    role: match row["role"].as_str() {
                        "control" => RowRole::Control,
                        "check" => RowRole::Check,
                        _ => RowRole::Approximate,
                    },
                })
                .collect(),
        },
        images: None,
        scale_bars: None,
        stages: HashMap::new(),
    }
}

/// Returns a lens without distortion.
pub(crate) fn ideal(principal_distance_mm: f64) -> Interior {
    Interior {
        principal_distance_mm,
        principal_point_mm: [0.0; 2],
        k: [0.0; 4],
        p: [0.0; 2],
        b: [0.0; 2],
    }
}

/// Returns the oriented network of some tables.
pub(crate) fn oriented(tables: &NetworkTables, interior: Interior, symbols: &str) -> TabledNetwork {
    let estimated = symbols
        .split(',')
        .filter(|symbol| !symbol.is_empty())
        .map(|symbol| Parameter::Interior(InteriorElement::from_symbol(symbol).unwrap()))
        .collect();
    let unknowns = Unknowns {
        estimated,
        priors: Vec::new(),
    };
    let mut tabled = tables.network(interior, &unknowns).unwrap();
    let unoriented = orient(&mut tabled.network, tabled.known.clone());
    assert_eq!(unoriented.images, [0; 0]);
    assert_eq!(unoriented.points, [0; 0]);
    tabled
}

/// Returns the published answers of a data set.
pub(crate) fn answers(set: &str) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path(set, "answers.json")).unwrap()).unwrap()
}
