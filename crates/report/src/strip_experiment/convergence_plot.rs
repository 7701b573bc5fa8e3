//! RMS at the control points against iterations: Yuan et al. 2012, fig. 5.

use fmc_adjustment::model::Model;
use fmc_adjustment::statistics::Estimate;
use fmc_simulation::strip_experiment::experiment::Experiment;
use plotters::coord::combinators::IntoLogRange;
use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::Color;

use super::palette::colour;
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FigureError, INK, text};
use crate::wording;

const SIZE: (u32, u32) = (1600, 900);
const FONT: u32 = 24;
/// Number of iterations after which the paper calls its RMS steady.
const PAPERS_ITERATIONS: usize = 20;
/// Width of the column of names.
const NAMES: u32 = 400;

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
        let title = "RMS of the image residuals at the control points, mean over all repetitions";
        canvas.draw(&Text::new(title, (20, 34), text(FONT + 4)))?;
        let axes = Axes {
            margins: Margins {
                top: 70,
                right: NAMES,
                left: 20,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: 80,
                labels: Some(11),
                write: &|iterations| wording::decimals(*iterations, 0),
                name: "iterations",
            },
            y: Axis {
                room: 130,
                labels: None,
                write: &|um| wording::decimals(*um, 2),
                name: "RMS, µm",
            },
        };
        let mut chart = axes.draw(canvas, 0.0..21.0, (0.7 * least..1.4 * most).log_scale())?;
        let marked = [(20.0, 0.7 * least), (20.0, 1.4 * most)];
        chart.draw_series([PathElement::new(marked, INK.stroke_width(2))])?;
        let (x, _) = chart.backend_coord(&(20.0, most));
        canvas.draw(&Text::new(
            "iterations of Yuan et al. 2012",
            (x + 12, 90),
            text(FONT - 2),
        ))?;
        let mut names = Vec::new();
        for (model, curve) in &curves {
            let places = || (0..21).map(f64::from).zip(curve.iter().copied());
            let line: Vec<(f64, f64)> = places().collect();
            chart.draw_series([PathElement::new(line, colour(*model).stroke_width(3))])?;
            chart.draw_series(
                places().map(|place| Circle::new(place, 5, colour(*model).filled())),
            )?;
            let last = curve.last().copied().unwrap_or(least);
            names.push((chart.backend_coord(&(21.0, last)), *model, last));
        }
        // The names stand beside the ends of their curves, without overlap.
        names.sort_by(|(_, _, a), (_, _, b)| b.total_cmp(a));
        let rows = i32::try_from(names.len()).unwrap_or(0);
        let mut free = names
            .first()
            .map_or(0, |((_, y), ..)| (*y).min(780 - 32 * rows));
        for ((x, y), model, last) in names {
            let y = y.max(free);
            free = y + 32;
            let name = format!("{}: {last:.2} µm", model.label());
            canvas.draw(&Text::new(
                name,
                (x + 12, y),
                text(FONT - 2).color(&colour(model)),
            ))?;
        }
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
