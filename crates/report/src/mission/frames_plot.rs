//! Smear and error of the principal point, frame by frame.

use fmc_simulation::mission::frame_errors::FrameErrors;
use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::{Color, RGBColor};

use super::MissionReport;
use super::style::{ALARM, CAMERA, LABELS, TRUTH, WANTED, tick};
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, Canvas, FONT, FigureError, WIDTH, text};
use crate::legend::{self, Entry, Mark};

const SIZE: (u32, u32) = (WIDTH, 900);

/// Factor of the largest true smear up to which predictions are drawn.
const LARGEST_PREDICTED: f64 = 3.0;

/// One panel of the figure.
struct Panel<'a> {
    title: &'a str,
    unit: &'a str,
    range: [f64; 2],
    limits: Vec<f64>,
    dots: Vec<(RGBColor, Vec<(f64, f64)>)>,
    refused: &'a [f64],
    last_frame: f64,
}

/// Draws the figure, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn frames(report: &MissionReport<'_>) -> Result<String, FigureError> {
    let numbered = || report.flown.frames.iter().zip(&report.judgement.errors);
    let number = |sequence: u32| f64::from(sequence);
    let series = |value: fn(&FrameErrors) -> f64| -> Vec<(f64, f64)> {
        numbered()
            .filter_map(|(frame, errors)| {
                let errors = errors.as_ref()?;
                Some((number(frame.record.sequence), value(errors)))
            })
            .filter(|(_, value)| value.is_finite())
            .collect()
    };
    let refused: Vec<f64> = numbered()
        .filter(|(_, errors)| errors.is_none())
        .map(|(frame, _)| number(frame.record.sequence))
        .collect();
    let last_frame = numbered()
        .map(|(frame, _)| number(frame.record.sequence))
        .fold(1.0, f64::max);
    let limits = &report.scenario.written.limits;
    let most = |dots: &[(f64, f64)], limit: f64| {
        1.15 * dots
            .iter()
            .map(|(_, value)| value.abs())
            .fold(limit, f64::max)
    };
    let (smear, predicted) = (
        series(|errors| errors.smear_px),
        series(|errors| errors.predicted_px),
    );
    let point_of = |is_clean: bool| -> Vec<(f64, f64)> {
        numbered()
            .filter_map(|(frame, errors)| Some((frame, errors.as_ref()?)))
            .filter(|(_, errors)| errors.is_clean == is_clean && errors.pp_error_px.is_finite())
            .map(|(frame, errors)| (number(frame.record.sequence), errors.pp_error_px))
            .collect()
    };
    let (point, doubtful) = (point_of(true), point_of(false));
    // If nothing is known of the stage, the prediction is half of its stroke.
    let most_true = most(&smear, limits.smear_px);
    let most_smear = most(&predicted, 0.0).clamp(most_true, LARGEST_PREDICTED * most_true);
    let predicted = predicted
        .into_iter()
        .map(|(frame, value)| (frame, value.min(most_smear)))
        .collect();
    let most_point = most(&point, limits.pp_error_px).max(most(&doubtful, 0.0));
    figure::svg(SIZE, |canvas| {
        let (upper, lower) = canvas.split_vertically(SIZE.1 / 2);
        draw(
            &upper,
            &Panel {
                title: "Largest smear on the sensor, attitude included",
                unit: "px",
                range: [0.0, most_smear],
                limits: vec![limits.smear_px],
                dots: vec![(CAMERA, predicted), (TRUTH, smear)],
                refused: &refused,
                last_frame,
            },
        )?;
        draw(
            &lower,
            &Panel {
                title: "Centroid principal point, reported less true",
                unit: "px",
                range: [-most_point, most_point],
                limits: vec![limits.pp_error_px, -limits.pp_error_px],
                dots: vec![(WANTED, doubtful), (TRUTH, point)],
                refused: &refused,
                last_frame,
            },
        )?;
        draw_legend(
            &upper,
            &[
                (TRUTH, "true"),
                (CAMERA, "predicted, for 95 of 100"),
                (
                    ALARM,
                    &format!("limit {} px; refused trigger", limits.smear_px),
                ),
            ],
        )?;
        draw_legend(
            &lower,
            &[
                (TRUTH, "no fault, no flag against it"),
                (WANTED, "a fault or a flag against it"),
                (ALARM, &format!("limit {} px", limits.pp_error_px)),
            ],
        )?;
        Ok(())
    })
}

fn draw_legend(area: &Canvas<'_>, entries: &[(RGBColor, &str)]) -> Result<(), FigureError> {
    let entries: Vec<Entry<'_>> = entries
        .iter()
        .map(|(colour, words)| Entry {
            mark: if *colour == CAMERA {
                Mark::Ring
            } else {
                Mark::Dot
            },
            colour: *colour,
            words,
        })
        .collect();
    legend::draw(area, [legend::LEFT, 62], &entries)
}

fn draw(area: &Canvas<'_>, panel: &Panel<'_>) -> Result<(), FigureError> {
    area.draw(&Text::new(panel.title, (20, 24), text(FONT)))?;
    let [low, high] = panel.range;
    let axes = Axes {
        margins: Margins {
            top: 92,
            right: 30,
            left: 10,
            ..Margins::default()
        },
        font: FONT,
        x: Axis {
            room: 64,
            labels: None,
            write: &|frame| tick(*frame, 0),
            name: "trigger",
        },
        y: Axis {
            room: LABELS,
            labels: Some(7),
            write: &|value| tick(*value, 3),
            name: panel.unit,
        },
    };
    let mut chart = axes.draw(area, 0.5..panel.last_frame + 0.5, low..high)?;
    for frame in panel.refused {
        let line = [(*frame, low), (*frame, low + 0.08 * (high - low))];
        chart.draw_series([PathElement::new(line, ALARM.stroke_width(3))])?;
    }
    let is_crowded = panel.last_frame > 200.0;
    for (colour, dots) in &panel.dots {
        // The camera's values are rings, so that the true values show inside.
        let (radius, style) = match (*colour == CAMERA, is_crowded) {
            (true, false) => (8, colour.stroke_width(2)),
            (false, false) => (5, colour.filled()),
            (_, true) => (2, colour.filled()),
        };
        chart.draw_series(dots.iter().map(|dot| Circle::new(*dot, radius, style)))?;
    }
    for limit in &panel.limits {
        let line = [(0.5, *limit), (panel.last_frame + 0.5, *limit)];
        chart.draw_series([PathElement::new(line, ALARM.stroke_width(2))])?;
    }
    Ok(())
}
