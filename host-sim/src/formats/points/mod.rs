//! Points and answers, block by block: CSV, or arrays of NumPy.

mod answers;
mod block;
mod columns;
mod csv_cell;
mod csv_points;
pub(super) mod decimal;
mod npy_points;
mod plain_rows;
mod row_grammar;
mod short_decimal;
mod source;

pub use answers::{Answer, Answers, BlockAnswers};
pub use block::Block;
pub(crate) use block::{farthest, half_format_mm, off_sensor};
pub use source::{Blocks, Checked, Source};

pub(super) use columns::number;
pub(super) use csv_cell::push_cell;
pub(super) use csv_points::csv_failure;

use std::path::Path;

use clap::ValueEnum;

/// File format of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PointFormat {
    /// CSV: a header and a row for each point.
    Csv,
    /// Array of NumPy: a row for each point, C order, f4 or f8 little-endian, millimetres.
    Npy,
    /// Parquet, uncompressed or with Snappy: for points of many frames.
    Parquet,
}

impl PointFormat {
    /// Returns the format that the extension of the file's name tells.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        Self::value_variants()
            .iter()
            .copied()
            .find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    const fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Parquet => "parquet",
        }
    }
}

/// Frame of the two coordinate columns of a point file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CoordinateFrame {
    /// `x_mm`, `y_mm` of the sensor frame.
    Sensor,
    /// `col_px`, `row_px`.
    Pixel,
}

impl CoordinateFrame {
    pub(super) const ALL: [Self; 2] = [Self::Sensor, Self::Pixel];

    pub(super) const fn columns(self) -> [&'static str; 2] {
        match self {
            Self::Sensor => ["x_mm", "y_mm"],
            Self::Pixel => ["col_px", "row_px"],
        }
    }
}

/// Precision of the numbers of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// `<f4`.
    Single,
    /// `<f8`.
    Double,
}

impl Precision {
    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }

    pub(super) const fn type_name(self) -> &'static str {
        match self {
            Self::Single => "<f4",
            Self::Double => "<f8",
        }
    }
}
