//! All short packets and streams of pieces, against the slow and simple reader.

use fmc_camera::io::link::LONGEST_PACKET;
use fmc_camera::io::link::packet::PacketReceiver;

use crate::link::targets::wire_format::{between_zeros, frame_of, payload_of};

/// Longest encoded payload of which all are tried.
const LONGEST_ENCODED: usize = 6;

/// Bytes of those: codes of short blocks and of the longest, which are data as well.
const BYTES: [u8; 6] = [1, 2, 3, 4, 8, 255];

/// Number of pieces in a stream.
const PIECES: usize = 5;

/// Returns the payloads that a receiver accepts of some bytes.
fn accepted(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut receiver = PacketReceiver::new();
    let mut payloads = Vec::new();
    for byte in bytes {
        if let Some(Ok(payload)) = receiver.receive(*byte) {
            payloads.push(payload.to_vec());
        }
    }
    payloads
}

/// Tries all that begin with these bytes; counts those that are no packets, and those that are.
fn try_encoded(encoded: &mut Vec<u8>, counts: &mut [u32; 2]) {
    if !encoded.is_empty() {
        let sent = between_zeros(encoded);
        let expected = payload_of(&sent[1..sent.len() - 1]);
        counts[usize::from(expected.is_some())] += 1;
        assert_eq!(accepted(&sent), Vec::from_iter(expected), "{encoded:?}");
    }
    if encoded.len() < LONGEST_ENCODED {
        for byte in BYTES {
            encoded.push(byte);
            try_encoded(encoded, counts);
            encoded.pop();
        }
    }
}

#[test]
fn every_short_encoding_is_read_as_by_the_simple_reader() {
    let mut counts = [0; 2];
    try_encoded(&mut Vec::new(), &mut counts);
    // docs/models.md has these numbers.
    assert_eq!(counts, [48_042, 7_944]);
}

/// Returns the pieces of streams.
fn pieces() -> [Vec<u8>; 8] {
    let [one, other] = [&[5, 0, 7][..], &[0, 0]].map(frame_of);
    let mut wrong = one.clone();
    wrong[4] ^= 1;
    [
        vec![0],
        vec![1],
        // Cut short at either end, and in the middle.
        one[..one.len() - 1].to_vec(),
        one[1..].to_vec(),
        one[..6].to_vec(),
        one,
        other,
        [&wrong[..], &[9; LONGEST_PACKET]].concat(),
    ]
}

#[test]
fn every_short_stream_of_whole_and_broken_packets_is_read_as_by_the_simple_reader() {
    let pieces = pieces();
    let (mut streams, mut packets) = (0_u32, 0);
    for number in 0..pieces.len().pow(u32::try_from(PIECES).unwrap()) {
        let digits = (0..PIECES).map(|digit| number >> (3 * digit) & 7);
        let stream: Vec<u8> = digits.flat_map(|piece| pieces[piece].clone()).collect();
        let ended = stream.iter().rposition(|byte| *byte == 0).unwrap_or(0);
        let expected: Vec<_> = stream[..ended]
            .split(|byte| *byte == 0)
            .filter_map(payload_of)
            .collect();
        packets += expected.len();
        streams += 1;
        assert_eq!(accepted(&stream), expected, "{number:o}");
    }
    // docs/models.md has the number of streams.
    assert_eq!((streams, packets > 10_000), (32_768, true));
}
