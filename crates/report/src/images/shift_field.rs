//! Map of the shifts of an image's blocks.

use plotters::element::{Rectangle, Text};
use plotters::prelude::{ChartBuilder, Color, RGBColor};
use plotters::style::text_anchor::HPos;

use crate::figure::{
    self, FONT, FigureError, GRID, INK, OUTLINE, SMALL, TITLE, WIDTH, pixels, text, text_at,
};
use crate::wording;

/// Largest number of cells along a side; with more blocks, a cell has the longest shift of several.
const CELLS: u32 = 64;
const TITLE_HEIGHT: u32 = 84;
const LEGEND_HEIGHT: u32 = 96;
const AXIS_WIDTH: u32 = 96;
const AXIS_HEIGHT: u32 = 70;
const EDGE: u32 = 24;
/// Steps of the legend.
const STEPS: u32 = 8;

/// Shift of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// First column and row of the block.
    pub first_px: [u32; 2],
    /// Length of the shift, pixels; `None` where it was not found.
    pub length_px: Option<f64>,
}

/// Draws the lengths of the shifts of an image of `size_px` in SVG.
///
/// # Errors
/// [`FigureError`] if no block has a shift, or if the drawing fails.
pub fn svg(
    titles: &[String; 2],
    size_px: [u32; 2],
    shifts: &[Shift],
) -> Result<String, FigureError> {
    let longest = shifts
        .iter()
        .filter_map(|shift| shift.length_px)
        .reduce(f64::max)
        .ok_or(FigureError::NothingToDraw)?;
    let [width, height] = size_px;
    let cell_px = width
        .max(height)
        .div_ceil(CELLS)
        .max(64)
        .next_multiple_of(64);
    let plot_width = WIDTH - AXIS_WIDTH - 2 * EDGE;
    let plot_height = pixels(f64::from(plot_width) * f64::from(height) / f64::from(width));
    let chart_height = TITLE_HEIGHT + plot_height.unsigned_abs() + AXIS_HEIGHT;
    figure::svg((WIDTH, chart_height + LEGEND_HEIGHT), |canvas| {
        for (title, (y, font)) in titles.iter().zip([(24, TITLE), (56, FONT)]) {
            canvas.draw(&Text::new(title.clone(), (16, y), text(font)))?;
        }
        let (upper, legend) = canvas.split_vertically(chart_height);
        let mut chart = ChartBuilder::on(&upper)
            .margin_top(TITLE_HEIGHT)
            .margin_left(EDGE)
            .margin_right(EDGE)
            .x_label_area_size(AXIS_HEIGHT)
            .y_label_area_size(AXIS_WIDTH)
            .build_cartesian_2d(0.0..f64::from(width), f64::from(height)..0.0)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .axis_style(GRID)
            .x_labels(6)
            .y_labels(6)
            .label_style(text(SMALL))
            .axis_desc_style(text(SMALL))
            .x_label_formatter(&|px| wording::decimals(*px, 0))
            .y_label_formatter(&|px| wording::decimals(*px, 0))
            .x_desc("column, px")
            .y_desc("row, px")
            .draw()?;
        let cells = cells(shifts, cell_px);
        chart.draw_series(cells.iter().map(|(first_px, length_px)| {
            let [col, row] = first_px.map(f64::from);
            let end = |first: f64, side: u32| (first + f64::from(cell_px)).min(f64::from(side));
            let colour = colour(length_px / longest);
            Rectangle::new(
                [(col, row), (end(col, width), end(row, height))],
                colour.filled(),
            )
        }))?;
        let outline = [(0.0, 0.0), (f64::from(width), f64::from(height))];
        chart.draw_series([Rectangle::new(outline, OUTLINE.stroke_width(2))])?;
        let left = pixels(f64::from(AXIS_WIDTH + EDGE));
        let step_px = pixels(f64::from(plot_width) / f64::from(STEPS));
        for (step, at) in (0..STEPS).zip(0..) {
            let part = (f64::from(step) + 0.5) / f64::from(STEPS);
            let begin = left + at * step_px;
            let corners = [(begin, 12), (begin + step_px, 36)];
            legend.draw(&Rectangle::new(corners, colour(part).filled()))?;
        }
        let ends = [
            (left, HPos::Left),
            (left + pixels(f64::from(plot_width)), HPos::Right),
        ];
        let words = ["0 px".to_owned(), format!("{longest:.5} px")];
        for ((x, side), words) in ends.into_iter().zip(words) {
            legend.draw(&Text::new(words, (x, 58), text_at(SMALL, side)))?;
        }
        Ok(())
    })
}

/// Returns the longest shift of each cell with its first column and row.
fn cells(shifts: &[Shift], cell_px: u32) -> Vec<([u32; 2], f64)> {
    let mut cells: std::collections::BTreeMap<[u32; 2], f64> = std::collections::BTreeMap::new();
    for shift in shifts {
        let Some(length_px) = shift.length_px else {
            continue;
        };
        let first = shift.first_px.map(|place| place / cell_px * cell_px);
        let longest = cells.entry(first).or_insert(length_px);
        *longest = longest.max(length_px);
    }
    cells.into_iter().collect()
}

/// Returns the colour of a part of the longest shift: from light to dark.
fn colour(part: f64) -> RGBColor {
    let mix = |from: u8, to: u8| {
        let value = f64::from(from) + (f64::from(to) - f64::from(from)) * part.clamp(0.0, 1.0);
        u8::try_from(pixels(value)).unwrap_or(u8::MAX)
    };
    let light = RGBColor(226, 238, 248);
    RGBColor(
        mix(light.0, INK.0),
        mix(light.1, INK.1),
        mix(light.2, INK.2),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shift(first_px: [u32; 2], length_px: Option<f64>) -> Shift {
        Shift {
            first_px,
            length_px,
        }
    }

    #[test]
    fn cell_has_its_longest_shift() {
        let shifts = [
            shift([0, 0], Some(0.1)),
            shift([64, 64], Some(0.3)),
            shift([128, 0], None),
            shift([192, 0], Some(0.2)),
        ];
        assert_eq!(cells(&shifts, 128), [([0, 0], 0.3), ([128, 0], 0.2)]);
    }

    #[test]
    fn map_has_a_cell_for_every_block_and_names_the_longest() {
        let titles = ["Shift".to_owned(), "b less a".to_owned()];
        let shifts: Vec<Shift> = (0..12)
            .map(|block| shift([64 * (block % 4), 64 * (block / 4)], Some(0.001)))
            .collect();
        let svg = svg(&titles, [256, 192], &shifts).unwrap();
        let cells = svg
            .lines()
            .filter(|line| line.contains("<rect") && line.contains("#282C34"));
        assert_eq!(cells.count(), 12);
        assert!(svg.contains("0.00100 px"));
        let none = [shift([0, 0], None)];
        assert!(super::svg(&titles, [256, 192], &none).is_err());
    }
}
