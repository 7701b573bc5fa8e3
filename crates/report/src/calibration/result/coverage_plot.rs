//! Figure of the part of the format that image points cover.

use std::collections::HashSet;

use fmc_adjustment::calibration::result::CalibrationResult;
use fmc_adjustment::calibration::result::coverage::LEAST_RADIUS_SHARE;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{Color, RGBColor};

use crate::figure::{self, FONT, FigureError, OUTLINE, TITLE, WIDTH, pixels, text};

const EDGE: f64 = 30.0;
/// Height of the title.
const HEAD: f64 = 108.0;
const POINT: RGBColor = RGBColor(0, 90, 160);
const REJECTED: RGBColor = RGBColor(194, 47, 47);
const CORNERS: u32 = 180;
/// Radius of a dot, px.
const DOT: i32 = 3;
/// Most dots that are all drawn; of more, those that lie on others are left out.
const MOST_DOTS: usize = 5000;

/// Leaves out dots of a cell, nearly as wide as a dot, that has one already.
fn thinned(places: Vec<(i32, i32)>) -> Vec<(i32, i32)> {
    if places.len() <= MOST_DOTS {
        return places;
    }
    let cell = 2 * DOT - 1;
    let mut taken = HashSet::new();
    let is_first = |(x, y): &(i32, i32)| taken.insert((x.div_euclid(cell), y.div_euclid(cell)));
    places.into_iter().filter(is_first).collect()
}

/// Draws all image points on the format, rejected ones in red, and the circle that they should
/// reach, in SVG.
///
/// # Errors
/// [`FigureError`] without image points or if the drawing fails.
pub fn svg(result: &CalibrationResult) -> Result<String, FigureError> {
    if result.image_residuals.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    let coverage = result.coverage();
    let [half_x, half_y] = result.camera.half_format_mm();
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
    figure::svg(size, |canvas| {
        let title = format!("{}: image points of all images", result.camera.name);
        canvas.draw(&Text::new(title, (20, 28), text(TITLE)))?;
        let reach = format!(
            "they reach {:.1} mm, {:.0} % of the format radius",
            coverage.radius_mm,
            100.0 * coverage.radius_share(),
        );
        let cells = format!(
            "and lie in {:.0} % of the cells of the format; rejected: red",
            100.0 * coverage.cells
        );
        for (words, y) in [(reach, 62), (cells, 92)] {
            canvas.draw(&Text::new(words, (20, y), text(FONT)))?;
        }
        let corners = [place([-half_x, -half_y]), place([half_x, half_y])];
        canvas.draw(&Rectangle::new(corners, OUTLINE.stroke_width(3)))?;
        let [x0, y0] = result.calibrated.principal_point_mm;
        let radius = LEAST_RADIUS_SHARE * coverage.format_radius_mm;
        let circle: Vec<(i32, i32)> = (0..=CORNERS)
            .map(|corner| {
                let angle = f64::from(corner) / f64::from(CORNERS) * std::f64::consts::TAU;
                let [x, y] = [x0 + radius * angle.cos(), y0 + radius * angle.sin()];
                place([x.clamp(-half_x, half_x), y.clamp(-half_y, half_y)])
            })
            .collect();
        canvas.draw(&PathElement::new(circle, OUTLINE.stroke_width(1)))?;
        // Rejected ones are few, and above the others.
        for (are_rejected, colour) in [(false, POINT), (true, REJECTED)] {
            let points = result.image_residuals.iter();
            let points = points.filter(|one| one.is_rejected == are_rejected);
            for dot in thinned(points.map(|one| place(one.measured_mm)).collect()) {
                canvas.draw(&Circle::new(dot, DOT, colour.filled()))?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn millions_of_points_are_as_many_dots_as_the_figure_has_room_for() {
        // Every place of 780 x 585, in a mixed order.
        let places = |count: i32| {
            let mixed = (0..count).scan(0, |place, _| {
                *place = (*place + 7919) % (780 * 585);
                Some(*place)
            });
            mixed.map(|place| (place % 780, place / 780))
        };
        let few: Vec<_> = places(5000).collect();
        assert_eq!(thinned(few.clone()), few);
        let many: Vec<_> = places(1_000_000).collect();
        let dots = thinned(many.clone());
        assert!((15_000..=156 * 117).contains(&dots.len()), "{}", dots.len());
        let drawn: HashSet<_> = dots.into_iter().collect();
        // A point that is left out lies within the width of a dot that is drawn.
        for (x, y) in many.into_iter().step_by(997) {
            let near = |dx: i32| (-4..=4).any(|dy| drawn.contains(&(x + dx, y + dy)));
            assert!((-4..=4).any(near), "{x}, {y}");
        }
    }
}
