//! What happens to frames on a bad wire.

use fmc_camera::flight::exposure::Exposure;
use fmc_camera::io::link::LONGEST_FRAME;
use fmc_camera::io::link::frame::{Damage, Frame, FrameReceiver};
use fmc_camera::io::link::message::{Answer, Header, Refusal, Request, Unreadable};
use fmc_camera::io::link::station::{Event, NOBODY};

use crate::pc::{Pc, SESSION, frame};

fn header(sequence: u16) -> Header {
    Header {
        session: SESSION,
        sequence,
    }
}

/// Whether any frame is accepted in these bytes, or in what is left over with a zero after it.
fn accepts(bytes: impl Iterator<Item = u8>) -> bool {
    let mut receiver = FrameReceiver::new();
    bytes
        .chain([0])
        .any(|byte| matches!(receiver.receive(byte), Some(Ok(_))))
}

/// Every way to flip 1, 2 or 3 bits of a frame: none is accepted.
#[test]
fn one_two_or_three_wrong_bits_are_never_accepted() {
    let request = frame(header(3), &Request::Expose(Exposure::new(0.1, 0.005)));
    let wire = request.bytes();
    assert!(accepts(wire.iter().copied()));
    let bits = 8 * wire.len();
    let with_flipped = |flipped: [usize; 3]| {
        wire.iter().enumerate().map(move |(index, byte)| {
            let mask = flipped
                .iter()
                .filter(|bit| *bit / 8 == index)
                .fold(0, |mask, bit| mask | 1 << (bit % 8));
            byte ^ mask
        })
    };
    let nothing = usize::MAX;
    let mut tried = 0_u32;
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
    let n = u32::try_from(bits).unwrap();
    assert_eq!(tried, n + n * (n - 1) / 2 + n * (n - 1) * (n - 2) / 6);
    assert!(n > 200, "a frame of some length");
}

#[test]
fn damaged_frame_is_counted_and_dropped_and_the_next_one_taken() {
    let mut pc = Pc::connected();
    let request = frame(header(pc.next), &Request::Counters);
    let wire = request.bytes();

    let mut wrong = wire.to_vec();
    wrong[3] ^= 0x40;
    assert!(pc.send(&wrong).is_empty());
    assert_eq!(pc.event, Some(Event::Lost(Damage::Crc)));

    let cut = wire.len() / 2;
    assert!(pc.send(&wire[..cut]).is_empty());
    assert!(pc.send(&[0]).is_empty());
    assert_eq!(pc.event, Some(Event::Lost(Damage::Truncated)));
    // Shorter than its CRC; and four zeros, which are the CRC of nothing.
    for short in [&[3, 1, 1, 0][..], &[1, 1, 1, 1, 1, 0]] {
        assert!(pc.send(short).is_empty());
        assert_eq!(pc.event, Some(Event::Lost(Damage::Truncated)));
    }

    assert!(pc.send(&[7; LONGEST_FRAME + 1]).is_empty());
    assert!(pc.send(&vec![9; 100_000]).is_empty());
    assert!(pc.send(&[0]).is_empty());
    assert_eq!(pc.event, Some(Event::Lost(Damage::Oversized)));

    let answers = pc.send(wire);
    let [(_, Answer::Counters(counters))] = answers[..] else {
        panic!("{answers:?}");
    };
    assert_eq!(counters.wrong_crc, 1);
    assert_eq!(counters.truncated, 3);
    assert_eq!(counters.oversized, 1);
    assert_eq!(counters.done, 1, "the connection alone");
}

#[test]
fn zeros_between_frames_mean_nothing() {
    let mut pc = Pc::unconnected();
    assert!(pc.send(&[0; 100]).is_empty());
    assert_eq!(pc.event, None);
    let answers = pc.send(frame(header(0), &Request::Connect).bytes());
    assert_eq!(answers.len(), 1);
    assert_eq!(pc.station.counters().truncated, 0);
}

#[test]
fn host_that_died_in_the_middle_of_a_frame_does_not_spoil_the_next_session() {
    for cut in 1..20 {
        let mut pc = Pc::loaded();
        let half = frame(header(pc.next), &Request::Expose(Exposure::new(0.1, 0.005)));
        pc.send(&half.bytes()[..cut]);
        // The next host begins with a zero.
        let other = Header {
            session: 9,
            sequence: 0,
        };
        let mut wire = vec![0];
        wire.extend(frame(other, &Request::Connect).bytes());
        let answers = pc.send(&wire);
        assert!(
            matches!(answers[..], [(header, Answer::Connected(_))] if header == other),
            "{cut}: {answers:?}"
        );
    }
}

/// A frame around any payload, with the right CRC.
fn framed(payload: &[u8]) -> Vec<u8> {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(payload);
    let mut checked = payload.to_vec();
    checked.extend(crc.to_le_bytes());
    let mut wire = vec![0; cobs::max_encoding_length(checked.len())];
    let length = cobs::encode(&checked, &mut wire);
    wire.truncate(length);
    wire.push(0);
    wire
}

#[test]
fn other_protocol_is_answered_with_ones_own_version() {
    let mut pc = Pc::connected();
    let answers = pc.send(&framed(&[2, 1, 1, 0]));
    assert_eq!(answers, [(NOBODY, Answer::Refused(Refusal::OtherProtocol))]);
    assert_eq!(
        pc.event,
        Some(Event::Unreadable(Unreadable::OtherProtocol(2)))
    );
    assert_eq!(pc.station.counters().other_protocol, 1);
}

#[test]
fn whole_frame_without_a_request_is_counted() {
    let mut pc = Pc::connected();
    assert!(pc.send(&framed(&[1])).is_empty());
    assert_eq!(pc.event, Some(Event::Unreadable(Unreadable::NoHeader)));
    let mut unknown = vec![1];
    unknown.extend([0x91, 0xa0, 0xd4, 0xf2, 0x05]); // SESSION as LEB128
    unknown.extend([u8::try_from(pc.next).unwrap(), 77]);
    let answers = pc.send(&framed(&unknown));
    assert_eq!(
        answers,
        [(header(pc.next), Answer::Refused(Refusal::Unknown))]
    );
    assert_eq!(pc.station.counters().unknown, 2);
    // It took its place in the session.
    pc.next += 1;
    assert!(matches!(pc.ask(&Request::Counters), Answer::Counters(_)));
}

#[test]
fn payload_that_does_not_fit_makes_an_empty_frame() {
    let long = "x".repeat(41);
    let identity = fmc_camera::io::link::message::Identity::new(
        &long,
        &long,
        true,
        fmc_camera::io::link::message::Start::PowerOn,
    );
    assert_eq!((identity.build.as_str(), identity.board.as_str()), ("", ""));
    assert!(Frame::EMPTY.bytes().is_empty());
}
