//! Ends of a camera, acknowledgement of its records, and sessions for reading.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::record_log::CAPACITY;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::link::message::{Answer, Ending, FetchedRecord, Header, Refusal, Request};
use fmc_camera::io::link::station::LinkEvent;

use crate::link::in_flight::Flight;
use crate::link::pc::SESSION;

#[test]
fn nothing_ends_a_camera_that_is_armed_or_holds_records_unless_it_is_forced() {
    let mut flight = Flight::loaded();
    assert_eq!(flight.prepare(), Answer::Prepared);
    let endings = |ending| [Request::Reset(ending), Request::PowerOff(ending)];
    flight.arm();
    flight.round(Some(Event::Trigger));
    for state in [State::Exposing, State::Armed] {
        flight.run_until(state);
        for request in endings(Ending::Orderly) {
            let refused = Answer::Refused(Refusal::FrameInFlight);
            assert_eq!(flight.pc.ask(&request), refused, "{state:?}");
        }
    }
    flight.round(Some(Event::Command(Command::Disarm)));
    for request in endings(Ending::Orderly) {
        let refused = Answer::Refused(Refusal::RecordsKept(1));
        assert_eq!(flight.pc.ask(&request), refused);
    }
    for request in endings(Ending::Forced) {
        assert_eq!(flight.pc.ask(&request), Answer::Ending);
    }
    assert_eq!(flight.pc.acknowledge(1), Answer::Kept(0));
    for request in endings(Ending::Orderly) {
        assert_eq!(flight.pc.ask(&request), Answer::Ending);
    }
}

#[test]
fn record_that_was_not_fetched_as_it_is_kept_is_not_forgotten() {
    let mut flight = Flight::loaded();
    assert_eq!(flight.prepare(), Answer::Prepared);
    for _ in 0..3 {
        flight.round(Some(Event::Trigger));
    }
    let crc_of =
        |flight: &mut Flight, sequence| match flight.pc.ask(&Request::FrameRecord(sequence)) {
            Answer::FrameRecord(Some((record, crc))) if record.sequence == sequence => crc,
            other => panic!("{other:?}"),
        };
    let crcs = [1, 2, 3].map(|sequence| crc_of(&mut flight, sequence));
    let acknowledge = |flight: &mut Flight, sequence, crc| {
        let fetched = FetchedRecord { sequence, crc };
        flight.pc.ask(&Request::Acknowledge(fetched))
    };
    for (sequence, crc) in [
        (3, crcs[1]),
        (3, crcs[2] ^ 1),
        (4, crcs[2]),
        (u32::MAX, crcs[2]),
        (u32::MAX, 0),
    ] {
        let refused = Answer::Refused(Refusal::NotFetched { sequence });
        assert_eq!(acknowledge(&mut flight, sequence, crc), refused);
    }
    assert_eq!(acknowledge(&mut flight, 0, 0), Answer::Kept(3), "none");
    assert_eq!(acknowledge(&mut flight, 2, crcs[1]), Answer::Kept(1));
    // Records that are forgotten may be acknowledged again, as after an answer that was lost.
    assert_eq!(acknowledge(&mut flight, 2, crcs[1]), Answer::Kept(1));
    assert_eq!(acknowledge(&mut flight, 3, crcs[2]), Answer::Kept(0));
    assert_eq!(acknowledge(&mut flight, 3, 0), Answer::Kept(0));
}

#[test]
fn triggers_without_room_are_acknowledged_by_number_once_the_records_before_them_are() {
    let mut flight = Flight::loaded();
    assert_eq!(flight.prepare(), Answer::Prepared);
    let whole = u32::try_from(CAPACITY).unwrap();
    for _ in 0..whole + 2 {
        flight.round(Some(Event::Trigger));
    }
    let by_number = |flight: &mut Flight, sequence| {
        let fetched = FetchedRecord { sequence, crc: 0 };
        flight.pc.ask(&Request::Acknowledge(fetched))
    };
    let sequence = whole + 2;
    let refused = Answer::Refused(Refusal::NotFetched { sequence });
    assert_eq!(by_number(&mut flight, sequence), refused);
    // Between fetching and acknowledging the last of them another trigger comes.
    assert_eq!(flight.pc.acknowledge(whole), Answer::Kept(2));
    flight.round(Some(Event::Trigger));
    let Answer::Kept(left) = by_number(&mut flight, sequence) else {
        panic!("refused");
    };
    assert!((1..=3).contains(&left), "{left}");
    assert_eq!(by_number(&mut flight, sequence + 1), Answer::Kept(0));
}

#[test]
fn session_for_reading_ends_neither_the_other_session_nor_its_flight() {
    let mut flight = Flight::loaded();
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Armed);
    let flying = Header {
        session: SESSION,
        sequence: flight.pc.next.wrapping_sub(1),
    };
    let last = flight.pc.ask_as(flying, &Request::Status);
    let mut reader = Header {
        session: SESSION ^ 1,
        sequence: 7,
    };
    let refused = Answer::Refused(Refusal::OtherSession);
    assert_eq!(flight.pc.ask_as(reader, &Request::Status), refused);
    let connected = flight.pc.ask_as(reader, &Request::ConnectReading);
    assert!(matches!(connected, Answer::Connected(_)), "{connected:?}");
    // Any number, again and again.
    for sequence in [8, 8, 3] {
        reader.sequence = sequence;
        let answer = flight.pc.ask_as(reader, &Request::Status);
        assert!(matches!(answer, Answer::Status(_)), "{answer:?}");
    }
    for request in [
        Request::Reset(Ending::Forced),
        Request::Tell(Event::Command(Command::Disarm)),
        Request::Prepare(FlightSettings::default()),
        Request::Connect,
    ] {
        let answer = flight.pc.ask_as(reader, &request);
        let refused = Answer::Refused(Refusal::ReadingOnly);
        assert_eq!(answer, refused, "{request:?}");
    }
    let record = flight.pc.ask_as(reader, &Request::FrameRecord(0));
    let Answer::FrameRecord(Some((FrameRecord { sequence: 1, .. }, crc))) = record else {
        panic!("{record:?}");
    };
    // The answer of the flying session is still there, and its next request is taken.
    assert_eq!(flight.pc.ask_as(flying, &Request::Status), last);
    assert_eq!(flight.pc.event, Some(LinkEvent::Repeated));
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Armed);
    let fetched = FetchedRecord { sequence: 1, crc };
    let acknowledged = Request::Acknowledge(fetched);
    assert_eq!(flight.pc.ask_as(reader, &acknowledged), Answer::Kept(1));
    assert_eq!(flight.pc.ask_as(reader, &acknowledged), Answer::Kept(1));
    // Another reader takes the place of the first.
    let next = Header {
        session: 9,
        sequence: 0,
    };
    flight.pc.ask_as(next, &Request::ConnectReading);
    assert_eq!(flight.pc.ask_as(reader, &Request::Status), refused);
    // The flying session's own number is not one for reading.
    let own = flight.pc.ask(&Request::ConnectReading);
    assert_eq!(own, Answer::Refused(Refusal::Unknown));
}
