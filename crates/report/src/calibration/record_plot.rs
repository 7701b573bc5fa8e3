//! Figures of a flight with records beside the bundle that knows one principal point.

use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::{Color, RGBColor};

use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, INK, TITLE, WIDTH, text};
use crate::legend::{self, Entry, Mark};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 560);
const TITLE_HEIGHT: u32 = 92;
const AXIS_WIDTH: u32 = 110;
const AXIS_HEIGHT: u32 = 76;
const EDGE: u32 = 30;
/// Colours (Okabe and Ito's palette, safe for the colour-blind).
const COLOURS: [RGBColor; 2] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0)];

/// Values of one bundle, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Observations that they are of.
    pub words: &'static str,
    /// Values.
    pub values: Vec<f64>,
}

/// Values of both bundles over their number.
#[derive(Debug, Clone, PartialEq)]
pub struct BesideEachOther {
    /// Title.
    pub title: String,
    /// Name of the horizontal axis.
    pub numbered: &'static str,
    /// Name of the vertical axis.
    pub quantity: &'static str,
    /// Value of either sign beyond which one is in doubt; `None` without a test.
    pub limit: Option<f64>,
    /// One or two series.
    pub series: Vec<Series>,
}

impl BesideEachOther {
    /// Draws the values in SVG; those beyond the limit have a circle around them.
    ///
    /// # Errors
    /// [`FigureError`] without values or if the drawing fails.
    pub fn svg(&self) -> Result<String, FigureError> {
        let all = self.series.iter().flat_map(|series| &series.values);
        let largest = all.map(|value| value.abs()).fold(0.0, f64::max);
        let largest = largest.max(self.limit.unwrap_or(0.0)).max(1e-6);
        let count = self.series.iter().map(|series| series.values.len()).max();
        let count = count.filter(|count| *count > 0);
        let count = count.ok_or(FigureError::NothingToDraw)?;
        let last = u32::try_from(count).map_or(f64::from(u32::MAX), f64::from) + 1.0;
        figure::svg(SIZE, |canvas| {
            canvas.draw(&Text::new(self.title.clone(), (20, 28), text(TITLE)))?;
            let named = self.series.iter().zip(COLOURS);
            let entries: Vec<Entry<'_>> = named
                .map(|(series, colour)| Entry {
                    mark: Mark::Dot,
                    colour,
                    words: series.words,
                })
                .collect();
            legend::draw(canvas, [legend::LEFT, 66], &entries)?;
            let axes = Axes {
                margins: Margins {
                    top: TITLE_HEIGHT,
                    right: EDGE,
                    left: 20,
                    ..Margins::default()
                },
                font: FONT,
                x: Axis {
                    room: AXIS_HEIGHT,
                    labels: None,
                    write: &|number| wording::decimals(*number, 3),
                    name: self.numbered,
                },
                y: Axis {
                    room: AXIS_WIDTH,
                    labels: None,
                    write: &|value| wording::decimals(*value, 6),
                    name: self.quantity,
                },
            };
            let mut chart = axes.draw(canvas, 0.0..last, -1.1 * largest..1.1 * largest)?;
            let line = |value: f64| PathElement::new([(0.0, value), (last, value)], INK);
            chart.draw_series([line(0.0)])?;
            chart.draw_series(
                self.limit
                    .iter()
                    .flat_map(|limit| [line(*limit), line(-limit)]),
            )?;
            for (series, colour) in self.series.iter().zip(COLOURS) {
                let places = || (1_u32..).map(f64::from).zip(series.values.iter().copied());
                chart.draw_series(places().map(|place| Circle::new(place, 4, colour.filled())))?;
                let doubted = places().filter(|(_, value)| {
                    let limit = self.limit.unwrap_or(f64::INFINITY);
                    value.abs() > limit
                });
                chart.draw_series(doubted.map(|place| Circle::new(place, 10, colour)))?;
            }
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(limit: Option<f64>, values: Vec<f64>) -> Result<String, FigureError> {
        BesideEachOther {
            title: "Block".to_owned(),
            numbered: "image",
            quantity: "test value",
            limit,
            series: vec![Series {
                words: "with records",
                values,
            }],
        }
        .svg()
    }

    #[test]
    fn values_beyond_the_limit_alone_have_a_circle_around_them() {
        let circles = |limit| {
            let svg = drawn(limit, vec![1.0, -9.0, 2.0]).unwrap();
            svg.matches("r=\"10\"").count()
        };
        assert_eq!([Some(4.0), Some(10.0), None].map(circles), [1, 0, 0]);
    }

    #[test]
    fn nothing_is_drawn_of_nothing() {
        assert!(matches!(
            drawn(None, Vec::new()),
            Err(FigureError::NothingToDraw)
        ));
    }
}
