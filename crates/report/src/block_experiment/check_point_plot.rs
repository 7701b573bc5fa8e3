//! Check points of every run along the strips, by variant.

use fmc_adjustment::statistics::Estimate;
use fmc_simulation::block_experiment::experiment::BlockExperiment;
use fmc_simulation::block_experiment::variant::Variant;
use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::Color;
use plotters::style::RGBColor;

use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, SMALL, TITLE, WIDTH, text};
use crate::wording;

/// Height of a row, and of what stands above and below the rows, px.
const ROW: u32 = 72;
const REST: u32 = 210;

/// Colours of bundles without and with records (Okabe and Ito's palette).
const STATIC: RGBColor = RGBColor(213, 94, 0);
const RECORDS: RGBColor = RGBColor(0, 114, 178);

/// Draws a dot for every run and the interval of the mean, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails, or if there is nothing to draw.
pub fn check_points(experiment: &BlockExperiment) -> Result<String, FigureError> {
    let along = |variant: Variant| {
        experiment.each(variant, |outcome| {
            let [along_m, ..] = outcome.check_m;
            100.0 * along_m
        })
    };
    let most = experiment
        .variants
        .iter()
        .flat_map(|variant| along(*variant))
        .fold(0.0, f64::max);
    if !(most > 0.0 && most.is_finite()) {
        return Err(FigureError::NothingToDraw);
    }
    let rows = u32::try_from(experiment.variants.len()).unwrap_or(0);
    let size = (WIDTH, REST + ROW * rows);
    figure::svg(size, |canvas| {
        let title = "Check points along the strips";
        canvas.draw(&Text::new(title, (20, 30), text(TITLE)))?;
        let axes = Axes {
            margins: Margins {
                top: 70,
                right: 24,
                bottom: 60,
                left: 20,
            },
            font: FONT,
            x: Axis {
                room: 70,
                labels: None,
                write: &|centimetres| wording::decimals(*centimetres, 3),
                name: "root mean square of a run, cm",
            },
            y: Axis {
                room: 1,
                labels: Some(0),
                write: &|_| String::new(),
                name: "",
            },
        };
        let mut chart = axes.draw(canvas, 0.0..1.08 * most, -f64::from(rows)..0.0)?;
        for (row, variant) in (0_u32..).map(f64::from).zip(&experiment.variants) {
            let ink = if variant.has_records() {
                RECORDS
            } else {
                STATIC
            };
            let y = -row - 0.68;
            let runs = along(*variant);
            let mean = Estimate::of_mean(&runs);
            let dots = runs
                .iter()
                .map(|run| Circle::new((*run, y), 4, ink.mix(0.5).filled()));
            chart.draw_series(dots)?;
            let interval = [(mean.lower, y - 0.17), (mean.upper, y - 0.17)];
            chart.draw_series([PathElement::new(interval, ink.stroke_width(7))])?;
            let (x, y) = chart.backend_coord(&(0.0, -row - 0.26));
            let words = format!("{}: {:.2} cm", variant.label(), mean.value);
            figure::draw_plate(canvas, &words, (x + 8, y), &text(FONT))?;
        }
        let words = "dots: runs; bar: 95 % interval of their mean";
        let bottom = i32::try_from(size.1).unwrap_or(i32::MAX) - 24;
        canvas.draw(&Text::new(words, (20, bottom), text(SMALL)))?;
        Ok(())
    })
}
