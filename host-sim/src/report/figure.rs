//! What all figures share.

use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::prelude::{IntoFont, IntoTextStyle, RGBColor, SVGBackend, TextStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Colour of axes and text.
pub(super) const INK: RGBColor = RGBColor(40, 44, 52);
/// Colour of grid lines.
pub(super) const GRID: RGBColor = RGBColor(222, 226, 232);
/// Colour of the sensor's outline and of the direction of flight.
pub(super) const OUTLINE: RGBColor = RGBColor(110, 118, 130);

/// A drawing area of an SVG figure, in pixels.
pub(super) type Canvas<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// Why there is no figure.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// The camera has no exposure to show.
    #[error("no exposure to draw")]
    NothingToDraw,
    /// The drawing failed.
    #[error("cannot draw the figure: {0}")]
    Drawing(#[from] DrawingAreaErrorKind<std::io::Error>),
}

/// Text that starts at its point and is centred on it vertically.
pub(super) fn text(size: u32) -> TextStyle<'static> {
    text_at(size, HPos::Left)
}

/// Text anchored horizontally as asked and centred vertically.
pub(super) fn text_at(size: u32, horizontal: HPos) -> TextStyle<'static> {
    ("sans-serif", size)
        .into_font()
        .color(&INK)
        .pos(Pos::new(horizontal, VPos::Center))
        .into_text_style(&(0, 0))
}

/// Pixels, rounded.
#[expect(
    clippy::cast_possible_truncation,
    reason = "figures are a few thousand pixels wide; the cast saturates"
)]
pub(super) fn pixels(length: f64) -> i32 {
    length.round() as i32
}
