//! Calibrations that come over the link in parts.
//!
//! [`Request::BeginLoad`] announces length and CRC-32 of the bytes that `postcard` makes of a
//! [`CameraParameters`], [`Request::LoadPart`] brings them, in order, and the last part puts the
//! calibration into use. Until then, and after a refusal of the whole, the camera uses the one
//! before. A flight that was prepared ends with it, or goes on if it was announced so
//! ([`Upload::requests_in_flight`]). A load begins anew with another announcement, and is abandoned
//! when a session is opened.
//!
//! Behind the parameters of a camera with residual grids stand their [`GridChecksums`], so that the
//! CRC-32, which is that of the calibration's identity, covers the grids. Their files come before,
//! by [`Request::BeginGrid`] and [`Request::GridPart`], into memory that no camera uses. A grid
//! that is there already need not come again: where one is missing, the last part of the parameters
//! is refused ([`GridMemoryError::Missing`](crate::flight::grid_memory::GridMemoryError::Missing))
//! and the calibration before stays, with its grids.
//!
//! Behind the [`GridChecksums`], which are both `None` in a camera without grids, stands the
//! [`FocusTable`] of a camera that has one.

use heapless::Vec;
use serde::{Serialize, Serializer};

use super::message::{Part, Refusal, Request};
use super::packet::CRC;
use super::{CALIBRATION_CAPACITY, MAX_GRID_PART, MAX_PART};
use crate::flight::camera::CameraParameters;
use crate::geometry::focus_table::FocusTable;
use crate::geometry::grid::{GridChecksums, ResidualGrid};

/// Parameters of a camera with what stands behind them.
pub(super) struct Whole<'a>(pub(super) &'a CameraParameters);

impl Serialize for Whole<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(parameters) = self;
        let CameraParameters { grids, focus, .. } = parameters;
        // A tuple is its elements, one behind the other.
        if !focus.is_empty() {
            (parameters, grids, focus).serialize(serializer)
        } else if !grids.is_empty() {
            (parameters, grids).serialize(serializer)
        } else {
            parameters.serialize(serializer)
        }
    }
}

/// A camera's parameters as the PC sends them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Upload {
    bytes: Vec<u8, CALIBRATION_CAPACITY>,
    crc: u32,
}

impl Upload {
    /// Returns the upload of a camera; `None` only if they were longer than
    /// [`CALIBRATION_CAPACITY`].
    #[must_use]
    pub fn of(record: &CameraParameters) -> Option<Self> {
        let mut buffer = [0; CALIBRATION_CAPACITY];
        let bytes = postcard::to_slice(&Whole(record), &mut buffer).ok()?;
        let bytes = Vec::from_slice(bytes).ok()?;
        Some(Self {
            crc: CRC.checksum(&bytes),
            bytes,
        })
    }

    /// CRC-32 of the bytes: that of the calibration's identity.
    #[must_use]
    pub const fn crc(&self) -> u32 {
        self.crc
    }

    /// The bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The requests that load the calibration, in order. An earlier flight ends.
    pub fn requests(&self) -> impl Iterator<Item = Request> {
        self.requests_for(false)
    }

    /// The same, for the flight that is under way, which goes on.
    pub fn requests_in_flight(&self) -> impl Iterator<Item = Request> {
        self.requests_for(true)
    }

    fn requests_for(&self, keeps_flight: bool) -> impl Iterator<Item = Request> {
        let begin = Request::BeginLoad {
            length: number(self.bytes.len()),
            crc: self.crc,
            keeps_flight,
        };
        core::iter::once(begin).chain(self.parts(MAX_PART).map(Request::LoadPart))
    }

    /// All parts, in order, of so many bytes, which must not be 0 nor more than [`MAX_PART`]; the
    /// last may be shorter.
    pub fn parts(&self, length: usize) -> impl Iterator<Item = Part> {
        parts(&self.bytes, self.crc, length)
    }
}

/// Returns the requests that load the file of a residual grid, in order; `None` for bytes that are
/// the file of no grid.
#[must_use]
pub fn grid_requests(file: &[u8]) -> Option<impl Iterator<Item = Request>> {
    let grid = ResidualGrid::parse(file).ok()?;
    let crc = grid.crc32();
    let begin = Request::BeginGrid {
        carrier: grid.header().carrier,
        length: number(file.len()),
        crc,
    };
    let parts = parts(file, crc, MAX_GRID_PART).map(Request::GridPart);
    Some(core::iter::once(begin).chain(parts))
}

/// Returns the parts of so many bytes each, at least one and at most as many as a part holds.
fn parts<const CAPACITY: usize>(
    bytes: &[u8],
    crc: u32,
    length: usize,
) -> impl Iterator<Item = Part<CAPACITY>> {
    let length = length.clamp(1, CAPACITY);
    let offsets = (0..).step_by(length);
    offsets
        .zip(bytes.chunks(length))
        .map(move |(offset, piece)| Part {
            crc,
            offset: number(offset),
            // There is room for a piece.
            bytes: Vec::from_slice(piece).unwrap_or_default(),
        })
}

/// Bytes that have been announced and come in parts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Announced {
    pub(super) length: u32,
    pub(super) crc: u32,
}

impl Announced {
    /// Checks that a part is the next behind so many bytes; returns `true` if it is the last.
    pub(super) fn is_last<const CAPACITY: usize>(
        self,
        part: &Part<CAPACITY>,
        received: usize,
    ) -> Result<bool, Refusal> {
        if part.crc != self.crc {
            return Err(Refusal::OtherLoad);
        }
        let expected = number(received);
        if part.offset != expected {
            return Err(Refusal::PartOutOfOrder { expected });
        }
        let received = expected.saturating_add(number(part.bytes.len()));
        if received > self.length {
            return Err(Refusal::PartTooLong);
        }
        Ok(received == self.length)
    }
}

/// A calibration of which parts have come.
#[derive(Debug)]
pub(super) struct Loading {
    announced: Option<Announced>,
    /// The flight under way goes on with it.
    keeps_flight: bool,
    bytes: Vec<u8, CALIBRATION_CAPACITY>,
}

impl Loading {
    pub(super) const NONE: Self = Self {
        announced: None,
        keeps_flight: false,
        bytes: Vec::new(),
    };

    /// Forgets what has come.
    pub(super) fn end(&mut self) {
        self.announced = None;
        self.bytes.clear();
    }

    /// Begins a load of so many bytes; ends another.
    pub(super) fn begin(
        &mut self,
        length: u32,
        crc: u32,
        keeps_flight: bool,
    ) -> Result<(), Refusal> {
        if length == 0 || length > number(CALIBRATION_CAPACITY) {
            return Err(Refusal::LoadLength { length });
        }
        self.end();
        self.announced = Some(Announced { length, crc });
        self.keeps_flight = keeps_flight;
        Ok(())
    }

    /// Returns `true` if the flight under way is to go on with the calibration.
    pub(super) const fn keeps_flight(&self) -> bool {
        self.keeps_flight
    }

    /// Bytes that have come.
    pub(super) fn received(&self) -> u32 {
        number(self.bytes.len())
    }

    /// Takes the next part; returns `true` if the bytes are complete now.
    pub(super) fn add(&mut self, part: &Part) -> Result<bool, Refusal> {
        let announced = self.announced.ok_or(Refusal::NoLoad)?;
        let is_last = announced.is_last(part, self.bytes.len())?;
        // There is room for the length announced.
        let _ = self.bytes.extend_from_slice(&part.bytes);
        Ok(is_last)
    }

    /// Returns the parameters that the complete bytes make, and their CRC-32. The load ends.
    pub(super) fn finish(&mut self) -> Result<(CameraParameters, u32), Refusal> {
        let record = self.read();
        self.end();
        record
    }

    fn read(&self) -> Result<(CameraParameters, u32), Refusal> {
        let Announced { crc, .. } = self.announced.ok_or(Refusal::NoLoad)?;
        let computed = CRC.checksum(&self.bytes);
        if computed != crc {
            return Err(Refusal::LoadCrc { computed });
        }
        let record = parameters(&self.bytes).ok_or(Refusal::NoRecord)?;
        Ok((record, crc))
    }
}

/// Returns the parameters that the bytes of an [`Upload`] make; `None` for other bytes.
#[must_use]
pub fn parameters(bytes: &[u8]) -> Option<CameraParameters> {
    let (mut record, rest) = postcard::take_from_bytes::<CameraParameters>(bytes).ok()?;
    // Parts that a camera does not have are not there, so that it has one CRC-32.
    if rest.is_empty() {
        return Some(record);
    }
    let (grids, rest) = postcard::take_from_bytes::<GridChecksums>(rest).ok()?;
    record.grids = grids;
    if rest.is_empty() {
        return (!grids.is_empty()).then_some(record);
    }
    let (focus, rest) = postcard::take_from_bytes::<FocusTable>(rest).ok()?;
    record.focus = focus;
    (rest.is_empty() && !focus.is_empty()).then_some(record)
}

/// A number of bytes; all are less than those of the largest grid.
#[expect(clippy::cast_possible_truncation, reason = "17 thousand fit")]
pub(super) const fn number(bytes: usize) -> u32 {
    bytes as u32
}
