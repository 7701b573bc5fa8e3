//! Packets on a bad wire.

use fmc_camera::flight::exposure::Exposure;
use fmc_camera::io::link::message::{Answer, Header, Refusal, Request, Unreadable};
use fmc_camera::io::link::packet::Damage;
use fmc_camera::io::link::station::{LinkEvent, NOBODY};
use fmc_camera::io::link::{LONGEST_PACKET, PROTOCOL_VERSION};

use crate::link::pc::{Pc, SESSION, packet};
use crate::link::targets::wire_format::{between_zeros, frame_of};

fn header(sequence: u16) -> Header {
    Header {
        session: SESSION,
        sequence,
    }
}

#[test]
fn damaged_frame_is_counted_and_dropped_and_the_next_one_taken() {
    let mut pc = Pc::connected();
    let request = packet(header(pc.next), &Request::Counters);
    let wire = request.bytes();

    let mut wrong = wire.to_vec();
    wrong[3] ^= 0x40;
    assert!(pc.send(&wrong).is_empty());
    assert_eq!(pc.event, Some(LinkEvent::Lost(Damage::Crc)));

    let cut = wire.len() / 2;
    assert!(pc.send(&wire[..cut]).is_empty());
    assert!(pc.send(&[0]).is_empty());
    assert_eq!(pc.event, Some(LinkEvent::Lost(Damage::Truncated)));
    // The first is shorter than its CRC; the second has a block of COBS that is longer than the
    // packet.
    for short in [&[3, 1, 1, 0], &between_zeros(&[9, 1, 2])[..]] {
        assert!(pc.send(short).is_empty());
        assert_eq!(pc.event, Some(LinkEvent::Lost(Damage::Truncated)));
    }
    assert!(pc.send(&[7; LONGEST_PACKET + 1]).is_empty());
    assert!(pc.send(&vec![9; 100_000]).is_empty());
    assert!(pc.send(&[0]).is_empty());
    assert_eq!(pc.event, Some(LinkEvent::Lost(Damage::Oversized)));

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
    let answers = pc.send(packet(header(0), &Request::Connect).bytes());
    assert_eq!(answers.len(), 1);
    assert_eq!(pc.station.counters().truncated, 0);
}

#[test]
fn host_that_died_in_the_middle_of_a_frame_does_not_spoil_the_next_session() {
    for cut in 1..20 {
        let mut pc = Pc::loaded();
        let half = packet(header(pc.next), &Request::Expose(Exposure::new(0.1, 0.005)));
        pc.send(&half.bytes()[..cut]);
        // The next host begins with a zero.
        let other = Header {
            session: 9,
            sequence: 0,
        };
        let mut wire = vec![0];
        wire.extend(packet(other, &Request::Connect).bytes());
        let answers = pc.send(&wire);
        assert!(
            matches!(answers[..], [(header, Answer::Connected(_))] if header == other),
            "{cut}: {answers:?}"
        );
    }
}

#[test]
fn other_protocol_is_answered_with_ones_own_version() {
    let mut pc = Pc::connected();
    let answers = pc.send(&frame_of(&[1, 1, 1, 0]));
    assert_eq!(answers, [(NOBODY, Answer::Refused(Refusal::OtherProtocol))]);
    assert_eq!(
        pc.event,
        Some(LinkEvent::Unreadable(Unreadable::OtherProtocol(1)))
    );
    assert_eq!(pc.station.counters().other_protocol, 1);
}

#[test]
fn whole_frame_without_a_request_is_counted() {
    let mut pc = Pc::connected();
    assert!(pc.send(&frame_of(&[PROTOCOL_VERSION])).is_empty());
    assert_eq!(pc.event, Some(LinkEvent::Unreadable(Unreadable::NoHeader)));
    let mut unknown = vec![PROTOCOL_VERSION];
    unknown.extend([0x91, 0xa0, 0xd4, 0xf2, 0x05]); // SESSION as LEB128
    unknown.extend([u8::try_from(pc.next).unwrap(), 77]);
    let answers = pc.send(&frame_of(&unknown));
    assert_eq!(
        answers,
        [(header(pc.next), Answer::Refused(Refusal::Unknown))]
    );
    assert_eq!(pc.station.counters().unknown, 2);
    // The refused request used a number of the session.
    pc.next += 1;
    assert!(matches!(pc.ask(&Request::Counters), Answer::Counters(_)));
}

#[test]
fn unknown_request_of_a_session_for_reading_is_counted_and_leaves_the_other_as_it_is() {
    let mut pc = Pc::connected();
    let reader = Header {
        session: 9,
        sequence: 3,
    };
    let connected = pc.ask_as(reader, &Request::ConnectReading);
    assert!(matches!(connected, Answer::Connected(_)), "{connected:?}");
    let answers = pc.send(&frame_of(&[PROTOCOL_VERSION, 9, 3, 77]));
    assert_eq!(answers, [(reader, Answer::Refused(Refusal::Unknown))]);
    assert_eq!(pc.event, Some(LinkEvent::Refused(Refusal::Unknown)));
    assert_eq!(pc.station.counters().unknown, 1);
    assert!(matches!(pc.ask(&Request::Counters), Answer::Counters(_)));
}
