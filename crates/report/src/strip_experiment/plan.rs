//! Plan of frames, control points and check points: Yuan et al. 2012, fig. 4.

use fmc_adjustment::collinearity::ground_at_height;
use fmc_adjustment::model::Model;
use fmc_simulation::strip_experiment::experiment::Experiment;
use fmc_simulation::strip_experiment::strip::TrueFrame;
use plotters::element::{Circle, PathElement, Text, TriangleMarker};
use plotters::prelude::Color;

use super::palette::colour;
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, OUTLINE, SMALL, TITLE, WIDTH, text};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 920);

/// Draws the plan, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn plan(experiment: &Experiment) -> Result<String, FigureError> {
    let outlines: Vec<Vec<(f64, f64)>> = experiment
        .strip
        .frames
        .iter()
        .map(|frame| outline(experiment, frame))
        .collect();
    let corners = || outlines.iter().flatten();
    let bounds = |of: fn(&(f64, f64)) -> f64| {
        corners().map(of).fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(least, most), value| (least.min(value), most.max(value)),
        )
    };
    let (x_bounds, y_bounds) = (bounds(|(x, _)| *x), bounds(|(_, y)| *y));
    let side = 1.06 * (x_bounds.1 - x_bounds.0).max(y_bounds.1 - y_bounds.0);
    if !(side > 0.0 && side.is_finite()) {
        return Err(FigureError::NothingToDraw);
    }
    // The plot is a square: one scale for both axes.
    let around = |(least, most): (f64, f64)| {
        let middle = f64::midpoint(least, most);
        middle - side / 2.0..middle + side / 2.0
    };
    figure::svg(SIZE, |canvas| {
        canvas.draw(&Text::new("Frames on the ground", (20, 30), text(TITLE)))?;
        let axes = Axes {
            margins: Margins {
                top: 60,
                right: 60,
                bottom: 86,
                left: 20,
            },
            font: FONT,
            x: Axis {
                room: 70,
                labels: Some(6),
                write: &|metres| wording::decimals(*metres, 0),
                name: "X (east), m",
            },
            y: Axis {
                room: 110,
                labels: None,
                write: &|metres| wording::decimals(*metres, 0),
                name: "Y (north), m",
            },
        };
        let mut chart = axes.draw(canvas, around(x_bounds), around(y_bounds))?;
        for outline in outlines {
            chart.draw_series([PathElement::new(outline, OUTLINE.stroke_width(2))])?;
        }
        let check = colour(Model::Static).mix(0.5).filled();
        let frames = &experiment.strip.frames;
        chart.draw_series(frames.iter().flat_map(|frame| {
            frame.check.iter().map(|point| {
                let [x, y, _] = point.ground_m;
                Circle::new((x, y), 3, check)
            })
        }))?;
        let control = colour(Model::Printed).filled();
        for point in &experiment.scenario.written.control.points {
            let place = (point.x_m, point.y_m);
            chart.draw_series([TriangleMarker::new(place, 9, control)])?;
            let (x, y) = chart.backend_coord(&place);
            canvas.draw(&Text::new(point.id.clone(), (x + 11, y), text(SMALL)))?;
        }
        for (y, words) in [
            (858, "triangles: control points; lines: frames"),
            (890, "dots: check points, a grid in each frame"),
        ] {
            canvas.draw(&Text::new(words, (20, y), text(SMALL)))?;
        }
        Ok(())
    })
}

/// Returns the corners of a frame on the mean terrain, closed.
fn outline(experiment: &Experiment, frame: &TrueFrame) -> Vec<(f64, f64)> {
    let interior = experiment.strip.corrections.interior();
    let [half_x, half_y] = interior.half_format_mm;
    [
        [1.0, 1.0],
        [1.0, -1.0],
        [-1.0, -1.0],
        [-1.0, 1.0],
        [1.0, 1.0],
    ]
    .into_iter()
    .filter_map(|[u, w]| {
        ground_at_height(
            &frame.orientation,
            interior.principal_distance_mm,
            interior.about_centroid([u * half_x, w * half_y]),
            experiment.scenario.written.terrain.height_m,
        )
    })
    .map(|[x, y]| (x, y))
    .collect()
}
