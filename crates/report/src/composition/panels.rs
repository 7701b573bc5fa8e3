//! Images side by side, with titles.

use plotters::element::{Rectangle, Text};
use plotters::prelude::Color;

use crate::figure::{self, FigureError, GRID, INK, SMALL, WIDTH, text};

use super::page::png_link;

/// Columns of panels, and what lies between and above them, px.
const COLUMNS: u32 = 2;
const GAP: u32 = 16;
const TITLE_HEIGHT: u32 = 64;
const LINE_HEIGHT: i32 = 26;

/// A panel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Panel {
    /// Title, in two lines.
    pub title: [String; 2],
    /// Dots in a row.
    pub width_px: usize,
    /// Grey values, row by row.
    pub grey: Vec<u8>,
}

/// Draws panels of one size in SVG, two in a row.
///
/// # Errors
/// [`FigureError`] without a panel, for one without whole rows, or if the drawing fails.
pub fn svg(panels: &[Panel]) -> Result<String, FigureError> {
    let first = panels.first().ok_or(FigureError::NothingToDraw)?;
    let side = |count: usize| u32::try_from(count).unwrap_or(u32::MAX).max(1);
    let width = (WIDTH - (COLUMNS + 1) * GAP) / COLUMNS;
    let dots = [
        side(first.width_px),
        side(first.grey.len() / first.width_px.max(1)),
    ];
    let height = width.saturating_mul(dots[1]) / dots[0];
    let places: Vec<(u32, u32)> = (0..side(panels.len()))
        .map(|number| {
            let (column, row) = (number % COLUMNS, number / COLUMNS);
            (
                GAP + column * (width + GAP),
                TITLE_HEIGHT + row * (height + TITLE_HEIGHT),
            )
        })
        .collect();
    let rows = side(panels.len()).div_ceil(COLUMNS);
    let size = (WIDTH, rows * (height + TITLE_HEIGHT) + GAP);
    let pixel = |at: u32| i32::try_from(at).unwrap_or(i32::MAX);
    let mut drawn = figure::svg(size, |canvas| {
        for (panel, (left, top)) in panels.iter().zip(&places) {
            for (line, up) in panel.title.iter().zip([2, 1]) {
                let at = (
                    pixel(*left),
                    pixel(*top) - up * LINE_HEIGHT + LINE_HEIGHT / 2 - 4,
                );
                canvas.draw(&Text::new(line.clone(), at, text(SMALL)))?;
            }
            let corners = [
                (pixel(*left) - 1, pixel(*top) - 1),
                (pixel(left + width), pixel(top + height)),
            ];
            canvas.draw(&Rectangle::new(corners, GRID.mix(1.0).filled()))?;
            canvas.draw(&Rectangle::new(corners, INK))?;
        }
        Ok(())
    })?;
    let end = drawn.rfind("</svg>").unwrap_or(drawn.len());
    let tail = drawn.split_off(end);
    for (panel, (left, top)) in panels.iter().zip(&places) {
        let link = png_link(side(panel.width_px), &panel.grey)
            .map_err(|error| FigureError::Picture(error.to_string()))?;
        let place = format!("x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"");
        drawn.push_str(
            &[
                "<image ",
                &place,
                " preserveAspectRatio=\"none\" href=\"",
                &link,
                "\"/>\n",
            ]
            .concat(),
        );
    }
    Ok(drawn + &tail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_panel_has_its_title_and_image() {
        let panel = |title: &str| Panel {
            title: [title.to_owned(), "second line".to_owned()],
            width_px: 2,
            grey: vec![0, 80, 160, 240],
        };
        let svg = svg(&[panel("before"), panel("after"), panel("difference")]).unwrap();
        assert_eq!(svg.matches("<image ").count(), 3);
        assert!(svg.contains("before") && svg.contains("difference") && svg.ends_with("</svg>\n"));
        assert!(super::svg(&[]).is_err());
        let mut odd = panel("odd");
        odd.grey.pop();
        assert!(super::svg(&[odd]).is_err());
    }
}
