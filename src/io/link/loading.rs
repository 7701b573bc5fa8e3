//! Calibrations that come over the link in parts.
//!
//! [`Request::BeginLoad`] announces length and CRC-32 of the bytes that `postcard` makes of a
//! [`CameraParameters`], [`Request::LoadPart`] brings them, in order, and the last part puts the
//! calibration into use. Until then, and after a refusal of the whole, the camera uses the one
//! before. A load begins anew with another announcement, and is abandoned when a session is opened.

use heapless::Vec;

use super::message::{Part, Refusal, Request};
use super::packet::CRC;
use super::{CALIBRATION_CAPACITY, MAX_PART};
use crate::flight::camera::CameraParameters;

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
        let bytes = postcard::to_slice(record, &mut buffer).ok()?;
        Some(Self {
            crc: CRC.checksum(bytes),
            bytes: Vec::from_slice(bytes).ok()?,
        })
    }

    /// CRC-32 of the bytes: that of the calibration's identity.
    #[must_use]
    pub const fn crc(&self) -> u32 {
        self.crc
    }

    /// The requests that load the calibration, in order.
    pub fn requests(&self) -> impl Iterator<Item = Request> {
        let begin = Request::BeginLoad {
            length: number(self.bytes.len()),
            crc: self.crc,
        };
        core::iter::once(begin).chain(self.parts(MAX_PART).map(Request::LoadPart))
    }

    /// All parts, in order, of so many bytes, which must not be 0 nor more than [`MAX_PART`]; the
    /// last may be shorter.
    pub fn parts(&self, length: usize) -> impl Iterator<Item = Part> {
        let length = length.clamp(1, MAX_PART);
        let offsets = (0..).step_by(length);
        let pieces = self.bytes.chunks(length);
        offsets.zip(pieces).map(|(offset, piece)| Part {
            crc: self.crc,
            offset: number(offset),
            // There is room for a piece.
            bytes: Vec::from_slice(piece).unwrap_or_default(),
        })
    }
}

/// A calibration of which parts have come.
#[derive(Debug)]
pub(super) struct Loading {
    /// Length and CRC-32, as announced.
    announced: Option<(u32, u32)>,
    bytes: Vec<u8, CALIBRATION_CAPACITY>,
}

impl Loading {
    pub(super) const NONE: Self = Self {
        announced: None,
        bytes: Vec::new(),
    };

    /// Forgets what has come.
    pub(super) fn end(&mut self) {
        self.announced = None;
        self.bytes.clear();
    }

    /// Begins a load of so many bytes; ends another.
    pub(super) fn begin(&mut self, length: u32, crc: u32) -> Result<(), Refusal> {
        if length == 0 || length > number(CALIBRATION_CAPACITY) {
            return Err(Refusal::LoadLength { length });
        }
        self.end();
        self.announced = Some((length, crc));
        Ok(())
    }

    /// Bytes that have come.
    pub(super) fn received(&self) -> u32 {
        number(self.bytes.len())
    }

    /// Takes the next part; returns `true` if the bytes are complete now.
    pub(super) fn add(&mut self, part: &Part) -> Result<bool, Refusal> {
        let (length, crc) = self.announced.ok_or(Refusal::NoLoad)?;
        if part.crc != crc {
            return Err(Refusal::OtherLoad);
        }
        let expected = self.received();
        if part.offset != expected {
            return Err(Refusal::PartOutOfOrder { expected });
        }
        let received = expected.saturating_add(number(part.bytes.len()));
        if received > length {
            return Err(Refusal::PartTooLong);
        }
        // There is room for the length announced.
        let _ = self.bytes.extend_from_slice(&part.bytes);
        Ok(received == length)
    }

    /// Returns the parameters that the complete bytes make, and their CRC-32. The load ends.
    pub(super) fn finish(&mut self) -> Result<(CameraParameters, u32), Refusal> {
        let record = self.read();
        self.end();
        record
    }

    fn read(&self) -> Result<(CameraParameters, u32), Refusal> {
        let (_, crc) = self.announced.ok_or(Refusal::NoLoad)?;
        let computed = CRC.checksum(&self.bytes);
        if computed != crc {
            return Err(Refusal::LoadCrc { computed });
        }
        match postcard::take_from_bytes(&self.bytes) {
            Ok((record, [])) => Ok((record, crc)),
            _ => Err(Refusal::NoRecord),
        }
    }
}

/// A number of bytes; all are less than [`CALIBRATION_CAPACITY`].
#[expect(clippy::cast_possible_truncation, reason = "256 fits")]
const fn number(bytes: usize) -> u32 {
    bytes as u32
}
