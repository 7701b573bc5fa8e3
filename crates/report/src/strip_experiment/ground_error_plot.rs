//! Ground errors of the models at control and at check points.

use fmc_adjustment::model::Model;
use fmc_adjustment::statistics::Estimate;
use fmc_simulation::strip_experiment::experiment::{Experiment, Points};
use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::Color;
use plotters::style::text_anchor::HPos;

use super::palette::colour;
use super::rows::decimals_of;
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, INK, SMALL, TITLE, WIDTH, pixels, text, text_at};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 1010);
/// Width of the column of numbers.
const NUMBERS: u32 = 116;

/// Draws means, their intervals and the spread of the repetitions, for all models, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn ground_errors(experiment: &Experiment) -> Result<String, FigureError> {
    let (least, most) = range(experiment);
    if !(least > 0.0 && most.is_finite()) {
        return Err(FigureError::NothingToDraw);
    }
    figure::svg(SIZE, |canvas| {
        let title = "Planimetric error on the ground";
        canvas.draw(&Text::new(title, (20, 30), text(TITLE)))?;
        let axes = Axes {
            margins: Margins {
                top: 86,
                right: NUMBERS,
                bottom: 130,
                left: 20,
            },
            font: FONT,
            x: Axis {
                room: 70,
                labels: None,
                write: &|metres| wording::decimals(*metres, 3),
                name: "RMS of the place (X and Y together), m",
            },
            y: Axis {
                room: 1,
                labels: Some(0),
                write: &|_| String::new(),
                name: "",
            },
        };
        let mut chart = axes.draw(canvas, 0.0..1.12 * most, -7.0..0.0)?;
        let floor_m = experiment.scenario.noise_floor_m();
        if floor_m < most {
            let line = [(floor_m, -7.0), (floor_m, 0.0)];
            chart.draw_series([PathElement::new(line, INK.stroke_width(2))])?;
            let (x, y) = chart.backend_coord(&(floor_m, 0.0));
            let words = format!("noise floor {floor_m:.3} m");
            let style = text_at(SMALL, HPos::Center);
            canvas.draw(&Text::new(words, (x, y - 14), style))?;
        }
        for (row, model) in (0..7).map(f64::from).zip(Model::ALL) {
            let ink = colour(model);
            for (points, y) in [(Points::Control, -row - 0.47), (Points::Check, -row - 0.79)] {
                let repetitions = experiment.ground_m(model, points);
                let mean = Estimate::of_mean(&repetitions);
                let [low, high] = middle_90_percent(repetitions);
                // Beyond the axis nothing crosses the numbers.
                let (_, number_y) = chart.backend_coord(&(0.0, y));
                let is_beyond = mean.value > most;
                let arrow = if is_beyond { " →" } else { "" };
                let number = format!("{:.*} m{arrow}", decimals_of(mean.value), mean.value);
                let place = (pixels(f64::from(SIZE.0)) - 12, number_y);
                canvas.draw(&Text::new(number, place, text_at(SMALL, HPos::Right)))?;
                if is_beyond {
                    continue;
                }
                chart.draw_series([
                    PathElement::new([(low, y), (high, y)], ink.stroke_width(2)),
                    PathElement::new([(mean.lower, y), (mean.upper, y)], ink.stroke_width(9)),
                ])?;
                let style = match points {
                    Points::Control => plotters::style::WHITE.filled(),
                    Points::Check => ink.filled(),
                };
                chart.draw_series([Circle::new((mean.value, y), 9, style)])?;
                chart.draw_series([Circle::new((mean.value, y), 9, ink.stroke_width(3))])?;
            }
            let (x, y) = chart.backend_coord(&(0.0, -row - 0.16));
            figure::draw_plate(canvas, model.label(), (x + 8, y), &text(FONT))?;
        }
        for (y, words) in [
            (
                906,
                "hollow, upper line: control points; filled, lower line: check points",
            ),
            (
                940,
                "bar: 95 % interval of the mean; thin line: 90 % of the repetitions",
            ),
            (
                974,
                "vertical line: noise floor, which no correction lowers; →: beyond the axis",
            ),
        ] {
            canvas.draw(&Text::new(words, (20, y), text(SMALL)))?;
        }
        Ok(())
    })
}

/// Factor of the static model's error above which an error is beyond the axis.
const LARGE: f64 = 3.0;

/// Returns smallest and largest error of a flight, of the models that the axis reaches.
fn range(experiment: &Experiment) -> (f64, f64) {
    Model::ALL
        .iter()
        .flat_map(|model| [(*model, Points::Control), (*model, Points::Check)])
        .filter(|(model, points)| {
            let error = experiment.error_m(*model, *points).value;
            error <= LARGE * experiment.error_m(Model::Static, *points).value
        })
        .map(|(model, points)| middle_90_percent(experiment.ground_m(model, points)))
        .fold((f64::INFINITY, 0.0), |(least, most), [low, high]| {
            (least.min(low), most.max(high))
        })
}

/// Returns the range without a twentieth of the repetitions on either side.
fn middle_90_percent(mut repetitions: Vec<f64>) -> [f64; 2] {
    repetitions.sort_by(f64::total_cmp);
    let twentieth = repetitions.len() / 20;
    let at = |index: usize| repetitions.get(index).copied().unwrap_or(f64::NAN);
    [
        at(twentieth),
        at(repetitions.len().saturating_sub(1 + twentieth)),
    ]
}
