//! Residual grid at random points: all bits of the displacements in one number, which is the same
//! on the PC and on the target.

use fmc_camera::geometry::grid::{GridCarrier, GridHeader, PlacedGrid, ResidualGrid};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};

/// The number of [`bits`].
pub(crate) const BITS: u32 = 0x7343_00d8;

/// Number of points.
pub(crate) const POINTS: u16 = 50_000;

const HEADER: GridHeader = GridHeader {
    carrier: GridCarrier::Lens,
    columns: 31,
    rows: 25,
    first_node: SensorPoint::new(-30.0, -24.0),
    pitch_mm: 2.0,
    scale_mm: 1e-7,
};
const BYTES: usize = 28 + 4 * 31 * 25 + 4;

/// Returns the bits of the displacements at points within the cells and beyond, folded by
/// multiplication (FNV-1a); `None` if the file is refused.
pub(crate) fn bits() -> Option<u32> {
    let mut word = 1_u32;
    let mut next = move || {
        word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        word
    };
    let mut file = [0; BYTES];
    let (head, rest) = file.split_first_chunk_mut()?;
    *head = HEADER.to_bytes();
    let (nodes, _) = rest.split_last_chunk_mut::<4>()?;
    for node in nodes.as_chunks_mut().0 {
        *node = next().to_be_bytes();
    }
    let (checked, crc) = file.split_last_chunk_mut()?;
    *crc = GridHeader::checksum(checked).to_le_bytes();
    let grid = ResidualGrid::parse(&file).ok()?;
    let placed = PlacedGrid::new(&grid, FmcAxis::MinusX, 0.15, 1.3e-4);
    let mut folded = 0x811c_9dc5_u32;
    for _ in 0..POINTS {
        // Within 32 mm, in steps of a 2⁻¹⁰th.
        let mut coordinate = || {
            let [high, low, ..] = next().to_be_bytes();
            f32::from(i16::from_be_bytes([high, low])) / 1024.0
        };
        let point = SensorPoint::new(coordinate(), coordinate() * 0.8);
        let d = placed.displacement(point);
        for component in [d.dx_mm, d.dy_mm] {
            folded = (folded ^ component.to_bits()).wrapping_mul(0x0100_0193);
        }
    }
    Some(folded)
}
