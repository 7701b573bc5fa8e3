//! Figure of the radial and decentring profile.

use fmc_adjustment::calibration::result::CalibrationResult;
use plotters::element::{PathElement, Polygon, Text};
use plotters::prelude::{Color, RGBColor};

use super::profile::{Profile, ProfileRow};
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, INK, TITLE, WIDTH, text};
use crate::legend::{self, Entry, Mark};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 640);
const TITLE_HEIGHT: u32 = 122;
const AXIS_WIDTH: u32 = 110;
const AXIS_HEIGHT: u32 = 76;
const EDGE: u32 = 30;
const STEPS: u32 = 200;
/// Colours of the curves (Okabe and Ito's palette, safe for the colour-blind).
const GAUSSIAN: RGBColor = RGBColor(0, 114, 178);
const BALANCED: RGBColor = RGBColor(213, 94, 0);
const DECENTRING: RGBColor = RGBColor(0, 158, 115);

/// A curve with its σ, both of a row.
struct Curve {
    name: &'static str,
    colour: RGBColor,
    value: fn(&ProfileRow) -> f64,
    sigma: fn(&ProfileRow) -> f64,
}

const CURVES: [Curve; 3] = [
    Curve {
        name: "radial, about f",
        colour: GAUSSIAN,
        value: |row| row.gaussian_um,
        sigma: |row| row.sigma_um,
    },
    Curve {
        name: "radial, balanced",
        colour: BALANCED,
        value: |row| row.balanced_um,
        sigma: |row| row.sigma_um,
    },
    Curve {
        name: "decentring",
        colour: DECENTRING,
        value: |row| row.decentring_um,
        sigma: |row| row.decentring_sigma_um,
    },
];

/// Draws the profiles over the radius with bands of ± σ, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn svg(result: &CalibrationResult) -> Result<String, FigureError> {
    let rows = Profile::curve(result, STEPS);
    let largest = rows
        .iter()
        .flat_map(|row| CURVES.map(|curve| (curve.value)(row).abs() + (curve.sigma)(row)))
        .fold(1e-6, f64::max);
    let radius = rows.last().map_or(1.0, |row| row.radius_mm);
    figure::svg(SIZE, |canvas| {
        let name = result.camera.name.clone();
        canvas.draw(&Text::new(name, (20, 28), text(TITLE)))?;
        let words = "distortion, measured − ideal, with bands of ± σ";
        canvas.draw(&Text::new(words, (20, 60), text(FONT)))?;
        let entries = CURVES.map(|curve| Entry {
            mark: Mark::Line(5),
            colour: curve.colour,
            words: curve.name,
        });
        legend::draw(canvas, [legend::LEFT, 94], &entries)?;
        let axes = Axes {
            margins: Margins {
                top: TITLE_HEIGHT,
                right: EDGE,
                left: 20,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: AXIS_HEIGHT,
                labels: None,
                write: &|mm| wording::decimals(*mm, 3),
                name: "measured radius, mm",
            },
            y: Axis {
                room: AXIS_WIDTH,
                labels: None,
                write: &|um| wording::decimals(*um, 6),
                name: "distortion, µm",
            },
        };
        let mut chart = axes.draw(canvas, 0.0..radius, -1.05 * largest..1.05 * largest)?;
        let zero = [(0.0, 0.0), (radius, 0.0)];
        chart.draw_series([PathElement::new(zero, INK.stroke_width(1))])?;
        for Curve {
            colour,
            value,
            sigma,
            ..
        } in CURVES
        {
            let edge = |sign: f64| {
                rows.iter()
                    .map(move |row| (row.radius_mm, value(row) + sign * sigma(row)))
            };
            let band: Vec<(f64, f64)> = edge(1.0).chain(edge(-1.0).rev()).collect();
            chart.draw_series([Polygon::new(band, colour.mix(0.2).filled())])?;
            let line: Vec<(f64, f64)> = edge(0.0).collect();
            chart.draw_series([PathElement::new(line, colour.stroke_width(3))])?;
        }
        Ok(())
    })
}
