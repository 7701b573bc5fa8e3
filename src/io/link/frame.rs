//! Frames: payloads on the wire, shown to be whole.

use cobs::{DecodeResult, DecoderState};
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use heapless::Vec;

use super::{LONGEST_CHECKED, LONGEST_FRAME, LONGEST_PAYLOAD};

/// CRC-32 (ISO-HDLC): of frames, calibrations and grids.
pub(super) const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// What ends a frame.
pub const DELIMITER: u8 = 0;

/// A frame as it goes over the wire, with its final zero.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    bytes: [u8; LONGEST_FRAME],
    length: usize,
}

impl Frame {
    /// A frame of no bytes.
    pub const EMPTY: Self = Self {
        bytes: [DELIMITER; LONGEST_FRAME],
        length: 0,
    };

    /// Replaces the frame by that of a payload which `write` puts into a buffer of
    /// [`LONGEST_PAYLOAD`] bytes, saying how many there are. `None`, and an empty frame, where it
    /// says none or more than fit.
    pub(super) fn fill(&mut self, write: impl FnOnce(&mut [u8]) -> Option<usize>) -> Option<()> {
        self.length = 0;
        let mut checked = [0; LONGEST_CHECKED];
        let payload = write(checked.get_mut(..LONGEST_PAYLOAD)?)?;
        let crc = CRC.checksum(checked.get(..payload)?);
        checked
            .get_mut(payload..payload + 4)?
            .copy_from_slice(&crc.to_le_bytes());
        let encoded = cobs::try_encode(checked.get(..payload + 4)?, &mut self.bytes).ok()?;
        *self.bytes.get_mut(encoded)? = DELIMITER;
        self.length = encoded + 1;
        Some(())
    }

    /// The bytes to be sent.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// Why a frame was discarded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Damage {
    /// It ended too early: no payload, or not even a CRC.
    Truncated,
    /// It is longer than [`LONGEST_FRAME`].
    Oversized,
    /// Its CRC is wrong.
    Crc,
}

/// Cuts the bytes of a wire into frames.
#[derive(Debug, Default)]
pub struct FrameReceiver {
    decoder: DecoderState,
    checked: Vec<u8, LONGEST_CHECKED>,
    oversized: bool,
}

impl FrameReceiver {
    /// A receiver before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            decoder: DecoderState::Idle,
            checked: Vec::new(),
            oversized: false,
        }
    }

    /// Takes one byte; the payload, or the reason why it is lost, where the byte ends a frame.
    pub fn receive(&mut self, byte: u8) -> Option<Result<&[u8], Damage>> {
        if self.oversized {
            if byte != DELIMITER {
                return None;
            }
            self.oversized = false;
            self.decoder = DecoderState::default();
            return Some(Err(Damage::Oversized));
        }
        match self.decoder.feed(byte) {
            Ok(DecodeResult::NoData) => None,
            Ok(DecodeResult::DataStart) => {
                self.checked.clear();
                None
            }
            Ok(DecodeResult::DataContinue(byte)) => {
                self.oversized = self.checked.push(byte).is_err();
                None
            }
            Ok(DecodeResult::DataComplete) => Some(self.payload()),
            Err(_) => Some(Err(Damage::Truncated)),
        }
    }

    /// What precedes the CRC, where that is right.
    fn payload(&self) -> Result<&[u8], Damage> {
        let (payload, crc) = self.checked.split_last_chunk().ok_or(Damage::Truncated)?;
        if payload.is_empty() {
            // The CRC of nothing is zero: three wrong bits can cut four zeros out of a frame.
            Err(Damage::Truncated)
        } else if CRC.checksum(payload) == u32::from_le_bytes(*crc) {
            Ok(payload)
        } else {
            Err(Damage::Crc)
        }
    }
}
