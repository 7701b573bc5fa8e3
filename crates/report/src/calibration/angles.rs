//! Reports of a calibration by precise angles.

use fmc_adjustment::calibration::angles::Angles;
use fmc_adjustment::calibration::angles::line_group::{DistortionRow, LineGroup, Method};
use plotters::element::{PathElement, Text};
use plotters::prelude::{Color, RGBColor};
use serde_json::{Map, Value, json};

use super::result::files::FilesError;
use super::result::of_method::{Figure, OfMethod, PageTable};
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, INK, TITLE, WIDTH, text};
use crate::legend::{self, Entry, Mark};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 640);
/// Name, colour and value, mm, of a curve.
type Curve = (&'static str, RGBColor, fn(&DistortionRow) -> f64);

/// The curves, in Okabe and Ito's palette.
const CURVES: [Curve; 3] = [
    ("about the best fit (2)", RGBColor(0, 114, 178), |row| {
        row.best_fit_mm
    }),
    ("about the paraxial f0 (6)", RGBColor(213, 94, 0), |row| {
        row.paraxial_mm
    }),
    ("exact model", RGBColor(0, 158, 115), |row| row.exact_mm),
];

/// Returns the content of the reports that belongs to this method alone.
///
/// # Errors
/// [`FilesError`] if the figure or the table fails.
pub fn of_method(found: &Angles) -> Result<OfMethod, FilesError> {
    let mut summary = Map::new();
    summary.insert("methods".to_owned(), methods_json(&found.all));
    let bands: Vec<Value> = found.bands.iter().map(band_json).collect();
    summary.insert("bands".to_owned(), json!(bands));
    summary.insert(
        "largest_relative_distortion".to_owned(),
        json!(found.all.largest_relative),
    );
    summary.insert(
        "repeatability_um".to_owned(),
        json!(found.all.repeatability_mm.map(|mm| 1e3 * mm)),
    );
    summary.insert(
        "budget".to_owned(),
        json!(found.all.rows.last().map(budget)),
    );
    let mut tables = tables(found);
    tables.push(distortion_table(&found.all));
    Ok(OfMethod {
        summary,
        tables,
        figures: vec![Figure {
            file_name: "distortion.svg".to_owned(),
            caption: "Distortion along the line about the best-fit principal distance, about the paraxial one, and by the exact model. The best fit hides distortion.".to_owned(),
            svg: curves(found)?,
        }],
        files: vec![("distortion.csv".to_owned(), distortion_csv(found)?)],
    })
}

fn budget(row: &DistortionRow) -> Value {
    json!({
        "angle_deg": row.angle_deg,
        "printed_um": 1e3 * row.budget.printed_mm,
        "mended_um": 1e3 * row.budget.mended_mm,
        "covariance_um": 1e3 * row.budget.covariance_mm,
    })
}

fn methods_json(group: &LineGroup) -> Value {
    let of_method = |method: &Method| {
        let parameters: Vec<Value> = method
            .parameters
            .iter()
            .map(|one| json!({"name": one.name, "value": one.value, "sigma": one.sigma}))
            .collect();
        json!({"name": method.name, "parameters": parameters})
    };
    json!(group.methods.iter().map(of_method).collect::<Vec<_>>())
}

fn band_json(group: &LineGroup) -> Value {
    let exact = group.methods.iter().find(|method| method.name == "exact");
    let parameters: Vec<Value> = exact
        .into_iter()
        .flat_map(|method| &method.parameters)
        .map(|one| json!({"name": one.name, "value": one.value, "sigma": one.sigma}))
        .collect();
    json!({
        "name": group.band.as_deref(),
        "parameters": parameters,
        "methods": methods_json(group),
        "largest_relative_distortion": group.largest_relative,
        "repeatability_um": group.repeatability_mm.map(|mm| 1e3 * mm),
    })
}

/// Returns the tables of methods and bands, for terminal and page.
#[must_use]
pub fn tables(found: &Angles) -> Vec<PageTable> {
    let mut tables = vec![PageTable {
        title: "Methods side by side".to_owned(),
        columns: ["", "f, mm", "σ, µm", "p, mm", "σ, µm"].map(str::to_owned).to_vec(),
        rows: found.all.methods.iter().map(method_row).collect(),
        caption: "Numbers in brackets are equations of Li et al. 2018; (4) with f of the camera file. σ for the given uncertainties of places and angles, without bias: on a lens of large distortion f of (2) and (3) is a best fit, p of (2) up to several times too large, and the quartic has a bias of the lens.".to_owned(),
    }];
    if !found.bands.is_empty() {
        let rows = found.bands.iter().map(|group| {
            let name = group.band.as_deref().unwrap_or_default().to_owned();
            let exact = group.methods.iter().find(|method| method.name == "exact");
            let value = |name: &str| {
                let found = exact?.parameters.iter().find(|one| one.name == name)?;
                Some(found.value)
            };
            let written = |value: Option<f64>, decimals: usize| {
                value.map_or_else(String::new, |value| format!("{value:.decimals$}"))
            };
            vec![
                name,
                written(value("principal_distance_mm"), 4),
                written(value("p_mm"), 4),
                format!("{:.3}", 100.0 * group.largest_relative),
                written(group.repeatability_mm.map(|mm| 1e3 * mm), 2),
            ]
        });
        tables.push(PageTable {
            title: "Bands".to_owned(),
            rows: rows.collect(),
            columns: ["band", "f, mm", "p, mm", "largest, %", "repeated, µm"]
                .map(str::to_owned)
                .to_vec(),
            caption: "f and p of the exact model. Largest: relative distortion about the paraxial f0, as in table 1 of Li et al. Repeated: σ of the distortion of one measurement, from the repetitions.".to_owned(),
        });
    }
    tables
}

fn method_row(method: &Method) -> Vec<String> {
    let cells = |name: &str| {
        let found = method.parameters.iter().find(|one| one.name == name);
        [
            found.map_or_else(String::new, |one| format!("{:.6}", one.value)),
            found
                .and_then(|one| one.sigma)
                .map_or_else(String::new, |sigma| format!("{:.2}", 1e3 * sigma)),
        ]
    };
    let mut row = vec![method.name.to_owned()];
    row.extend(cells("principal_distance_mm"));
    row.extend(cells("p_mm"));
    row
}

fn numbers(row: &DistortionRow) -> [f64; 6] {
    [
        row.best_fit_mm,
        row.paraxial_mm,
        row.exact_mm,
        row.budget.printed_mm,
        row.budget.mended_mm,
        row.budget.covariance_mm,
    ]
    .map(|mm| 1e3 * mm)
}

fn distortion_table(group: &LineGroup) -> PageTable {
    let columns = [
        "W, °",
        "L, mm",
        "best fit, µm",
        "paraxial, µm",
        "exact, µm",
        "σ printed",
        "σ mended",
        "σ covariance",
    ];
    let rows = group.rows.iter().map(|row| {
        let mut cells = vec![format!("{:.4}", row.angle_deg), format!("{:.4}", row.l_mm)];
        cells.extend(numbers(row).map(|um| format!("{um:.2}")));
        cells
    });
    PageTable {
        title: "Distortion along the line".to_owned(),
        rows: rows.collect(),
        columns: columns.map(str::to_owned).to_vec(),
        caption: "D of (1) about f and p of (2), about f0 of the quartic with p of (2), and of the exact model at the measured place. σ: budget (7) as printed, with its misprints mended, and from the covariance of D about the quartic's f0; without bias, and without the collimating lens.".to_owned(),
    }
}

fn distortion_csv(found: &Angles) -> csv::Result<Vec<u8>> {
    let mut file = csv::Writer::from_writer(Vec::new());
    file.write_record([
        "band",
        "angle_deg",
        "l_mm",
        "best_fit_um",
        "paraxial_um",
        "exact_um",
        "sigma_printed_um",
        "sigma_mended_um",
        "sigma_covariance_um",
    ])?;
    for group in std::iter::once(&found.all).chain(&found.bands) {
        for row in &group.rows {
            let mut cells = vec![
                group.band.as_deref().unwrap_or("all").to_owned(),
                row.angle_deg.to_string(),
                row.l_mm.to_string(),
            ];
            cells.extend(numbers(row).map(|um| format!("{um:.6}")));
            file.write_record(cells)?;
        }
    }
    file.into_inner()
        .map_err(|error| csv::Error::from(error.into_error()))
}

fn curves(found: &Angles) -> Result<String, FigureError> {
    let rows = &found.all.rows;
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Err(FigureError::NothingToDraw);
    };
    let largest = rows
        .iter()
        .flat_map(|row| CURVES.map(|(_, _, value)| 1e3 * value(row).abs()))
        .filter(|value| value.is_finite())
        .fold(1e-6, f64::max);
    let range = 1.03 * first.angle_deg..1.03 * last.angle_deg;
    figure::svg(SIZE, |canvas| {
        let title = format!("{}: distortion along the line", found.result.camera.name);
        canvas.draw(&Text::new(title, (20, 28), text(TITLE)))?;
        let entries = CURVES.map(|(words, colour, _)| Entry {
            mark: Mark::Line(5),
            colour,
            words,
        });
        let top = 46 + legend::height(&entries);
        legend::draw(canvas, [legend::LEFT, 62], &entries)?;
        let axes = Axes {
            margins: Margins {
                top,
                right: 30,
                left: 20,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: 76,
                labels: None,
                write: &|degrees| wording::decimals(*degrees, 2),
                name: "angle W, °",
            },
            y: Axis {
                room: 110,
                labels: None,
                write: &|um| wording::decimals(*um, 6),
                name: "distortion, µm",
            },
        };
        let mut chart = axes.draw(canvas, range.clone(), -1.1 * largest..1.1 * largest)?;
        let zero = [(range.start, 0.0), (range.end, 0.0)];
        chart.draw_series([PathElement::new(zero, INK.stroke_width(1))])?;
        for (_, colour, value) in CURVES {
            let line: Vec<(f64, f64)> = rows
                .iter()
                .map(|row| (row.angle_deg, 1e3 * value(row)))
                .filter(|(_, um)| um.is_finite())
                .collect();
            chart.draw_series([PathElement::new(line, colour.stroke_width(3))])?;
        }
        Ok(())
    })
}
