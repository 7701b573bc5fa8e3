//! Residual grid: header and coefficients, checked.

use super::bounds::GridBounds;
use super::grid_error::GridError;
use super::header::GridHeader;
use super::node::{NODE_BYTES, components};
use super::range::{CRC_BYTES, HEADER_BYTES};
use crate::geometry::sensor::SensorPoint;

/// A residual grid that has been checked; its coefficients stay in the bytes of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualGrid<'a> {
    summary: GridSummary,
    nodes: &'a [[u8; NODE_BYTES]],
}

/// Everything about a checked grid but its coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GridSummary {
    header: GridHeader,
    bounds: GridBounds,
    pub(super) crc32: u32,
}

impl<'a> ResidualGrid<'a> {
    /// Reads the file of a grid, laid out as [`GridHeader`] says.
    ///
    /// # Errors
    /// [`GridError`] for another kind of file, a number that is not allowed, a file that is cut
    /// short or too long, and a wrong CRC.
    pub fn parse(file: &'a [u8]) -> Result<Self, GridError> {
        let cut_short = || GridError::Length {
            bytes: file.len(),
            expected: HEADER_BYTES + CRC_BYTES,
        };
        let header = file.first_chunk().ok_or_else(cut_short)?;
        let header = GridHeader::parse(header, file.len())?;
        let (checked, stored) = file.split_last_chunk().ok_or_else(cut_short)?;
        let stored = u32::from_le_bytes(*stored);
        let computed = GridHeader::checksum(checked);
        if stored != computed {
            return Err(GridError::Crc { stored, computed });
        }
        let coefficients = checked.get(HEADER_BYTES..).ok_or_else(cut_short)?;
        let (nodes, _) = coefficients.as_chunks();
        let summary = GridSummary {
            header,
            bounds: GridBounds::new(&header, nodes),
            crc32: stored,
        };
        Ok(Self { summary, nodes })
    }

    /// Returns the grid of a file that has been parsed before; `None` for a file that is too short.
    pub(super) fn again(summary: GridSummary, file: &'a [u8]) -> Option<Self> {
        let (checked, _) = file.split_last_chunk::<CRC_BYTES>()?;
        let (nodes, _) = checked.get(HEADER_BYTES..)?.as_chunks();
        Some(Self { summary, nodes })
    }

    /// Returns the grid if its cells cover the rectangle between two corners.
    ///
    /// # Units and frames
    /// Sensor frame, mm: `from` is the corner of the least x and y. A grid of the lens needs the
    /// sensor enlarged by half the stroke along the FMC axis, both ways.
    ///
    /// # Errors
    /// [`GridError::Uncovered`] with both rectangles, also for a corner that is not a number.
    pub fn covering(self, from: SensorPoint, to: SensorPoint) -> Result<Self, GridError> {
        let [cells_from, cells_to] = self.cells();
        let covers = cells_from.x_mm <= from.x_mm
            && cells_from.y_mm <= from.y_mm
            && cells_to.x_mm >= to.x_mm
            && cells_to.y_mm >= to.y_mm;
        if covers {
            Ok(self)
        } else {
            let pair = |point: SensorPoint| [point.x_mm, point.y_mm];
            Err(GridError::Uncovered {
                from_mm: pair(cells_from),
                to_mm: pair(cells_to),
                region_from_mm: pair(from),
                region_to_mm: pair(to),
            })
        }
    }

    /// Corners of the cells, of the least and of the largest x and y: from the second to the last
    /// but one node.
    #[must_use]
    pub fn cells(&self) -> [SensorPoint; 2] {
        let GridHeader {
            first_node,
            pitch_mm,
            columns,
            rows,
            ..
        } = self.summary.header;
        let last = |nodes: u16| f32::from(nodes.saturating_sub(2));
        [
            SensorPoint::new(first_node.x_mm + pitch_mm, first_node.y_mm + pitch_mm),
            SensorPoint::new(
                first_node.x_mm + last(columns) * pitch_mm,
                first_node.y_mm + last(rows) * pitch_mm,
            ),
        ]
    }

    /// Header of the file.
    #[must_use]
    pub const fn header(&self) -> &GridHeader {
        &self.summary.header
    }

    pub(super) const fn summary(&self) -> GridSummary {
        self.summary
    }

    /// CRC-32 with which the file ends.
    #[must_use]
    pub const fn crc32(&self) -> u32 {
        self.summary.crc32
    }

    /// Bounds of the slope and of the curvature.
    #[must_use]
    pub const fn bounds(&self) -> &GridBounds {
        &self.summary.bounds
    }

    /// Returns the coefficient of a node, in units of the scale, or `None` outside the grid.
    #[must_use]
    pub fn coefficient(&self, column: u16, row: u16) -> Option<[i16; 2]> {
        if column >= self.summary.header.columns {
            return None;
        }
        let index =
            usize::from(row) * usize::from(self.summary.header.columns) + usize::from(column);
        self.nodes.get(index).map(|node| components(*node))
    }

    pub(super) const fn nodes(&self) -> &'a [[u8; NODE_BYTES]] {
        self.nodes
    }
}
