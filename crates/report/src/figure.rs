//! Colours, text and errors that all figures share.

use std::io;

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{Rectangle, Text};
use plotters::prelude::{
    Color, DrawingBackend, IntoDrawingArea, IntoFont, IntoTextStyle, RGBColor, SVGBackend,
    TextStyle,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Colour of axes and text.
pub const INK: RGBColor = RGBColor(40, 44, 52);
/// Colour of grid lines.
pub const GRID: RGBColor = RGBColor(222, 226, 232);
/// Colour of the sensor's outline and of the direction of flight.
pub const OUTLINE: RGBColor = RGBColor(110, 118, 130);

/// Width of a figure, pixels: a telephone of 500 pixels leaves it 476, on which letters of
/// [`SMALL`] keep 9 pixels.
pub const WIDTH: u32 = 840;
/// Size of titles.
pub const TITLE: u32 = 24;
/// Size of text.
pub const FONT: u32 = 22;
/// Size of the smallest text.
pub const SMALL: u32 = 20;

/// A drawing area, in pixels.
pub type Area<B> = DrawingArea<B, Shift>;

/// A drawing area of an SVG figure.
pub type Canvas<'a> = Area<SVGBackend<'a>>;

/// A backend on which figures are drawn, SVG or pixels.
pub trait Backend: DrawingBackend<ErrorType = io::Error> {}

impl<B: DrawingBackend<ErrorType = io::Error>> Backend for B {}

/// A reason why a figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// The camera has no exposure to show.
    #[error("no exposure to draw")]
    NothingToDraw,
    /// The drawing failed.
    #[error("cannot draw the figure: {0}")]
    Drawing(#[from] DrawingAreaErrorKind<io::Error>),
    /// The picture is too large, or its font or the encoder of PNG failed.
    #[error("cannot draw the figure as PNG: {0}")]
    Picture(String),
}

/// Draws a figure of that many pixels in SVG, on white.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn svg(
    size: (u32, u32),
    draw: impl FnOnce(&Canvas<'_>) -> Result<(), FigureError>,
) -> Result<String, FigureError> {
    let mut svg = String::new();
    {
        let canvas = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        canvas.fill(&plotters::style::WHITE)?;
        draw(&canvas)?;
        canvas.present()?;
    }
    Ok(svg)
}

/// Returns the style of text that starts at its point and is centred on it vertically.
#[must_use]
pub fn text(size: u32) -> TextStyle<'static> {
    text_at(size, HPos::Left)
}

/// Returns the style of text anchored horizontally as asked and centred vertically.
#[must_use]
pub fn text_at(size: u32, horizontal: HPos) -> TextStyle<'static> {
    ("sans-serif", size)
        .into_font()
        .color(&INK)
        .pos(Pos::new(horizontal, VPos::Center))
        .into_text_style(&(0, 0))
}

/// Draws text on a plate of white, so that no line of the figure strikes it through; lines that are
/// drawn later do.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn draw_plate<B: Backend>(
    area: &Area<B>,
    words: &str,
    (x, y): (i32, i32),
    style: &TextStyle<'_>,
) -> Result<(), FigureError> {
    let size = pixels(style.font.get_size()).unsigned_abs();
    // A letter is at most half as wide as its line is high, on average of a text.
    let letters = u32::try_from(words.chars().count()).unwrap_or(WIDTH);
    let [width, half] = [letters * size / 2, size / 2].map(|part| pixels(f64::from(part)));
    let corners = [(x - 4, y - half), (x + width, y + half)];
    area.draw(&Rectangle::new(corners, plotters::style::WHITE.filled()))?;
    area.draw(&Text::new(words.to_owned(), (x, y), style.clone()))?;
    Ok(())
}

/// Rounds a number of pixels.
#[expect(
    clippy::cast_possible_truncation,
    reason = "figures are a few thousand pixels wide; the cast saturates"
)]
#[must_use]
pub fn pixels(length: f64) -> i32 {
    length.round() as i32
}

/// Returns the em of a font of that size, pixels: plotters counts the height of a line.
#[expect(
    clippy::cast_possible_truncation,
    reason = "sizes are whole numbers of pixels, which leave room to spare"
)]
#[must_use]
pub fn ems(size: f64) -> f32 {
    (size / 1.24) as f32
}
