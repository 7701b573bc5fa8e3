//! RMS at the control points against iterations: Yuan et al. 2012, fig. 5.

use fmc_adjustment::model::Model;
use fmc_adjustment::statistics::Estimate;
use fmc_simulation::strip_experiment::experiment::Experiment;
use plotters::coord::combinators::IntoLogRange;
use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::Color;
use plotters::style::text_anchor::HPos;

use super::palette::colour;
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, INK, SMALL, TITLE, WIDTH, text, text_at};
use crate::legend::{self, Entry, Mark};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 800);
/// Number of iterations after which the paper calls its RMS steady.
const PAPERS_ITERATIONS: usize = 20;
/// Height of the plot with its title and axes.
const LEGEND_TOP: u32 = 620;

/// Draws the mean image RMS over the repetitions against the iterations, for all models, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn convergence(experiment: &Experiment) -> Result<String, FigureError> {
    let curves = Model::ALL.map(|model| (model, curve(experiment, model)));
    let values = || curves.iter().flat_map(|(_, curve)| curve.iter().copied());
    let least = values().fold(f64::INFINITY, f64::min);
    let most = values().fold(0.0, f64::max);
    if !(least > 0.0 && most.is_finite()) {
        return Err(FigureError::NothingToDraw);
    }
    figure::svg(SIZE, |canvas| {
        let title = "RMS of the image residuals at the control points";
        canvas.draw(&Text::new(title, (20, 30), text(TITLE)))?;
        let (upper, below) = canvas.split_vertically(LEGEND_TOP);
        let axes = Axes {
            margins: Margins {
                top: 90,
                right: 30,
                left: 20,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: 76,
                labels: Some(11),
                write: &|iterations| wording::decimals(*iterations, 0),
                name: "iterations",
            },
            y: Axis {
                room: 100,
                labels: None,
                write: &|um| wording::decimals(*um, 2),
                name: "RMS, µm",
            },
        };
        let mut chart = axes.draw(&upper, 0.0..21.0, (0.7 * least..1.4 * most).log_scale())?;
        let marked = [(20.0, 0.7 * least), (20.0, 1.4 * most)];
        chart.draw_series([PathElement::new(marked, INK.stroke_width(2))])?;
        let (x, _) = chart.backend_coord(&(20.0, most));
        let words = "iterations of Yuan et al. 2012";
        canvas.draw(&Text::new(words, (x, 72), text_at(SMALL, HPos::Right)))?;
        let mut names = Vec::new();
        for (model, curve) in &curves {
            let places = || (0..21).map(f64::from).zip(curve.iter().copied());
            let line: Vec<(f64, f64)> = places().collect();
            chart.draw_series([PathElement::new(line, colour(*model).stroke_width(3))])?;
            chart.draw_series(
                places().map(|place| Circle::new(place, 4, colour(*model).filled())),
            )?;
            let last = curve.last().copied().unwrap_or(least);
            names.push((*model, last));
        }
        // From the highest curve to the lowest.
        names.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        let names: Vec<(Model, String)> = names
            .into_iter()
            .map(|(model, last)| (model, format!("{}: {last:.2} µm", model.label())))
            .collect();
        let entries: Vec<Entry<'_>> = names
            .iter()
            .map(|(model, words)| Entry {
                mark: Mark::Line(4),
                colour: colour(*model),
                words,
            })
            .collect();
        legend::draw(&below, [legend::LEFT, 30], &entries)?;
        Ok(())
    })
}

/// Returns the mean RMS before and after each iteration, µm; a repetition that has converged
/// keeps its value.
fn curve(experiment: &Experiment, model: Model) -> Vec<f64> {
    (0..=PAPERS_ITERATIONS)
        .map(|iteration| {
            let all = experiment.each(model, |outcome| {
                let rms = outcome.rms_mm.get(iteration).or(outcome.rms_mm.last());
                1e3 * rms.copied().unwrap_or(f64::NAN)
            });
            Estimate::of_mean(&all).value
        })
        .collect()
}
