//! Packets: payloads on the wire, with length and CRC.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use heapless::Vec;
use postcard::ser_flavors::Flavor;
use postcard::serialize_with_flavor;
use serde::Serialize;

use super::{CRC_BYTES, LENGTH_BYTES, LONGEST_CHECKED, LONGEST_PACKET, LONGEST_PAYLOAD};

/// CRC-32 (ISO-HDLC) of packets, calibrations and grids.
pub(crate) const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

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

    /// Replaces the packet by that of a payload as `postcard` writes it. Returns `None`, and leaves
    /// an empty packet, if it were longer than [`LONGEST_PAYLOAD`].
    pub(super) fn fill(&mut self, payload: &impl Serialize) -> Option<()> {
        self.length = 0;
        // Its bytes are not zeroed first.
        let mut written = Vec::new();
        serialize_with_flavor(payload, Written(&mut written)).ok()?;
        let (first, rest) = self.bytes.split_first_mut()?;
        *first = DELIMITER;
        let encoded = cobs::try_encode(&written, rest.get_mut(LENGTH_BYTES..)?);
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

/// Returns the CRC-32 of what a payload would hold; `None` if it were longer than one.
pub(super) fn checksum(payload: &impl Serialize) -> Option<u32> {
    let mut written = Vec::new();
    serialize_with_flavor(payload, Written(&mut written)).ok()?;
    Some(CRC.checksum(&written))
}

/// Bytes of a payload, as many as have been written.
struct Written<'a>(&'a mut Vec<u8, LONGEST_PAYLOAD>);

impl Flavor for Written<'_> {
    type Output = ();

    #[inline]
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        let pushed = self.0.push(byte);
        pushed.map_err(|_| postcard::Error::SerializeBufferFull)
    }

    #[inline]
    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        let extended = self.0.extend_from_slice(bytes);
        extended.map_err(|_| postcard::Error::SerializeBufferFull)
    }

    fn finalize(self) -> postcard::Result<()> {
        Ok(())
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
    let length = decode(encoded).ok_or(Damage::Truncated)?;
    let payload = encoded.get(1..).and_then(|behind| behind.get(..length));
    payload.ok_or(Damage::Truncated)
}

/// Decodes COBS in place, and returns the number of decoded bytes, which begin behind the first
/// byte; `None` if the last block is cut short.
///
/// Each block begins with a code, its length. Where a block ends with a zero, the code of the next
/// lies just where that zero belongs: the data stay where they are. Only a block of 254 bytes
/// ends without a zero, and those behind move up by one.
fn decode(bytes: &mut [u8]) -> Option<usize> {
    let (mut read, mut decoded) = (0, 0);
    let mut code = *bytes.first()?;
    loop {
        let length = usize::from(code.checked_sub(1)?);
        if decoded < read {
            for index in 0..length {
                let byte = *bytes.get(read + 1 + index)?;
                *bytes.get_mut(1 + decoded + index)? = byte;
            }
        }
        read += 1 + length;
        decoded += length;
        if read >= bytes.len() {
            return (read == bytes.len()).then_some(decoded);
        }
        let next = *bytes.get(read)?;
        if code != u8::MAX {
            *bytes.get_mut(1 + decoded)? = DELIMITER;
            decoded += 1;
        }
        code = next;
    }
}

#[cfg(test)]
mod tests {
    use cobs::{DecodeResult, DecoderState};
    use proptest::prelude::*;

    use super::*;

    /// Decodes with the state machine of `cobs`.
    fn by_state(bytes: &[u8]) -> Option<std::vec::Vec<u8>> {
        let mut decoder = DecoderState::default();
        let mut decoded = std::vec::Vec::new();
        for byte in bytes {
            if let Ok(DecodeResult::DataContinue(byte)) = decoder.feed(*byte) {
                decoded.push(byte);
            }
        }
        matches!(decoder.feed(DELIMITER), Ok(DecodeResult::DataComplete)).then_some(decoded)
    }

    fn in_place(bytes: &[u8]) -> Option<std::vec::Vec<u8>> {
        let mut bytes = bytes.to_vec();
        let length = decode(&mut bytes)?;
        Some(bytes[1..=length].to_vec())
    }

    /// Data of which some have long blocks without a zero.
    fn data() -> impl Strategy<Value = std::vec::Vec<u8>> {
        prop_oneof![
            prop::collection::vec(any::<u8>(), 1..600),
            prop::collection::vec(1_u8..3, 1..1040),
            prop::collection::vec(prop_oneof![1 => Just(0_u8), 200 => Just(9)], 1..1040),
        ]
    }

    proptest! {
        #[test]
        fn decoded_data_are_those_that_were_encoded(data in data()) {
            let mut encoded = [0; 1100];
            let length = cobs::try_encode(&data, &mut encoded).unwrap();
            let encoded = &encoded[..length];
            prop_assert_eq!(in_place(encoded), Some(data));
            // Cut short, it is what the state machine makes of it.
            for length in 1..length {
                prop_assert_eq!(in_place(&encoded[..length]), by_state(&encoded[..length]));
            }
        }

        #[test]
        fn any_bytes_are_decoded_as_by_the_state_machine(
            bytes in prop::collection::vec(prop_oneof![1_u8..9, 1_u8..=255], 1..300),
        ) {
            prop_assert_eq!(in_place(&bytes), by_state(&bytes));
        }
    }

    #[test]
    fn payload_that_does_not_fit_leaves_an_empty_frame() {
        let mut packet = Packet::EMPTY;
        // A sequence is written with its length in two bytes before.
        let fits = [7_u8; LONGEST_PAYLOAD - 2];
        assert_eq!(packet.fill(&fits.as_slice()), Some(()));
        assert_eq!(packet.bytes().len(), LONGEST_PACKET);
        let too_long = [7_u8; LONGEST_PAYLOAD - 1];
        assert_eq!(packet.fill(&too_long.as_slice()), None);
        assert!(packet.bytes().is_empty());
    }
}
