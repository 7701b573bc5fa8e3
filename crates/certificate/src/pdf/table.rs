//! Tables: columns as wide as their cells, words broken where the page is too narrow.

use super::error::PdfError;
use super::flow::{Flow, LEADING, MARGIN, WIDTH, height};
use super::typeface::Weight;
use crate::document::block::Table;

/// Sizes of the letters, the first at which the table fits.
const SIZES: [f32; 5] = [8.2, 7.6, 7.0, 6.2, 5.4];
/// Distance of columns.
const GAP: f32 = 12.0;
/// Least width of a column of words that is broken.
const LEAST: f32 = 46.0;

/// A table with the widths of its columns.
struct Laid<'t> {
    table: &'t Table,
    size: f32,
    widths: Vec<f32>,
}

impl<'a> Flow<'a> {
    /// Sets a table; its heading is repeated on every page.
    ///
    /// # Errors
    /// [`PdfError::NoGlyph`] for a character that the font does not have, and
    /// [`PdfError::TooWide`] for numbers that do not fit the page.
    pub(super) fn table(&mut self, table: &'a Table) -> Result<(), PdfError> {
        let laid = self.lay(table)?;
        let line = laid.size * LEADING;
        self.space(2.0);
        self.keep(7.0 * line);
        self.paragraph(&table.title, laid.size, Weight::Bold, 0)?;
        self.heading(&laid)?;
        for row in &table.rows {
            let cells = laid.broken(self, row)?;
            let lines = cells.iter().map(Vec::len).max().unwrap_or(1).max(1);
            let tall = height(lines, laid.size);
            if tall > self.room() {
                self.keep(tall);
                self.heading(&laid)?;
            }
            self.row(&laid, &cells, Weight::Regular)?;
        }
        let y = self.y() + 1.5;
        self.stroke(MARGIN, MARGIN + laid.width(), y, 0.4);
        self.space(9.0);
        Ok(())
    }

    fn heading(&mut self, laid: &Laid<'_>) -> Result<(), PdfError> {
        let columns = laid.table.columns.iter();
        let cells: Vec<Vec<String>> = columns
            .map(|column| column.heading.lines().map(str::to_owned).collect())
            .collect();
        // Headings of one line stand beside the last line of the others.
        let most = cells.iter().map(Vec::len).max().unwrap_or(0);
        let cells: Vec<Vec<String>> = cells
            .into_iter()
            .map(|cell| {
                let above = vec![String::new(); most - cell.len()];
                above.into_iter().chain(cell).collect()
            })
            .collect();
        self.row(laid, &cells, Weight::Bold)?;
        let y = self.y() + 1.0;
        self.stroke(MARGIN, MARGIN + laid.width(), y, 0.4);
        self.space(2.5);
        Ok(())
    }

    fn row(
        &mut self,
        laid: &Laid<'_>,
        cells: &[Vec<String>],
        weight: Weight,
    ) -> Result<(), PdfError> {
        let lines = cells.iter().map(Vec::len).max().unwrap_or(0);
        for index in 0..lines {
            let mut left = MARGIN;
            for ((cell, column), width) in cells.iter().zip(&laid.table.columns).zip(&laid.widths) {
                if let Some(text) = cell.get(index).filter(|text| !text.is_empty()) {
                    let length = self.typeface.width(text, weight, laid.size)?;
                    let x = if column.is_words {
                        left
                    } else {
                        left + width - length
                    };
                    self.write(x, text, laid.size, weight, 0);
                }
                left += width + GAP;
            }
            self.space(laid.size * LEADING);
        }
        Ok(())
    }

    /// Finds the largest letters at which a table fits the page.
    fn lay<'t>(&self, table: &'t Table) -> Result<Laid<'t>, PdfError> {
        for size in SIZES {
            let natural = self.natural(table, size)?;
            let is_broken = |index: usize, width: f32| {
                table.columns.get(index).is_some_and(|one| one.is_words) && width > LEAST
            };
            let gaps = GAP * f32::from(u8::try_from(natural.len()).unwrap_or(u8::MAX) - 1);
            let all: f32 = natural.iter().sum();
            let words: f32 = natural
                .iter()
                .enumerate()
                .filter(|(index, width)| is_broken(*index, **width))
                .map(|(_, width)| width)
                .sum();
            let too_much = all + gaps - WIDTH;
            if too_much <= 0.0 {
                return Ok(Laid {
                    table,
                    size,
                    widths: natural,
                });
            }
            // Columns of words share what is too much by their widths.
            let share = 1.0 - too_much / words.max(1.0);
            let widths: Vec<f32> = natural
                .iter()
                .enumerate()
                .map(|(index, width)| {
                    if is_broken(index, *width) {
                        width * share
                    } else {
                        *width
                    }
                })
                .collect();
            let fits = share > 0.0
                && widths
                    .iter()
                    .zip(&natural)
                    .all(|(width, natural)| *width >= LEAST.min(*natural));
            if fits {
                return Ok(Laid {
                    table,
                    size,
                    widths,
                });
            }
        }
        Err(PdfError::TooWide(table.title.clone()))
    }

    /// Returns the widths at which no cell is broken.
    fn natural(&self, table: &Table, size: f32) -> Result<Vec<f32>, PdfError> {
        let mut widths = Vec::new();
        for (index, column) in table.columns.iter().enumerate() {
            let mut widest = 0.0_f32;
            for line in column.heading.lines() {
                widest = widest.max(self.typeface.width(line, Weight::Bold, size)?);
            }
            for cell in table.rows.iter().filter_map(|row| row.get(index)) {
                widest = widest.max(self.typeface.width(cell, Weight::Regular, size)?);
            }
            widths.push(widest);
        }
        Ok(widths)
    }
}

impl Laid<'_> {
    fn width(&self) -> f32 {
        let columns = u8::try_from(self.widths.len()).unwrap_or(u8::MAX);
        self.widths.iter().sum::<f32>() + GAP * f32::from(columns.saturating_sub(1))
    }

    /// Breaks the cells of a row into lines.
    fn broken(&self, flow: &Flow<'_>, row: &[String]) -> Result<Vec<Vec<String>>, PdfError> {
        row.iter()
            .zip(&self.widths)
            .map(|(cell, width)| {
                let typeface = flow.typeface;
                typeface.lines(cell, Weight::Regular, self.size, width + 0.1)
            })
            .collect()
    }
}
