//! Reports of a 2-D direct linear transformation.

use fmc_adjustment::calibration::dlt2d::distortion_table::{Dlt2d, InterpolationError};
use fmc_adjustment::calibration::dlt2d::interpolation::CrossValidation;
use serde_json::{Map, Value, json};

use super::dlt2d_figures;
use super::result::files::FilesError;
use super::result::of_method::{OfMethod, PageTable};

/// Returns the content of the reports that belongs to this method alone.
///
/// # Errors
/// [`FilesError`] if a figure or the table fails.
pub fn of_method(found: &Dlt2d) -> Result<OfMethod, FilesError> {
    let interpolation = found.interpolation();
    Ok(OfMethod {
        summary: summary(found, &interpolation),
        tables: tables(found, &interpolation),
        figures: dlt2d_figures::figures(found)?,
        files: vec![("table.csv".to_owned(), table_csv(found)?)],
    })
}

fn summary(found: &Dlt2d, interpolation: &[InterpolationError]) -> Map<String, Value> {
    let gauge = found.gauge;
    let [x0, y0] = gauge.principal_point_mm;
    let [b1, b2] = gauge.affinity;
    let mut summary = Map::new();
    let mut put = |key: &str, value: Value| summary.insert(key.to_owned(), value);
    put("focus", json!(found.focus.as_deref()));
    put("targets_in_table", json!(found.rows.len()));
    put(
        "gauge",
        json!({
            "principal_distance_mm": gauge.principal_distance_mm,
            "x0_mm": x0,
            "y0_mm": y0,
            "b1": b1,
            "b2": b2,
            "axis_deg": gauge.axis_deg,
        }),
    );
    put("l", json!(found.eight));
    put("main_term", json!(found.main_term));
    let errors = |found: Option<CrossValidation>| {
        found.map(|found| {
            json!({
                "targets": found.targets,
                "max_um": 1e3 * found.largest_mm,
                "rms_um": 1e3 * found.rms_mm,
            })
        })
    };
    let list: Vec<Value> = interpolation
        .iter()
        .map(|one| {
            json!({
                "name": one.interpolator.name(),
                "of_table": errors(one.of_table),
                "after_main_term": errors(one.of_remainder),
            })
        })
        .collect();
    put("interpolation", json!(list));
    summary
}

fn table_csv(found: &Dlt2d) -> csv::Result<Vec<u8>> {
    let mut file = csv::Writer::from_writer(Vec::new());
    file.write_record(["target", "x_mm", "y_mm", "dx_um", "dy_um"])?;
    for row in &found.rows {
        let [x, y] = row.measured_mm;
        let [dx, dy] = row.distortion_mm.map(|mm| format!("{:.9}", 1e3 * mm + 0.0));
        file.write_record([
            &*row.target,
            &format!("{x:.12}"),
            &format!("{y:.12}"),
            &dx,
            &dy,
        ])?;
    }
    file.into_inner()
        .map_err(|error| csv::Error::from(error.into_error()))
}

/// Returns the tables of the terminal and the page.
#[must_use]
pub fn tables(found: &Dlt2d, interpolation: &[InterpolationError]) -> Vec<PageTable> {
    let gauge = found.gauge;
    let [x0, y0] = gauge.principal_point_mm;
    let [b1, b2] = gauge.affinity;
    let pair = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![
        pair("f, mm", format!("{:.6}", gauge.principal_distance_mm)),
        pair("x0, mm", format!("{x0:.6}")),
        pair("y0, mm", format!("{y0:.6}")),
        pair("B1", format!("{b1:.3e}")),
        pair("B2", format!("{b2:.3e}")),
        pair("axis turned by, °", format!("{:.6}", gauge.axis_deg)),
    ];
    if let Some(k) = found.main_term {
        let names = ["k0 of (9)", "k1 of (9), mm⁻²", "k2 of (9), mm⁻⁴"];
        let named = names.into_iter().zip(k);
        rows.extend(named.map(|(name, value)| pair(name, format!("{value:.6e}"))));
    }
    if let Some(eight) = found.eight {
        let numbers = (1..).zip(eight);
        rows.extend(
            numbers.map(|(index, value)| pair(&format!("l{index}"), format!("{value:.9e}"))),
        );
    }
    let mut tables = vec![PageTable {
        title: "Interior orientation of the table".to_owned(),
        columns: vec![String::new(), "value".to_owned()],
        rows,
        caption: "The table is complete only with this interior orientation: taken with another, it is wrong. x + (l1·X + l2·Y + l3)/(l7·X + l8·Y + 1) = 0, y with l4 to l6; mm and m. (9): the main term of the table about the principal point of the camera file.".to_owned(),
    }];
    if !interpolation.is_empty() {
        tables.push(interpolation_table(interpolation));
    }
    tables
}

fn interpolation_table(interpolation: &[InterpolationError]) -> PageTable {
    let columns = ["", "max, µm", "rms", "after (9): max", "rms", "targets"];
    let rows = interpolation.iter().map(|one| {
        let numbers = |found: Option<CrossValidation>| {
            let of = |mm: fn(&CrossValidation) -> f64| {
                found
                    .as_ref()
                    .map_or_else(String::new, |found| format!("{:.4}", 1e3 * mm(found)))
            };
            [of(|found| found.largest_mm), of(|found| found.rms_mm)]
        };
        let mut row = vec![one.interpolator.name().to_owned()];
        row.extend(numbers(one.of_table));
        row.extend(numbers(one.of_remainder));
        row.push(one.of_table.map_or(0, |found| found.targets).to_string());
        row
    });
    PageTable {
        title: "Errors of interpolations, by cross-validation".to_owned(),
        rows: rows.collect(),
        columns: columns.map(str::to_owned).to_vec(),
        caption: "Each target from the others, at twice the distance between targets; between targets the errors are smaller. After (9): its main term is taken off first and added again.".to_owned(),
    }
}
