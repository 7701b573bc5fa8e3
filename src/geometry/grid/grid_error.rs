//! Reasons for which a residual grid is refused.

use core::fmt;

use super::range::{
    FIRST_NODE_MM, MAX_FILE_BYTES, MAX_NODES, MIN_SIDE_NODES, PITCH_MM, SCALE_MM, VERSION,
};

/// A residual grid is not usable.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum GridError {
    /// The file does not begin with `FMCG`.
    NoGrid {
        /// The first four bytes.
        begins_with: [u8; 4],
    },
    /// The file has another version.
    Version(u16),
    /// The part that carries the grid is neither the lens (0) nor the sensor (1).
    Carrier(u16),
    /// One side has fewer nodes than a cell needs, or there are more than the camera holds.
    Nodes {
        /// Nodes along x.
        columns: u16,
        /// Nodes along y.
        rows: u16,
    },
    /// The pitch is not a number, or outside its range.
    Pitch {
        /// Pitch, mm.
        pitch_mm: f32,
    },
    /// The scale of the coefficients is not a number, or outside its range.
    Scale {
        /// Scale, mm.
        scale_mm: f32,
    },
    /// The place of the first node is not a number, or outside its range.
    FirstNode {
        /// Place along x, mm.
        x_mm: f32,
        /// Place along y, mm.
        y_mm: f32,
    },
    /// The file is cut short, or longer than its header says.
    Length {
        /// Bytes of the file.
        bytes: usize,
        /// Bytes that a grid of this header has.
        expected: usize,
    },
    /// The file is longer than that of the largest grid.
    TooLong {
        /// Bytes of the file.
        bytes: usize,
    },
    /// The CRC-32 at the end is not that of the file.
    Crc {
        /// As stored.
        stored: u32,
        /// As computed.
        computed: u32,
    },
    /// The cells of the grid end before the region of the sensor does.
    Uncovered {
        /// Least x and least y of the cells, mm.
        from_mm: [f32; 2],
        /// Largest x and largest y of the cells, mm.
        to_mm: [f32; 2],
        /// Least x and least y of the region, mm.
        region_from_mm: [f32; 2],
        /// Largest x and largest y of the region, mm.
        region_to_mm: [f32; 2],
    },
}

impl fmt::Display for GridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoGrid { begins_with } => write!(
                f,
                "a residual grid begins with FMCG, not with \"{}\"",
                begins_with.escape_ascii()
            ),
            Self::Version(version) => write!(
                f,
                "version {version} of the residual grid is unknown; allowed: {VERSION}"
            ),
            Self::Carrier(carrier) => write!(
                f,
                "frame {carrier} of the residual grid is unknown; allowed: 0 (lens), 1 (sensor)"
            ),
            Self::Nodes { columns, rows } => write!(
                f,
                "a residual grid of {columns} x {rows} nodes; allowed: at least {MIN_SIDE_NODES} \
                 along each side and at most {MAX_NODES} in all"
            ),
            Self::Pitch { pitch_mm } => write!(
                f,
                "pitch {pitch_mm} mm of the residual grid is outside {} to {} mm",
                PITCH_MM[0], PITCH_MM[1]
            ),
            Self::Scale { scale_mm } => write!(
                f,
                "scale {scale_mm} mm of the residual grid is outside {:e} to {:e} mm",
                SCALE_MM[0], SCALE_MM[1]
            ),
            Self::FirstNode { x_mm, y_mm } => write!(
                f,
                "first node ({x_mm}, {y_mm}) mm of the residual grid is outside \
                 -{FIRST_NODE_MM} to {FIRST_NODE_MM} mm"
            ),
            Self::Length { bytes, expected } => write!(
                f,
                "{bytes} bytes of a residual grid that has {expected} by its header"
            ),
            Self::TooLong { bytes } => write!(
                f,
                "{bytes} bytes of a residual grid; allowed: up to {MAX_FILE_BYTES}, {MAX_NODES} \
                 nodes"
            ),
            Self::Crc { stored, computed } => write!(
                f,
                "the residual grid is damaged: CRC {stored:08x} at its end, {computed:08x} of its \
                 bytes"
            ),
            Self::Uncovered {
                from_mm: [from_x, from_y],
                to_mm: [to_x, to_y],
                region_from_mm: [region_x, region_y],
                region_to_mm: [region_to_x, region_to_y],
            } => write!(
                f,
                "the cells of the residual grid reach from ({from_x}, {from_y}) to \
                 ({to_x}, {to_y}) mm; required: from ({region_x}, {region_y}) to \
                 ({region_to_x}, {region_to_y}) mm, the sensor with its enlargements"
            ),
        }
    }
}

impl core::error::Error for GridError {}
