//! Header of the file of a residual grid.

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

use super::grid_error::GridError;
use super::node::NODE_BYTES;
use super::range::{
    CRC_BYTES, FIRST_NODE_MM, HEADER_BYTES, MAX_NODES, MIN_SIDE_NODES, PITCH_MM, SCALE_MM, VERSION,
};
use crate::geometry::sensor::SensorPoint;

/// First bytes of the file.
const MAGIC: [u8; 4] = *b"FMCG";

/// CRC-32 (ISO-HDLC), bit by bit: a grid is read once, its table would lie in memory for ever.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Part of the camera that carries the structure of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum GridCarrier {
    /// The lens: the structure moves with the principal point and grows with the image.
    Lens,
    /// The sensor, by its flatness: the structure stays at its pixels.
    Sensor,
}

impl fmt::Display for GridCarrier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Lens => "lens",
            Self::Sensor => "sensor",
        })
    }
}

impl GridCarrier {
    const fn number(self) -> u16 {
        match self {
            Self::Lens => 0,
            Self::Sensor => 1,
        }
    }
}

/// Everything in the file of a residual grid but the coefficients.
///
/// # Model
/// The file is, little endian: `FMCG`, version 1 (u16), frame (u16: 0 lens, 1 sensor), columns and
/// rows (u16 each), x and y of the first node, pitch and scale (f32 each, mm); the coefficients
/// (i16 of x, then of y, node by node along x, row by row along y); the CRC-32 (ISO-HDLC) of all
/// of it. Node (j, i) lies at the first node + pitch·(j, i), its coefficient is scale·i16.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridHeader {
    /// Part that carries the structure.
    pub carrier: GridCarrier,
    /// Nodes along x.
    pub columns: u16,
    /// Nodes along y.
    pub rows: u16,
    /// Node of the least x and y.
    pub first_node: SensorPoint,
    /// Distance of neighbouring nodes, mm.
    pub pitch_mm: f32,
    /// Unit of the coefficients, mm.
    pub scale_mm: f32,
}

impl GridHeader {
    /// Returns the CRC-32 with which a file ends whose other bytes are given.
    #[must_use]
    pub fn checksum(bytes: &[u8]) -> u32 {
        CRC.checksum(bytes)
    }

    /// Returns the header as it stands in the file.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; 28] {
        let [m0, m1, m2, m3] = MAGIC;
        let [v0, v1] = VERSION.to_le_bytes();
        let [f0, f1] = self.carrier.number().to_le_bytes();
        let [c0, c1] = self.columns.to_le_bytes();
        let [r0, r1] = self.rows.to_le_bytes();
        let [x0, x1, x2, x3] = self.first_node.x_mm.to_le_bytes();
        let [y0, y1, y2, y3] = self.first_node.y_mm.to_le_bytes();
        let [p0, p1, p2, p3] = self.pitch_mm.to_le_bytes();
        let [s0, s1, s2, s3] = self.scale_mm.to_le_bytes();
        [
            m0, m1, m2, m3, v0, v1, f0, f1, c0, c1, r0, r1, x0, x1, x2, x3, y0, y1, y2, y3, p0, p1,
            p2, p3, s0, s1, s2, s3,
        ]
    }

    /// Reads the header of a file of `length` bytes.
    pub(super) fn parse(bytes: &[u8; HEADER_BYTES], length: usize) -> Result<Self, GridError> {
        let [
            m0,
            m1,
            m2,
            m3,
            v0,
            v1,
            f0,
            f1,
            c0,
            c1,
            r0,
            r1,
            x0,
            x1,
            x2,
            x3,
            y0,
            y1,
            y2,
            y3,
            p0,
            p1,
            p2,
            p3,
            s0,
            s1,
            s2,
            s3,
        ] = *bytes;
        let begins_with = [m0, m1, m2, m3];
        if begins_with != MAGIC {
            return Err(GridError::NoGrid { begins_with });
        }
        let version = u16::from_le_bytes([v0, v1]);
        if version != VERSION {
            return Err(GridError::Version(version));
        }
        let carrier = match u16::from_le_bytes([f0, f1]) {
            0 => GridCarrier::Lens,
            1 => GridCarrier::Sensor,
            other => return Err(GridError::Carrier(other)),
        };
        let header = Self {
            carrier,
            columns: u16::from_le_bytes([c0, c1]),
            rows: u16::from_le_bytes([r0, r1]),
            first_node: SensorPoint::new(
                f32::from_le_bytes([x0, x1, x2, x3]),
                f32::from_le_bytes([y0, y1, y2, y3]),
            ),
            pitch_mm: f32::from_le_bytes([p0, p1, p2, p3]),
            scale_mm: f32::from_le_bytes([s0, s1, s2, s3]),
        };
        header.check()?;
        let expected = header.file_bytes();
        if length != expected {
            return Err(GridError::Length {
                bytes: length,
                expected,
            });
        }
        Ok(header)
    }

    /// Checks the numbers of nodes and the ranges of the lengths.
    ///
    /// # Errors
    /// [`GridError`] with the value that is not allowed.
    pub fn check(&self) -> Result<(), GridError> {
        let Self {
            columns,
            rows,
            pitch_mm,
            scale_mm,
            first_node,
            ..
        } = *self;
        let nodes = u32::from(columns) * u32::from(rows);
        if columns.min(rows) < MIN_SIDE_NODES || nodes > u32::from(MAX_NODES) {
            return Err(GridError::Nodes { columns, rows });
        }
        // A NaN is in no range.
        let is_in = |[least, most]: [f32; 2], value: f32| value >= least && value <= most;
        if !is_in(PITCH_MM, pitch_mm) {
            return Err(GridError::Pitch { pitch_mm });
        }
        if !is_in(SCALE_MM, scale_mm) {
            return Err(GridError::Scale { scale_mm });
        }
        let SensorPoint { x_mm, y_mm } = first_node;
        let places = [-FIRST_NODE_MM, FIRST_NODE_MM];
        if !is_in(places, x_mm) || !is_in(places, y_mm) {
            return Err(GridError::FirstNode { x_mm, y_mm });
        }
        Ok(())
    }

    /// Bytes of the file.
    #[must_use]
    pub fn file_bytes(&self) -> usize {
        let nodes = usize::from(self.columns).saturating_mul(self.rows.into());
        nodes
            .saturating_mul(NODE_BYTES)
            .saturating_add(HEADER_BYTES + CRC_BYTES)
    }
}
