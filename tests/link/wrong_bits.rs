//! Wrong bits on the wire: every error of one, two or three of them, in short packets and in the
//! longest.

use std::collections::HashMap;
use std::ops::Range;

use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::message::{Answer, Header, Request};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};

use crate::link::pc::{SESSION, packet};
use crate::link::targets::wire_format::{frame_of, wire_from_crc, wire_from_length};

/// Largest number of wrong bits.
const WRONG: usize = 3;

fn header(sequence: u16) -> Header {
    Header {
        session: SESSION,
        sequence,
    }
}

/// Returns true if any packet is accepted in these bytes, or in the rest of them with a zero after
/// it.
fn accepts(bytes: impl Iterator<Item = u8>) -> bool {
    let mut receiver = PacketReceiver::new();
    bytes
        .chain([0])
        .any(|byte| matches!(receiver.receive(byte), Some(Ok(_))))
}

#[test]
fn all_errors_of_a_short_frame_are_found_by_trying() {
    let request = packet(header(3), &Request::InteriorOrientation);
    let wire = request.bytes();
    assert!(accepts(wire.iter().copied()));
    let bits = 8 * wire.len();
    let with_flipped = |flipped: [usize; WRONG]| {
        wire.iter().enumerate().map(move |(index, byte)| {
            let mask = flipped
                .iter()
                .filter(|bit| *bit / 8 == index)
                .fold(0, |mask, bit| mask | 1 << (bit % 8));
            byte ^ mask
        })
    };
    let nothing = usize::MAX;
    let mut tried = 0;
    for first in 0..bits {
        for second in (first + 1..bits).chain([nothing]) {
            let thirds = if second == nothing { bits } else { second + 1 };
            for third in (thirds..bits).chain([nothing]) {
                let flipped = [first, second, third];
                assert!(!accepts(with_flipped(flipped)), "{flipped:?}");
                tried += 1;
            }
        }
    }
    let (n, all) = (bits, |n| n + n * (n - 1) / 2 + n * (n - 1) * (n - 2) / 6);
    assert_eq!(tried, all(n));
    assert!(n > 120, "a packet of some length");
}

#[test]
fn all_errors_of_long_frames_are_found_by_the_linearity_of_the_crc() {
    let errors = Errors::up_to(1100);
    let point = |index: u8| SensorPoint::new(0.8 * f32::from(index) - 23.5, 0.0);
    let corrected = |index: u8| Corrected {
        point: point(index),
        ..Corrected::default()
    };
    let mut answer = Packet::EMPTY;
    Answer::Points((0..64).map(corrected).collect())
        .write(header(4), &mut answer)
        .unwrap();
    let expose = Request::Expose(Exposure::new(0.1, 0.005));
    for long in [
        packet(header(12), &Request::Correct((0..64).map(point).collect())),
        packet(
            header(13),
            &Request::Distort((64..128).map(point).collect()),
        ),
        packet(header(14), &expose),
        answer,
    ] {
        let wire = long.bytes();
        assert!(accepts(wire.iter().copied()));
        let between = &wire[1..wire.len() - 1];
        assert_eq!(errors.first_undetected(between, between.len(), WRONG), None);
        // A wrong bit in the final zero joins the first byte of the next packet to this one.
        for last in 0..8 {
            let mut longer = between.to_vec();
            longer.push(1 << last);
            let found = errors.first_undetected(&longer, between.len(), WRONG - 1);
            assert_eq!(found, None);
        }
    }
}

/// Checks the search on packets that it must find: one behind a byte of one bit, also with two
/// wrong bits in it.
#[test]
fn search_finds_a_frame_inside_a_frame() {
    let errors = Errors::up_to(200);
    let inner = frame_of(&[1, 2, 3, 4, 5, 6]);
    let inner = &inner[1..inner.len() - 1];
    let mut outer = vec![7; 20];
    outer.push(0b0001_0000);
    let start = outer.len();
    outer.extend(inner);
    assert_eq!(
        errors.first_undetected(&outer, 0, WRONG),
        Some(start..outer.len())
    );
    for (byte, bit) in [(1, 3), (inner.len() - 1, 2)] {
        outer[start + byte] ^= 1 << bit;
    }
    assert_eq!(
        errors.first_undetected(&outer, 0, WRONG),
        Some(start..outer.len())
    );
    outer[start + 2] ^= 1;
    assert_eq!(errors.first_undetected(&outer, 0, WRONG), None);
    // The receiver confirms it: the byte of one bit becomes a zero.
    outer[start + 2] ^= 1;
    for (byte, bit) in [(1, 3), (inner.len() - 1, 2)] {
        outer[start + byte] ^= 1 << bit;
    }
    outer[20] = 0;
    assert!(accepts(outer.into_iter()));
}

/// Effect of each single wrong bit on the CRC.
///
/// The CRC is linear: the effect of several wrong bits is the exclusive or of their effects.
struct Errors {
    /// Changes by the byte's distance from the end of the encoded bytes, and by the bit.
    changes: Vec<[u32; 8]>,
    /// Distance of the change that has this value.
    distance: HashMap<u32, usize>,
    /// Low 20 bits of the changes, for a quick test whether a value can be one.
    low_bits: Vec<bool>,
}

const LOW: u32 = 0xf_ffff;

impl Errors {
    /// Computes the effects for packets up to this length.
    fn up_to(length: usize) -> Self {
        let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
        let mut errors = Self {
            changes: Vec::new(),
            distance: HashMap::new(),
            low_bits: vec![false; LOW as usize + 1],
        };
        for from_end in 0..length {
            let mut bytes = vec![0; from_end + 1];
            let without = crc.checksum(&bytes);
            let changes = [0, 1, 2, 3, 4, 5, 6, 7].map(|bit| {
                bytes[0] = 1 << bit;
                crc.checksum(&bytes) ^ without
            });
            for change in changes {
                // Two wrong bits, one of them perhaps in the CRC itself, are always found.
                assert!(!change.is_power_of_two());
                assert_eq!(errors.distance.insert(change, from_end), None);
                errors.low_bits[(change & LOW) as usize] = true;
            }
            errors.changes.push(changes);
        }
        errors
    }

    /// Returns the first piece of the bytes between two zeros that an error of up to `wrong` bits
    /// turns into a packet.
    ///
    /// A piece begins at the start, or after a byte that the error turns into a zero, and ends
    /// likewise; the bits that this takes are not available within the piece. The first `sent`
    /// bytes without a wrong bit are the packet that was sent.
    fn first_undetected(&self, between: &[u8], sent: usize, wrong: usize) -> Option<Range<usize>> {
        let ones = |index: usize| between[index].count_ones() as usize;
        let length = between.len();
        for start in 0..length {
            let before = if start == 0 { 0 } else { ones(start - 1) };
            for end in start + 1..=length {
                let after = if end == length { 0 } else { ones(end) };
                let left = wrong.checked_sub(before + after);
                let piece = &between[start..end];
                let sent = start == 0 && end == sent;
                if left.is_some_and(|left| self.passes(piece, left, sent)) {
                    return Some(start..end);
                }
            }
        }
        None
    }

    /// Returns true if up to `wrong` wrong bits make the piece's CRC right; in a piece that was
    /// `sent` at least one must be wrong.
    fn passes(&self, piece: &[u8], wrong: usize, sent: bool) -> bool {
        let Some((checked, crc)) = piece.split_last_chunk::<5>() else {
            return false;
        };
        let Some((length, encoded)) = checked.split_first_chunk::<2>() else {
            return false;
        };
        // The length must be right, so that its wrong bits are counted.
        let right = wire_from_length(encoded.len());
        let pairs = length.iter().zip(right);
        let amiss: u32 = pairs.map(|(is, right)| (is ^ right).count_ones()).sum();
        let checked = &[&right, encoded].concat()[..];
        // Bit 7 of each byte is set; the last byte has no bits beyond the 32.
        let amiss = amiss as usize
            + crc.iter().filter(|byte| **byte < 128).count()
            + (crc[4] & 0b0111_0000).count_ones() as usize;
        let Some(wrong) = wrong.checked_sub(amiss) else {
            return false;
        };
        let value = |bytes: [u8; 5]| {
            let with = |value, byte: &u8| value << 7 | u64::from(byte & 127);
            bytes.iter().rev().fold(0, with) & u64::from(u32::MAX)
        };
        let difference = u32::try_from(value(wire_from_crc(checked)) ^ value(*crc)).unwrap();
        let is_one = |change: u32| {
            change.is_power_of_two()
                || self.low_bits[(change & LOW) as usize]
                    && self
                        .distance
                        .get(&change)
                        .is_some_and(|distance| *distance < checked.len())
        };
        let changes: Vec<u32> = self.changes[..checked.len()]
            .iter()
            .flatten()
            .copied()
            .chain((0..32).map(|bit| 1 << bit))
            .collect();
        let none = difference == 0 && (amiss > 0 || !sent);
        let one = wrong >= 1 && is_one(difference);
        // All changes differ, so that no two of them cancel.
        let two = wrong >= 2 && difference != 0 && changes.iter().any(|a| is_one(difference ^ a));
        let three = wrong >= 3
            && changes.iter().enumerate().any(|(index, a)| {
                let rest = &changes[index + 1..];
                rest.iter().any(|b| is_one(difference ^ a ^ b))
            });
        none || one || two || three
    }
}
