//! True smear against the predicted one, with the diagonal.

use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::Color;

use super::style::{ALARM, OUTLINE_LINE, TRUTH, tick};
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, WIDTH, text};

const SIZE: (u32, u32) = (WIDTH, 440);
/// Factor of the largest true smear up to which predictions are drawn.
const LARGEST_PREDICTED: f64 = 2.0;
/// Factor of the median up to which smear is drawn; frames without compensation, which have more
/// of it, are at the end of the axis.
const DRAWN_MEDIANS: f64 = 6.0;
/// Least length of an axis, px.
const LEAST_PX: f64 = 0.05;

/// Draws pairs of predicted and true smear, px, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails, or if there is no frame to draw.
pub fn smear(smears: &[(f64, f64)]) -> Result<String, FigureError> {
    let [most_predicted, most_true] = [
        most_drawn(smears.iter().map(|(predicted, _)| *predicted)),
        most_drawn(smears.iter().map(|(_, smear)| *smear)),
    ];
    let most_predicted = most_predicted.clamp(most_true, LARGEST_PREDICTED * most_true);
    let (most_x, most_y) = (1.05 * most_predicted, 1.05 * most_true);
    if smears.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    figure::svg(SIZE, |canvas| {
        let title = "Smear: true against predicted; above the diagonal in red";
        canvas.draw(&Text::new(title, (20, 26), text(FONT)))?;
        let axes = Axes {
            margins: Margins {
                top: 48,
                right: 24,
                left: 8,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: 66,
                labels: Some(6),
                write: &|px| tick(*px, 2),
                name: "predicted, px",
            },
            y: Axis {
                room: 96,
                labels: Some(6),
                write: &|px| tick(*px, 2),
                name: "true, px",
            },
        };
        let mut chart = axes.draw(canvas, 0.0..most_x, 0.0..most_y)?;
        let radius = if smears.len() > 300 { 2 } else { 4 };
        chart.draw_series(smears.iter().map(|(predicted, smear)| {
            let colour = if smear > predicted { ALARM } else { TRUTH };
            let place = (predicted.min(most_x), smear.min(most_y));
            Circle::new(place, radius, colour.mix(0.7).filled())
        }))?;
        let end = most_x.min(most_y);
        let diagonal = [(0.0, 0.0), (end, end)];
        chart.draw_series([PathElement::new(diagonal, OUTLINE_LINE.stroke_width(2))])?;
        Ok(())
    })
}

/// Returns the largest value that is drawn, px.
fn most_drawn(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let largest = sorted.last().copied().unwrap_or(0.0);
    largest.min(DRAWN_MEDIANS * median).max(LEAST_PX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figure_has_every_frame_and_needs_one() {
        let figure = smear(&[(0.1, 0.2), (0.2, 0.1), (30.0, 0.1)]).unwrap();
        assert_eq!(figure.matches("<circle").count(), 3);
        assert!(smear(&[]).is_err());
    }
}
