//! The header of a point file of many frames.

use csv::ByteRecord;

use super::block::FrameBlock;
use super::frame_key::{FrameFinder, KeyColumn};
use crate::formats::points::CoordinateFrame;

/// Places of the columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CsvHeader {
    /// Names of all columns.
    pub(super) names: Vec<String>,
    pub(super) key: KeyColumn,
    pub(super) key_place: usize,
    pub(super) coordinates: [usize; 2],
    pub(super) frame: CoordinateFrame,
}

impl CsvHeader {
    pub(super) fn find(header: &ByteRecord, finder: &FrameFinder) -> Result<Self, String> {
        let names = header
            .iter()
            .map(|name| {
                let name = String::from_utf8(name.trim_ascii().to_vec());
                name.map_err(|_| "the names of the columns are not text (UTF-8)".to_owned())
            })
            .collect::<Result<Vec<_>, _>>()?;
        if names.iter().all(String::is_empty) {
            return Err("the file is empty".to_owned());
        }
        for (index, name) in names.iter().enumerate() {
            if names.iter().skip(index + 1).any(|other| other == name) {
                return Err(format!("column {} appears twice", name.escape_debug()));
            }
        }
        let all = || names.iter().map(String::as_str);
        let (frame, coordinates) = coordinates(&all())?;
        let (key, key_place) = KeyColumn::find(all(), finder.has_images())?;
        Ok(Self {
            names,
            key,
            key_place,
            coordinates,
            frame,
        })
    }
}

/// Column of the names of the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IdColumn {
    place: usize,
    /// Number of columns.
    columns: usize,
}

impl IdColumn {
    /// Returns the name of a point of a block.
    pub(super) fn cell(self, block: &FrameBlock, index: usize) -> &[u8] {
        block.cell(index * self.columns + self.place)
    }
}

impl CsvHeader {
    /// Returns the column of the names of the points: `point`, else `id`.
    pub(super) fn ids(&self) -> Option<IdColumn> {
        let at = |wanted: &str| self.names.iter().position(|name| name == wanted);
        Some(IdColumn {
            place: at("point").or_else(|| at("id"))?,
            columns: self.names.len(),
        })
    }
}

/// Returns the frame of the coordinates, and the places of their columns.
pub(super) fn coordinates<'a>(
    names: &(impl Iterator<Item = &'a str> + Clone),
) -> Result<(CoordinateFrame, [usize; 2]), String> {
    let mut found = None;
    for frame in CoordinateFrame::ALL {
        let columns = frame.columns();
        let [first, second] = columns;
        let [a, b] = columns.map(|wanted| names.clone().position(|name| name == wanted));
        match (a, b, &found) {
            (None, None, _) => {}
            (Some(_), Some(_), Some(_)) => {
                return Err("both x_mm,y_mm and col_px,row_px are given".to_owned());
            }
            (Some(a), Some(b), None) => found = Some((frame, [a, b])),
            (None, Some(_), _) => return Err(format!("column {first} is missing")),
            (Some(_), None, _) => return Err(format!("column {second} is missing")),
        }
    }
    found.ok_or_else(|| "columns x_mm and y_mm, or col_px and row_px, are missing".to_owned())
}
