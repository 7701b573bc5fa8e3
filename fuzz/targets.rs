//! Fuzz targets of the link, and their properties. The tests of the crate run the same functions.

#[path = "wire_format.rs"]
pub(crate) mod wire_format;

use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::control_loop::MAX_ROUND_ACTIONS;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::time::Time;
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::deck::{FlightDeck, RigDeck};
use fmc_camera::io::link::loading::Upload;
use fmc_camera::io::link::message::{Answer, FetchedRecord, Header, Identity, Request, ResetCause};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};
use fmc_camera::io::link::station::Station;

use fmc_camera::io::link::{LONGEST_PACKET, PROTOCOL_VERSION};
use wire_format::{frame_of, payload_of};

/// Feeds any bytes to the wire: a payload is accepted exactly where a slow and simple reading of
/// the same bytes accepts one, and a whole packet after them is received.
pub(crate) fn wire(bytes: &[u8]) {
    let mut receiver = PacketReceiver::new();
    let mut accepted = Vec::new();
    for byte in bytes {
        if let Some(Ok(payload)) = receiver.receive(*byte) {
            accepted.push(payload.to_vec());
            // Reading may fail, and must not panic.
            let _ = Answer::read(payload);
            let _ = Request::read(payload);
        }
    }
    // The bytes behind the last zero do not form a complete packet.
    let ended = bytes.iter().rposition(|byte| *byte == 0).unwrap_or(0);
    let expected: Vec<_> = bytes[..ended]
        .split(|byte| *byte == 0)
        .filter_map(payload_of)
        .collect();
    assert_eq!(accepted, expected);

    let mut packet = Packet::EMPTY;
    let header = Header {
        session: 1,
        sequence: 2,
    };
    Request::InteriorOrientation
        .write(header, &mut packet)
        .unwrap();
    let last = std::iter::once(&0)
        .chain(packet.bytes())
        .filter_map(|byte| receiver.receive(*byte)?.ok().map(<[u8]>::to_vec))
        .last();
    let read = Request::read(&last.unwrap()).unwrap();
    assert_eq!(
        read,
        (header, Some(Request::InteriorOrientation)),
        "resynchronised"
    );
}

/// Sends any requests to a camera: it answers each with one whole answer or none, counts those that
/// it does not obey, and does its work for the next host.
///
/// The input is cut into pieces by its own length bytes. A piece is sent as it is, or with header
/// and CRC around it, so that every request is reached.
pub(crate) fn station(bytes: &[u8]) {
    station_of(RigDeck::after(ResetCause::PowerOn), bytes, |_| ());
    let drive = RigDrive::new(DriveSettings::default()).unwrap();
    let mut now = Time::START;
    // On a board a millisecond and a round of the control loop follow every request.
    station_of(
        FlownDeck::new(drive, ResetCause::PowerOn.unreferenced()),
        bytes,
        |deck| {
            now = Time::from_us(now.us() + 1000);
            let actions = deck.round(now);
            assert!(actions.len() < MAX_ROUND_ACTIONS);
        },
    );
}

/// Does the same with any camera; `then` is called after every request.
fn station_of<Deck: FlightDeck>(deck: Deck, bytes: &[u8], mut then: impl FnMut(&mut Deck)) {
    let identity = Identity::new("", "", true, ResetCause::PowerOn);
    let mut station = Station::with(identity, || 0, deck);
    send(&mut station, &framed(&Request::Connect, 0));
    let mut sequence = 1;
    let mut rest = bytes;
    while let Some((kind, tail)) = rest.split_first() {
        let (piece, tail) = tail.split_at(tail.len().min(usize::from(kind / 4)));
        rest = tail;
        let before = station.counters();
        match kind % 4 {
            // The piece is sent as it is; none of it is obeyed unless its CRC happens to be right.
            0 => {
                send(&mut station, piece);
                let after = station.counters();
                let whole = piece
                    .split(|byte| *byte == 0)
                    .any(|packet| payload_of(packet).is_some());
                assert!(whole || after.done + after.refused == before.done + before.refused);
            }
            // The piece is the body of the next request.
            1 | 2 => {
                let mut payload = vec![PROTOCOL_VERSION, 5];
                payload.extend(leb128(sequence));
                payload.extend(piece);
                send(&mut station, &frame_of(&payload));
                sequence = sequence.wrapping_add(1);
            }
            // The piece is a payload.
            _ => {
                send(&mut station, &frame_of(piece));
            }
        }
        then(station.deck_mut());
    }
    works_for_the_next_host(&mut station);
}

/// Checks a new session, a calibration, an exposure and a point against the bits of the library.
fn works_for_the_next_host<Deck: FlightDeck>(station: &mut Station<Deck>) {
    let parameters = CameraParameters::new(CalibrationParameters::new(100.0, [8000, 4000], 10.0));
    let exposure = Exposure::new(0.1, 0.005);
    let point = SensorPoint::new(12.0, -3.0);
    let expected: Corrected = Camera::new(parameters)
        .unwrap()
        .frame(&exposure)
        .unwrap()
        .correction
        .correct(point);
    send(station, &[0]);
    let mut answers = Vec::new();
    let mut requests = vec![Request::Connect];
    // Unacknowledged records of a flight keep a camera from being loaded.
    requests.extend([Request::Acknowledge(FetchedRecord {
        sequence: u32::MAX,
        crc: 0,
    })]);
    requests.extend(Upload::of(&parameters).unwrap().requests());
    requests.push(Request::Expose(exposure));
    requests.push(Request::Correct(std::iter::once(point).collect()));
    for (request, sequence) in requests.iter().zip(65_000..) {
        answers = send(station, &framed(request, sequence));
        assert_eq!(answers.len(), 1);
    }
    let expected = std::iter::once(expected).collect();
    assert_eq!(answers, [Some(Answer::Points(expected))]);
}

/// Sends bytes and reads the answers, each of which must be whole.
fn send<Deck: FlightDeck>(station: &mut Station<Deck>, bytes: &[u8]) -> Vec<Option<Answer>> {
    let mut answers = Vec::new();
    for byte in bytes {
        station.receive(*byte);
        let answer = station.to_send().to_vec();
        station.sent(answer.len());
        assert!(station.to_send().is_empty());
        if let [0, packet @ .., 0] = &answer[..] {
            assert!(answer.len() <= LONGEST_PACKET);
            let (_, answer) = Answer::read(&payload_of(packet).unwrap()).unwrap();
            assert!(answer.is_some());
            answers.push(answer);
        } else {
            assert!(answer.is_empty());
        }
    }
    answers
}

/// Returns a packet with a request of session 5.
fn framed(request: &Request, sequence: u16) -> Vec<u8> {
    let mut packet = Packet::EMPTY;
    let header = Header {
        session: 5,
        sequence,
    };
    request.write(header, &mut packet).unwrap();
    packet.bytes().to_vec()
}

/// Writes a number as `postcard` does: 7 bits a byte, the lowest first, followed by another byte
/// where bit 7 is set.
fn leb128(number: u16) -> Vec<u8> {
    let [low, middle, high] = [0, 7, 14].map(|shift| (number >> shift & 127).to_le_bytes()[0]);
    match (middle, high) {
        (0, 0) => vec![low],
        (_, 0) => vec![low | 128, middle],
        _ => vec![low | 128, middle | 128, high],
    }
}
