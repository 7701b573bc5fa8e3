//! Legends: colours and what they mean, in lines of the figure's width.

use plotters::element::{Circle, Cross, PathElement, Rectangle, Text, TriangleMarker};
use plotters::prelude::{Color, RGBColor};

use crate::figure::{Area, Backend, FigureError, SMALL, WIDTH, text};

/// Distance of the lines of a legend, pixels.
pub(crate) const LINE: u32 = 32;
/// Width of a letter of a legend, on average of a text, pixels.
const LETTER: u32 = 9;
/// Room for a mark, and between entries, pixels.
const MARK: u32 = 42;
const GAP: u32 = 24;
/// Left edge of the lines, pixels.
pub(crate) const LEFT: u32 = 20;

/// Mark before an entry's words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    /// Disc.
    Dot,
    /// Circle.
    Ring,
    /// Triangle.
    Triangle,
    /// Two lines that cross.
    Cross,
    /// Line of that width, pixels.
    Line(u32),
    /// Pale square.
    Shade,
}

/// Entry of a legend.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry<'a> {
    /// Mark.
    pub(crate) mark: Mark,
    /// Colour of the mark.
    pub(crate) colour: RGBColor,
    /// Meaning of the mark.
    pub(crate) words: &'a str,
}

/// Returns left edge and line of every entry, and the number of lines.
fn places(entries: &[Entry<'_>], left: u32) -> (Vec<[u32; 2]>, u32) {
    let (mut x, mut line) = (left, 0);
    let mut places = Vec::new();
    for entry in entries {
        let letters = u32::try_from(entry.words.chars().count()).unwrap_or(WIDTH);
        let width = MARK + letters.saturating_mul(LETTER);
        if x > LEFT && x.saturating_add(width) > WIDTH {
            (x, line) = (LEFT, line + 1);
        }
        places.push([x, line]);
        x = x.saturating_add(width).saturating_add(GAP);
    }
    (places, line + 1)
}

/// Returns the height of a legend that begins at the left edge, pixels.
pub(crate) fn height(entries: &[Entry<'_>]) -> u32 {
    places(entries, LEFT).1 * LINE
}

/// Draws a legend; its first line begins at the place, the others at the left edge.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub(crate) fn draw<B: Backend>(
    area: &Area<B>,
    [left, y]: [u32; 2],
    entries: &[Entry<'_>],
) -> Result<(), FigureError> {
    let pixels = |length: u32| i32::try_from(length).unwrap_or(i32::MAX);
    for (entry, [x, line]) in entries.iter().zip(places(entries, left).0) {
        let (x, y) = (pixels(x), pixels(y + line * LINE));
        let colour = entry.colour;
        let centre = (x + 15, y);
        match entry.mark {
            Mark::Dot => area.draw(&Circle::new(centre, 7, colour.filled()))?,
            Mark::Ring => area.draw(&Circle::new(centre, 7, colour.stroke_width(2)))?,
            Mark::Triangle => area.draw(&TriangleMarker::new(centre, 10, colour.filled()))?,
            Mark::Cross => area.draw(&Cross::new(centre, 6, colour.stroke_width(2)))?,
            Mark::Line(width) => {
                let line = [(x, y), (x + 30, y)];
                area.draw(&PathElement::new(line, colour.stroke_width(width)))?;
            }
            Mark::Shade => {
                let corners = [(x, y - 10), (x + 30, y + 10)];
                area.draw(&Rectangle::new(corners, colour.mix(0.25).filled()))?;
            }
        }
        let place = (x + pixels(MARK) - 4, y);
        area.draw(&Text::new(entry.words.to_owned(), place, text(SMALL)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_that_do_not_fit_go_on_the_next_line() {
        let entry = |words| Entry {
            mark: Mark::Dot,
            colour: RGBColor(0, 0, 0),
            words,
        };
        let long = "thirty-eight letters stand in this one";
        let entries = [entry(long), entry("short"), entry(long), entry(long)];
        let (places, lines) = places(&entries, LEFT);
        assert_eq!(
            places.iter().map(|[_, line]| *line).collect::<Vec<_>>(),
            [0, 0, 1, 1]
        );
        assert_eq!(lines, 2);
        assert_eq!(height(&entries), 2 * LINE);
        for ([x, _], entry) in places.iter().zip(entries) {
            assert!(x + MARK + LETTER * u32::try_from(entry.words.len()).unwrap() <= WIDTH);
        }
    }
}
