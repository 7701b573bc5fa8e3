//! Histogram of errors in units of their σ, with the normal distribution.

use plotters::element::{PathElement, Rectangle, Text};
use plotters::prelude::Color;

use super::style::{ALARM, TRUTH, WANTED, tick};
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, WIDTH, text};

const SIZE: (u32, u32) = (WIDTH, 440);
/// Largest error/σ of the axis; what is beyond is counted in the last bins.
const MOST_SIGMAS: f64 = 6.0;
/// Number of bins of one σ.
const BINS_PER_SIGMA: u32 = 4;
/// Number of points of the curve.
const CURVE_POINTS: u32 = 120;

/// Draws the histogram of one quantity, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails, or if there is no error to draw.
pub fn coverage(name: &str, ratios: &[f64]) -> Result<String, FigureError> {
    if ratios.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    let bins = counts(ratios);
    let frames: u32 = bins.iter().sum();
    let width = 1.0 / f64::from(BINS_PER_SIGMA);
    let normal = |sigmas: f64| {
        f64::from(frames) * width * (-0.5 * sigmas * sigmas).exp() / std::f64::consts::TAU.sqrt()
    };
    let tallest = bins
        .iter()
        .copied()
        .map(f64::from)
        .fold(normal(0.0), f64::max);
    figure::svg(SIZE, |canvas| {
        canvas.draw(&Text::new(format!("{name}: error/σ"), (20, 26), text(FONT)))?;
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
                labels: Some(7),
                write: &|sigmas| tick(*sigmas, 1),
                name: "σ; beyond 6 in the last bars",
            },
            y: Axis {
                room: 96,
                labels: Some(5),
                write: &|count| tick(*count, 0),
                name: "frames",
            },
        };
        let mut chart = axes.draw(canvas, -MOST_SIGMAS..MOST_SIGMAS, 0.0..1.08 * tallest)?;
        let last = bins.len().saturating_sub(1);
        chart.draw_series(bins.iter().enumerate().zip(0_u32..).filter_map(
            |((index, count), bin)| {
                if *count == 0 {
                    return None;
                }
                let from = -MOST_SIGMAS + width * f64::from(bin);
                let is_end = index == 0 || index == last;
                let colour = if is_end { ALARM } else { TRUTH };
                let corners = [(from, 0.0), (from + 0.9 * width, f64::from(*count))];
                Some(Rectangle::new(corners, colour.filled()))
            },
        ))?;
        let curve = (0..=CURVE_POINTS).map(|point| {
            let part = f64::from(point) / f64::from(CURVE_POINTS);
            let sigmas = MOST_SIGMAS * (2.0 * part - 1.0);
            (sigmas, normal(sigmas))
        });
        let curve: Vec<(f64, f64)> = curve.collect();
        chart.draw_series([PathElement::new(curve, WANTED.stroke_width(3))])?;
        Ok(())
    })
}

/// Counts errors in equal bins; those beyond the ends are in the last ones.
fn counts(ratios: &[f64]) -> Vec<u32> {
    let bins = 2.0 * MOST_SIGMAS * f64::from(BINS_PER_SIGMA);
    let mut sorted: Vec<f64> = ratios
        .iter()
        .map(|ratio| {
            let place = (ratio + MOST_SIGMAS) * f64::from(BINS_PER_SIGMA);
            place.floor().clamp(0.0, bins - 1.0)
        })
        .collect();
    sorted.sort_by(f64::total_cmp);
    let mut counts = Vec::new();
    let mut bin = 0.5;
    let mut before = 0;
    while bin < bins {
        let below = sorted.partition_point(|place| *place < bin);
        counts.push(u32::try_from(below - before).unwrap_or(u32::MAX));
        before = below;
        bin += 1.0;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_is_counted_once_and_those_beyond_the_axis_in_the_last_bins() {
        let counts = counts(&[-100.0, -5.9, 0.1, 0.2, 0.3, 5.99, 7.0, f64::INFINITY]);
        assert_eq!(counts.len(), 48);
        assert_eq!(counts.iter().sum::<u32>(), 8);
        assert_eq!(
            (counts[0], counts[24], counts[25], counts[47]),
            (2, 2, 1, 3)
        );
    }

    #[test]
    fn figure_has_the_curve_and_needs_an_error() {
        assert!(coverage("V/H", &[0.1, -0.2]).unwrap().contains("polyline"));
        assert!(coverage("V/H", &[]).is_err());
    }
}
