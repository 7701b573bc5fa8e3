//! Points in and answers out, block by block: CSV, or arrays of NumPy.

mod answers;
mod block;
mod columns;
mod csv_points;
mod decimal;
mod npy_points;
mod source;

pub use answers::{Answer, Answers};
pub use block::Block;
pub use source::{Blocks, Checked, Source};

pub(super) use csv_points::csv_failure;

use std::path::Path;

use clap::ValueEnum;

/// How points are written down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PointFormat {
    /// A header and a row for each.
    Csv,
    /// An array of NumPy, a row for each, C order, f4 or f8 little-endian, millimetres.
    Npy,
}

impl PointFormat {
    /// What the file's name says.
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
        }
    }
}

/// What the two coordinate columns of a point file mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// `x_mm`, `y_mm` of the sensor frame.
    Sensor,
    /// `col_px`, `row_px`.
    Pixel,
}

impl Frame {
    const ALL: [Self; 2] = [Self::Sensor, Self::Pixel];

    const fn columns(self) -> [&'static str; 2] {
        match self {
            Self::Sensor => ["x_mm", "y_mm"],
            Self::Pixel => ["col_px", "row_px"],
        }
    }
}

/// How precise the numbers of an array are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// `<f4`.
    Single,
    /// `<f8`.
    Double,
}

impl Precision {
    const fn bytes(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }

    const fn type_name(self) -> &'static str {
        match self {
            Self::Single => "<f4",
            Self::Double => "<f8",
        }
    }
}
