//! Ranges of the numbers in the header of a residual grid.

use super::node::NODE_BYTES;

/// Bytes before the coefficients.
pub(super) const HEADER_BYTES: usize = 28;
/// Bytes after the coefficients.
pub(super) const CRC_BYTES: usize = 4;

/// Largest number of nodes of a grid: 16 kB of coefficients.
pub const MAX_NODES: u16 = 4096;
/// Bytes of the file of the largest grid.
pub const MAX_FILE_BYTES: usize = HEADER_BYTES + NODE_BYTES * MAX_NODES as usize + CRC_BYTES;
/// Smallest number of nodes along a side: those of one cell.
pub const MIN_SIDE_NODES: u16 = 4;

/// Version of the file.
pub(super) const VERSION: u16 = 1;
/// Least and largest pitch, mm.
pub(super) const PITCH_MM: [f32; 2] = [0.05, 100.0];
/// Least and largest scale of the coefficients, mm.
pub(super) const SCALE_MM: [f32; 2] = [1e-12, 1e-3];
/// Farthest place of the first node along x and y, mm.
pub(super) const FIRST_NODE_MM: f32 = 1000.0;
