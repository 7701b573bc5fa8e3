//! Blocks of consecutive points of a file, with the frame of each.

use super::parquet_column::ParquetColumn;

/// Number of points that are read, corrected and written together.
pub(super) const POINTS: usize = 8192;

/// Consecutive points of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrameBlock {
    /// Places in the sensor frame, mm, in the order of the file.
    pub points_mm: Vec<[f64; 2]>,
    /// Place of each point's frame in the table of frames.
    pub frames: Vec<u32>,
    /// Number of points of the file before the block.
    pub before: u64,
    /// Number of bytes of the file up to the end of this block.
    pub read_bytes: u64,
    /// Whole rows: the cells of CSV one behind the other, or the bytes of an array.
    pub(super) rows: Vec<u8>,
    /// End of each cell of CSV.
    pub(super) cell_ends: Vec<usize>,
    /// Line of each row of CSV.
    pub(super) lines: Vec<u64>,
    /// Columns of Parquet.
    pub(super) columns: Vec<ParquetColumn>,
}

impl FrameBlock {
    /// Empties the block, to begin behind `before` points.
    pub(super) fn restart(&mut self, before: u64) {
        self.points_mm.clear();
        self.frames.clear();
        self.before = before;
        self.rows.clear();
        self.cell_ends.clear();
        self.lines.clear();
        self.columns.clear();
    }

    /// Returns a cell of CSV, counted over the rows.
    pub(super) fn cell(&self, cell: usize) -> &[u8] {
        let before = cell
            .checked_sub(1)
            .and_then(|before| self.cell_ends.get(before));
        let ends = before.copied().unwrap_or(0)..self.cell_ends.get(cell).copied().unwrap_or(0);
        self.rows.get(ends).unwrap_or_default()
    }

    /// Place of a point in the file, for messages.
    #[must_use]
    pub fn place(&self, file: &str, index: usize) -> String {
        match self.lines.get(index) {
            Some(line) => format!("{file}, line {line}"),
            None => format!("{file}, row {}", self.before + index as u64),
        }
    }
}
