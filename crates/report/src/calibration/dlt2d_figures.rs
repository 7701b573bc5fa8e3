//! Figures 3 to 10 of Feng et al. for a distortion table.

use fmc_adjustment::calibration::dlt2d::distortion_table::{Dlt2d, TableRow};
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{Color, HSLColor};

use super::result::of_method::Figure;
use crate::arrow::Arrow;
use crate::arrow_field::ArrowField;
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, INK, OUTLINE, TITLE, WIDTH, pixels, text};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 600);
const EDGE: f64 = 30.0;
/// Height of the title of a map.
const HEAD: f64 = 80.0;

/// Quantity of a target, mm.
type Quantity = fn(&TableRow, [f64; 2]) -> f64;

/// Radial part of a displacement about the principal point.
fn radial([x, y]: [f64; 2], [dx, dy]: [f64; 2]) -> f64 {
    let r = x.hypot(y);
    if r > 0.0 { (x * dx + y * dy) / r } else { 0.0 }
}

fn about(row: &TableRow, [x0, y0]: [f64; 2]) -> [f64; 2] {
    let [x, y] = row.measured_mm;
    [x - x0, y - y0]
}

fn first([x, _]: [f64; 2]) -> f64 {
    x
}

fn second([_, y]: [f64; 2]) -> f64 {
    y
}

/// Draws the figures of the paper.
///
/// # Errors
/// [`FigureError`] without targets or if the drawing fails.
pub(super) fn figures(found: &Dlt2d) -> Result<Vec<Figure>, FigureError> {
    let figure = |number: u32, what: &str, svg: String| Figure {
        file_name: format!("figure-{number}.svg"),
        caption: format!("Fig. {number} of Feng et al.: {what}."),
        svg,
    };
    let radial_of_table: Quantity = |row, point| radial(about(row, point), row.distortion_mm);
    let radial_of_camera: Quantity = |row, point| radial(about(row, point), row.of_camera_mm);
    let x_of_table: Quantity = |row, _| first(row.distortion_mm);
    let y_of_table: Quantity = |row, _| second(row.distortion_mm);
    let x_of_camera: Quantity = |row, _| first(row.of_camera_mm);
    let radius: Quantity = |row, point| first(about(row, point)).hypot(second(about(row, point)));
    let x: Quantity = |row, point| first(about(row, point));
    Ok(vec![
        figure(
            3,
            "the distortion of the table over the sensor",
            vectors(found)?,
        ),
        figure(
            4,
            "its radial part Δr over the sensor",
            map(found, "Δr", radial_of_table)?,
        ),
        figure(5, "Δx over the sensor", map(found, "Δx", x_of_table)?),
        figure(6, "Δy over the sensor", map(found, "Δy", y_of_table)?),
        figure(
            7,
            "Δr against r about the interior orientation of the camera file",
            curve(found, ["r, mm", "Δr, µm"], radius, radial_of_camera)?,
        ),
        figure(
            8,
            "Δr against r in the table, sheared by the K0 of its gauge",
            curve(found, ["r, mm", "Δr, µm"], radius, radial_of_table)?,
        ),
        figure(
            9,
            "Δx against x about the interior orientation of the camera file",
            curve(found, ["x, mm", "Δx, µm"], x, x_of_camera)?,
        ),
        figure(
            10,
            "Δx against x in the table",
            curve(found, ["x, mm", "Δx, µm"], x, x_of_table)?,
        ),
    ])
}

fn vectors(found: &Dlt2d) -> Result<String, FigureError> {
    let camera = &found.result.camera;
    let arrows: Vec<Arrow> = found
        .rows
        .iter()
        .map(|row| Arrow {
            from_mm: row.measured_mm,
            displacement_mm: row.distortion_mm,
        })
        .collect();
    ArrowField {
        titles: [
            "Distortion table, measured − ideal".to_owned(),
            format!(
                "{}: {}",
                camera.name,
                wording::counted(arrows.len(), "target")
            ),
        ],
        format_mm: camera.half_format_mm().map(|half| 2.0 * half),
        axis: camera.fmc.axis.name(),
        arrows: &arrows,
    }
    .svg()
}

/// Draws a quantity as coloured squares at the targets: blue negative, red positive.
fn map(found: &Dlt2d, name: &str, quantity: Quantity) -> Result<String, FigureError> {
    let camera = &found.result.camera;
    let point = camera.principal_point_mm;
    let [half_x, half_y] = camera.half_format_mm();
    let values: Vec<f64> = found.rows.iter().map(|row| quantity(row, point)).collect();
    let largest = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    if values.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    let scale = (f64::from(WIDTH) - 2.0 * EDGE) / (2.0 * half_x);
    let size = (
        WIDTH,
        pixels(HEAD + 2.0 * EDGE + 2.0 * half_y * scale).unsigned_abs(),
    );
    let place = |[x, y]: [f64; 2]| {
        (
            pixels(EDGE + (x + half_x) * scale),
            pixels(HEAD + EDGE + (half_y - y) * scale),
        )
    };
    // Half of the distance of neighbouring targets of an even lattice.
    let count = f64::from(u32::try_from(values.len()).unwrap_or(u32::MAX));
    let half_side = 0.5 * (4.0 * half_x * half_y / count).sqrt() * 0.9;
    figure::svg(size, |canvas| {
        let title = format!("{}: {name} of the table", camera.name);
        canvas.draw(&Text::new(title, (20, 28), text(TITLE)))?;
        let words = format!(
            "blue: −{0} µm, no colour: zero, red: +{0} µm",
            wording::decimals(1e3 * largest, 3)
        );
        canvas.draw(&Text::new(words, (20, 64), text(FONT)))?;
        for (row, value) in found.rows.iter().zip(&values) {
            let share = if largest > 0.0 { value / largest } else { 0.0 };
            let hue = if share < 0.0 { 0.58 } else { 0.02 };
            let colour = HSLColor(hue, 0.85, 1.0 - 0.5 * share.abs());
            let [x, y] = row.measured_mm;
            let corners = [
                place([x - half_side, y - half_side]),
                place([x + half_side, y + half_side]),
            ];
            canvas.draw(&Rectangle::new(corners, colour.filled()))?;
        }
        let corners = [place([-half_x, -half_y]), place([half_x, half_y])];
        canvas.draw(&Rectangle::new(corners, OUTLINE.stroke_width(3)))?;
        Ok(())
    })
}

/// Draws one quantity of the targets against another.
fn curve(
    found: &Dlt2d,
    [x_name, y_name]: [&str; 2],
    x: Quantity,
    y: Quantity,
) -> Result<String, FigureError> {
    let point = found.result.camera.principal_point_mm;
    let places: Vec<(f64, f64)> = found
        .rows
        .iter()
        .map(|row| (x(row, point), 1e3 * y(row, point)))
        .collect();
    let (mut least, mut most, mut largest) = (0.0_f64, 0.0_f64, 1e-6_f64);
    for (x, y) in &places {
        least = least.min(*x);
        most = most.max(*x);
        largest = largest.max(y.abs());
    }
    if places.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    figure::svg(SIZE, |canvas| {
        canvas.draw(&Text::new(
            found.result.camera.name.clone(),
            (20, 28),
            text(TITLE),
        ))?;
        let axes = Axes {
            margins: Margins {
                top: 56,
                right: 30,
                left: 20,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: 76,
                labels: None,
                write: &|mm| wording::decimals(*mm, 3),
                name: x_name,
            },
            y: Axis {
                room: 110,
                labels: None,
                write: &|um| wording::decimals(*um, 6),
                name: y_name,
            },
        };
        let mut chart = axes.draw(
            canvas,
            1.05 * least..1.05 * most,
            -1.1 * largest..1.1 * largest,
        )?;
        let zero = [(1.05 * least, 0.0), (1.05 * most, 0.0)];
        chart.draw_series([PathElement::new(zero, INK.stroke_width(1))])?;
        chart.draw_series(
            places.iter().map(|place| {
                Circle::new(*place, 4, plotters::style::RGBColor(0, 90, 160).filled())
            }),
        )?;
        Ok(())
    })
}
