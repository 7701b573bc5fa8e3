//! Reports of a calibration of residual grids.

use fmc_adjustment::grid::calibrated_grid::CalibratedGrid;
use fmc_adjustment::grid::calibration::{GridCalibration, TableErrors};
use serde_json::{Map, Value, json};

use super::result::files::FilesError;
use super::result::of_method::{Figure, OfMethod, PageTable};
use crate::arrow::Arrow;
use crate::arrow_field::ArrowField;
use crate::figure::FigureError;
use crate::wording;

/// Arrows along the longer side of a figure of a grid.
const ARROWS: u32 = 24;

/// Returns the content of the reports that belongs to this method alone.
///
/// # Errors
/// [`FilesError`] if a figure fails.
pub fn of_method(found: &GridCalibration) -> Result<OfMethod, FilesError> {
    let mut figures = vec![left_by_polynomial(found)?];
    for grid in &found.grids {
        figures.push(of_grid(found, grid)?);
    }
    Ok(OfMethod {
        summary: summary(found),
        tables: vec![residuals(found), grids(found)],
        figures,
        files: Vec::new(),
    })
}

fn summary(found: &GridCalibration) -> Map<String, Value> {
    let errors = |errors: TableErrors| {
        json!({
            "max_um": 1e3 * errors.largest_mm,
            "rms_um": 1e3 * errors.rms_mm,
        })
    };
    let grids: Vec<Value> = found
        .grids
        .iter()
        .map(|grid| {
            let [columns, rows] = grid.lattice.sides();
            json!({
                "frame": grid.key(),
                "file": grid.file_name(),
                "crc32": format!("{:08x}", grid.crc32()),
                "columns": columns,
                "rows": rows,
                "first_node_mm": grid.lattice.first_mm(),
                "pitch_mm": grid.lattice.pitch_mm(),
                "bytes": grid.bytes.len(),
                "largest_um": 1e3 * grid.largest_mm,
                "slope": grid.slope,
            })
        })
        .collect();
    let mut summary = Map::new();
    let mut put = |key: &str, value: Value| summary.insert(key.to_owned(), value);
    put("grids", json!(grids));
    put("polynomial_alone", errors(found.of_polynomial));
    put("polynomial_and_grid", errors(found.of_camera));
    put("largest_sigma_um", json!(1e3 * found.largest_sigma_mm));
    summary
}

fn residuals(found: &GridCalibration) -> PageTable {
    let row = |name: &str, errors: TableErrors| {
        let numbers = [errors.largest_mm, errors.rms_mm];
        let mut row = vec![name.to_owned()];
        row.extend(numbers.map(|mm| format!("{:.2}", 1e6 * mm)));
        row
    };
    PageTable {
        title: "Residuals of the table".to_owned(),
        columns: ["", "largest, nm", "rms, nm"].map(str::to_owned).to_vec(),
        rows: vec![
            row("best polynomial alone", found.of_polynomial),
            row("camera: polynomial and grid", found.of_camera),
        ],
        caption: format!(
            "Along an axis; the camera has coefficients of 16 bits. σ of the distortion that it computes is at most {:.2} nm at a row of the table.",
            1e6 * found.largest_sigma_mm
        ),
    }
}

fn grids(found: &GridCalibration) -> PageTable {
    let columns = [
        "grid",
        "nodes",
        "pitch, mm",
        "largest, nm",
        "slope",
        "bytes",
        "crc32",
    ];
    let rows = found.grids.iter().map(|grid| {
        let [columns, rows] = grid.lattice.sides();
        vec![
            grid.key().to_owned(),
            format!("{columns} x {rows}"),
            grid.lattice.pitch_mm().to_string(),
            format!("{:.0}", 1e6 * grid.largest_mm),
            format!("{:.1e}", grid.slope),
            grid.bytes.len().to_string(),
            format!("{:08x}", grid.crc32()),
        ]
    });
    PageTable {
        title: "Residual grids".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
        caption: "A grid of the lens moves with the principal point, one of the sensor does not. Largest coefficient, which no displacement exceeds; bound of the slope.".to_owned(),
    }
}

/// Draws what the best polynomial leaves.
fn left_by_polynomial(found: &GridCalibration) -> Result<Figure, FigureError> {
    let arrows: Vec<Arrow> = found
        .result
        .image_residuals
        .iter()
        .zip(&found.left_by_polynomial_mm)
        .map(|(row, left)| Arrow {
            from_mm: row.measured_mm,
            displacement_mm: *left,
        })
        .collect();
    let rows = wording::counted(arrows.len(), "row");
    let svg = field(found, &arrows, "Left by the best polynomial", &rows)?;
    Ok(Figure {
        file_name: "left-by-polynomial.svg".to_owned(),
        caption: "Left of the table by the best polynomial without a grid.".to_owned(),
        svg,
    })
}

/// Draws the displacement of a grid over the sensor.
fn of_grid(found: &GridCalibration, grid: &CalibratedGrid) -> Result<Figure, FigureError> {
    let [half_x, half_y] = found.result.camera.half_format_mm();
    let step = 2.0 * half_x.max(half_y) / f64::from(ARROWS);
    let along = |half: f64| {
        let places = (0..=ARROWS).map(move |index| (f64::from(index) + 0.5) * step - half);
        places.take_while(move |place| *place < half)
    };
    let arrows: Vec<Arrow> = along(half_y)
        .flat_map(|y| along(half_x).map(move |x| [x, y]))
        .map(|from_mm| Arrow {
            from_mm,
            displacement_mm: grid.spline.displacement(from_mm),
        })
        .collect();
    let [columns, rows] = grid.lattice.sides();
    let nodes = format!("{columns} x {rows} nodes");
    let svg = field(
        found,
        &arrows,
        &format!("Residual grid of the {}", grid.key()),
        &nodes,
    )?;
    Ok(Figure {
        file_name: format!("grid-{}.svg", grid.key()),
        caption: format!(
            "Displacement that the grid of the {} adds to the polynomial, measured − ideal.",
            grid.key()
        ),
        svg,
    })
}

fn field(
    found: &GridCalibration,
    arrows: &[Arrow],
    title: &str,
    counted: &str,
) -> Result<String, FigureError> {
    let camera = &found.result.camera;
    ArrowField {
        titles: [title.to_owned(), format!("{}: {counted}", camera.name)],
        format_mm: camera.half_format_mm().map(|half| 2.0 * half),
        axis: camera.fmc.axis.name(),
        arrows,
    }
    .svg()
}
