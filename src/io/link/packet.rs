//! Packets: payloads on the wire, with length and CRC.

use cobs::{DecodeResult, DecoderState};
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use heapless::Vec;

use super::{CRC_BYTES, LENGTH_BYTES, LONGEST_CHECKED, LONGEST_PACKET, LONGEST_PAYLOAD};

/// CRC-32 (ISO-HDLC) of packets, calibrations and grids.
pub(super) const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// Byte that ends a packet.
pub(crate) const DELIMITER: u8 = 0;

/// A packet as it goes over the wire, with a zero at either end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packet {
    bytes: [u8; LONGEST_PACKET],
    length: usize,
}

impl Packet {
    /// A packet of no bytes.
    pub const EMPTY: Self = Self {
        bytes: [DELIMITER; LONGEST_PACKET],
        length: 0,
    };

    /// Replaces the packet by that of a payload which `write` puts into a buffer of
    /// [`LONGEST_PAYLOAD`] bytes and whose length it returns. Returns `None`, and leaves an empty
    /// packet, if `write` returns `None` or more bytes than fit.
    pub(super) fn fill(&mut self, write: impl FnOnce(&mut [u8]) -> Option<usize>) -> Option<()> {
        self.length = 0;
        let mut payload = [0; LONGEST_PAYLOAD];
        let length = write(&mut payload)?;
        let (first, rest) = self.bytes.split_first_mut()?;
        *first = DELIMITER;
        let encoded = cobs::try_encode(payload.get(..length)?, rest.get_mut(LENGTH_BYTES..)?);
        let encoded = encoded.ok()?;
        let (length, _) = rest.split_first_chunk_mut::<LENGTH_BYTES>()?;
        *length = wire_from_number(u32::try_from(encoded).ok()?);
        let checked = LENGTH_BYTES + encoded;
        let crc: [u8; CRC_BYTES] = wire_from_number(CRC.checksum(rest.get(..checked)?));
        let end = checked + CRC_BYTES;
        rest.get_mut(checked..end)?.copy_from_slice(&crc);
        *rest.get_mut(end)? = DELIMITER;
        self.length = 1 + end + 1;
        Some(())
    }

    /// The bytes to be sent.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// Encodes a number in bytes that are never zero: seven bits in each, the lowest first.
fn wire_from_number<const N: usize>(number: u32) -> [u8; N] {
    let mut rest = number;
    [(); N].map(|()| {
        let [low, ..] = rest.to_le_bytes();
        rest >>= 7;
        low | 0x80
    })
}

/// The reason why a packet was discarded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Damage {
    /// Its length is not the stated one, or it ends in the middle of a block of COBS.
    Truncated,
    /// It is longer than [`LONGEST_PACKET`].
    Oversized,
    /// Its CRC is wrong.
    Crc,
}

/// Cuts the bytes of a wire into packets.
#[derive(Debug, Default)]
pub struct PacketReceiver {
    /// The packet under way, as it came.
    received: Vec<u8, LONGEST_CHECKED>,
    oversized: bool,
    /// The last packet has ended: the next byte begins another.
    ended: bool,
}

impl PacketReceiver {
    /// Returns a receiver before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            received: Vec::new(),
            oversized: false,
            ended: false,
        }
    }

    /// Takes one byte. If it ends a packet, returns the payload, or the reason why it is lost.
    pub fn receive(&mut self, byte: u8) -> Option<Result<&[u8], Damage>> {
        if self.ended {
            self.received.clear();
            self.oversized = false;
            self.ended = false;
        }
        if byte != DELIMITER {
            self.oversized |= self.received.push(byte).is_err();
            return None;
        }
        self.ended = true;
        if self.received.is_empty() {
            None
        } else if self.oversized {
            Some(Err(Damage::Oversized))
        } else {
            Some(decoded(&mut self.received))
        }
    }
}

/// Decodes the payload of the bytes between two zeros, if their CRC is right.
fn decoded(received: &mut [u8]) -> Result<&[u8], Damage> {
    let (checked, crc) = received
        .split_last_chunk_mut::<CRC_BYTES>()
        .ok_or(Damage::Truncated)?;
    let right = wire_from_number(CRC.checksum(checked));
    let (length, encoded) = checked
        .split_first_chunk_mut::<LENGTH_BYTES>()
        .ok_or(Damage::Truncated)?;
    if u32::try_from(encoded.len()).map(wire_from_number) != Ok(*length) {
        return Err(Damage::Truncated);
    }
    if *crc != right {
        return Err(Damage::Crc);
    }
    // It is decoded in place: the decoded bytes are never more than those read.
    let mut decoder = DecoderState::default();
    let mut length = 0;
    for index in 0..encoded.len() {
        let byte = encoded.get(index).ok_or(Damage::Truncated)?;
        if let Ok(DecodeResult::DataContinue(byte)) = decoder.feed(*byte) {
            *encoded.get_mut(length).ok_or(Damage::Truncated)? = byte;
            length += 1;
        }
    }
    match decoder.feed(DELIMITER) {
        Ok(DecodeResult::DataComplete) => encoded.get(..length).ok_or(Damage::Truncated),
        _ => Err(Damage::Truncated),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn payload_that_does_not_fit_leaves_an_empty_frame() {
        let mut packet = Packet::EMPTY;
        let full = |buffer: &mut [u8]| {
            buffer.fill(7);
            Some(buffer.len())
        };
        assert_eq!(packet.fill(full), Some(()));
        assert_eq!(packet.bytes().len(), LONGEST_PACKET);
        for refused in [None, Some(LONGEST_PAYLOAD + 1)] {
            assert_eq!(packet.fill(|_| refused), None);
            assert!(packet.bytes().is_empty());
        }
    }
}
