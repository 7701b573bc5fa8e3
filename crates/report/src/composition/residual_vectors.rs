//! Residuals of control and ties over the virtual image.

use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::{Color, RGBColor};

use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, SMALL, TITLE, WIDTH, pixels, text};
use crate::wording;

/// Colours of control and of ties.
const CONTROL: RGBColor = RGBColor(0, 90, 170);
const TIE: RGBColor = RGBColor(200, 80, 20);
const TITLE_HEIGHT: u32 = 110;
const AXIS_WIDTH: u32 = 96;
const AXIS_HEIGHT: u32 = 70;
const EDGE: u32 = 24;
/// Part of the width that the longest usual residual (three times the median) has.
const LONGEST_PART: f64 = 0.03;

/// A residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vector {
    /// Place in the virtual image, px.
    pub place_px: [f64; 2],
    /// Residual, to the right and downwards, px.
    pub way_px: [f64; 2],
    /// Of a tie, not of control.
    pub is_tie: bool,
}

/// Draws residuals of an image of `size_px` in SVG, enlarged by the factor in the title.
///
/// # Errors
/// [`FigureError`] without residuals, or if the drawing fails.
pub fn svg(size_px: [usize; 2], vectors: &[Vector]) -> Result<String, FigureError> {
    let [width, height] = size_px.map(|side| f64::from(u32::try_from(side).unwrap_or(u32::MAX)));
    let mut lengths: Vec<f64> = vectors
        .iter()
        .map(|vector| vector.way_px[0].hypot(vector.way_px[1]))
        .collect();
    lengths.sort_by(f64::total_cmp);
    let middle = lengths
        .get(lengths.len() / 2)
        .copied()
        .ok_or(FigureError::NothingToDraw)?;
    let factor = LONGEST_PART * width / (3.0 * middle).max(1e-9);
    let digit = 10_f64.powf(factor.log10().floor());
    let factor = (factor / digit).floor().max(1.0) * digit;
    let plot_width = WIDTH - AXIS_WIDTH - 2 * EDGE;
    let plot_height = pixels(f64::from(plot_width) * height / width).unsigned_abs();
    let size = (WIDTH, TITLE_HEIGHT + plot_height + AXIS_HEIGHT);
    figure::svg(size, |canvas| {
        let title = format!("Residuals, enlarged {} times", wording::decimals(factor, 0));
        canvas.draw(&Text::new(title, (16, 24), text(TITLE)))?;
        for (number, (name, colour)) in (0..).zip([
            ("control", CONTROL),
            ("ties: first less second sub-image", TIE),
        ]) {
            let left = 16 + 160 * number;
            canvas.draw(&Circle::new((left + 6, 64), 5, colour.filled()))?;
            canvas.draw(&Text::new(name, (left + 20, 64), text(FONT)))?;
        }
        let write = |px: &f64| wording::decimals(*px, 0);
        let axis = |room: u32, name| Axis {
            room,
            labels: Some(6),
            write: &write,
            name,
        };
        let axes = Axes {
            margins: Margins {
                top: TITLE_HEIGHT,
                right: EDGE,
                bottom: 0,
                left: EDGE,
            },
            font: SMALL,
            x: axis(AXIS_HEIGHT, "column, px"),
            y: axis(AXIS_WIDTH, "row, px"),
        };
        let mut chart = axes.draw(canvas, 0.0..width, height..0.0)?;
        for (of_ties, colour) in [(false, CONTROL), (true, TIE)] {
            let chosen = vectors.iter().filter(|vector| vector.is_tie == of_ties);
            let lines = chosen.clone().map(|vector| {
                let [u, v] = vector.place_px;
                let [right, down] = vector.way_px;
                PathElement::new(
                    vec![(u, v), (u + factor * right, v + factor * down)],
                    colour.stroke_width(2),
                )
            });
            chart.draw_series(lines)?;
            let dots = chosen.map(|vector| {
                let [u, v] = vector.place_px;
                Circle::new((u, v), 2, colour.filled())
            });
            chart.draw_series(dots)?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_residual_is_drawn_and_the_factor_is_stated() {
        let vector = |number: u32| Vector {
            place_px: [f64::from(number) * 10.0, 40.0],
            way_px: [0.2, -0.1],
            is_tie: number.is_multiple_of(2),
        };
        let vectors: Vec<Vector> = (0..20).map(vector).collect();
        let svg = svg([200, 100], &vectors).unwrap();
        assert!(svg.contains("enlarged 8 times"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 22);
        assert!(super::svg([200, 100], &[]).is_err());
    }
}
