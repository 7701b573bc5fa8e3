//! Histograms of the smear and of the error of the principal point.

use plotters::element::{PathElement, Rectangle, Text};
use plotters::prelude::{Color, RGBColor};

use super::MissionReport;
use super::style::{ALARM, LABELS, TRUTH, tick};
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, Canvas, FONT, FigureError, WIDTH, text};

const SIZE: (u32, u32) = (WIDTH, 380);
const BINS: u32 = 40;

/// Draws both histograms, in SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn histograms(report: &MissionReport<'_>) -> Result<String, FigureError> {
    let limits = &report.scenario.written.limits;
    let errors = || report.judgement.errors.iter().flatten();
    let smear: Vec<f64> = errors().map(|errors| errors.smear_px).collect();
    let point: Vec<f64> = errors().map(|errors| errors.pp_error_px).collect();
    figure::svg(SIZE, |canvas| {
        let (left, right) = canvas.split_horizontally(SIZE.0 / 2);
        let most = |values: &[f64], limit: f64| {
            1.05 * values
                .iter()
                .filter(|value| value.is_finite())
                .map(|value| value.abs())
                .fold(limit, f64::max)
        };
        let most_smear = most(&smear, limits.smear_px);
        draw(
            &left,
            "Smear, px",
            &smear,
            [0.0, most_smear],
            &[limits.smear_px],
        )?;
        let most_point = most(&point, limits.pp_error_px);
        draw(
            &right,
            "Error of the principal point, px",
            &point,
            [-most_point, most_point],
            &[-limits.pp_error_px, limits.pp_error_px],
        )?;
        Ok(())
    })
}

/// Counts frames in equal bins over a range.
fn counts(values: &[f64], [low, high]: [f64; 2]) -> Vec<u32> {
    let edge = |bin: u32| low + (high - low) * f64::from(bin) / f64::from(BINS);
    // Frames below each edge are counted; the last bin includes its upper end.
    let below = |bin: u32| {
        let inside = |value: &&f64| **value >= low && (**value < edge(bin) || bin == BINS);
        values
            .iter()
            .filter(|value| **value <= high)
            .filter(inside)
            .count()
    };
    (0..BINS)
        .map(|bin| u32::try_from(below(bin + 1) - below(bin)).unwrap_or(u32::MAX))
        .collect()
}

fn draw(
    area: &Canvas<'_>,
    title: &str,
    values: &[f64],
    range: [f64; 2],
    limits: &[f64],
) -> Result<(), FigureError> {
    const COLOUR: RGBColor = TRUTH;
    let counts = counts(values, range);
    let [low, high] = range;
    let width = (high - low) / f64::from(BINS);
    let tallest = f64::from(counts.iter().copied().max().unwrap_or(0).max(1));
    area.draw(&Text::new(title, (20, 24), text(FONT)))?;
    let axes = Axes {
        margins: Margins {
            top: 48,
            right: 20,
            left: 10,
            ..Margins::default()
        },
        font: FONT,
        x: Axis {
            room: 44,
            labels: Some(4),
            write: &|value| tick(*value, 3),
            name: "",
        },
        y: Axis {
            room: LABELS,
            labels: Some(6),
            write: &|count| tick(*count, 0),
            name: "frames",
        },
    };
    let mut chart = axes.draw(area, low..high, 0.0..1.1 * tallest)?;
    chart.draw_series(
        counts
            .iter()
            .zip(0_u32..)
            .filter(|(count, _)| **count > 0)
            .map(|(count, bin)| {
                let from = low + f64::from(bin) * width;
                Rectangle::new(
                    [(from, 0.0), (from + 0.92 * width, f64::from(*count))],
                    COLOUR.filled(),
                )
            }),
    )?;
    for limit in limits {
        let line = [(*limit, 0.0), (*limit, 1.1 * tallest)];
        chart.draw_series([PathElement::new(line, ALARM.stroke_width(2))])?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_of_the_range_is_in_one_bin() {
        let values: Vec<f64> = (0..=1000).map(|value| f64::from(value) / 1000.0).collect();
        let counts = counts(&values, [0.0, 1.0]);
        assert_eq!(counts.iter().sum::<u32>(), 1001);
        assert_eq!(counts.len(), 40);
    }
}
