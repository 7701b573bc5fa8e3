//! A calibration in parts: whatever happens on its way, the camera uses a whole one.

use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::event::Command;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::io::link::loading::Upload;
use fmc_camera::io::link::message::{Answer, Header, Part, Refusal, Request};
use fmc_camera::io::link::station::LinkEvent;
use fmc_camera::io::link::{CALIBRATION_CAPACITY, MAX_PART};

use crate::link::board::Board;
use crate::link::pc::{Pc, SESSION, begin_load, camera_parameters};

const EXPOSURE: Exposure = Exposure::new(0.1, 0.005);

/// A calibration other than that of [`Pc::loaded`].
fn other() -> CameraParameters {
    let mut record = camera_parameters();
    record.calibration.principal_distance_mm = 60.0;
    record
}

/// The principal distance that the camera uses, mm.
fn principal_distance_mm(pc: &mut Pc) -> f32 {
    match pc.ask(&Request::Expose(EXPOSURE)) {
        Answer::InteriorOrientation(record) => record.principal_distance_mm,
        other => panic!("{other:?}"),
    }
}

/// Announces bytes and sends them in parts; the answer to the last.
fn send_bytes(pc: &mut Pc, bytes: &[u8], crc: u32) -> Answer {
    let length = u32::try_from(bytes.len()).unwrap();
    assert_eq!(
        pc.ask(&Request::BeginLoad {
            length,
            crc,
            keeps_flight: false,
        }),
        Answer::Loading(0)
    );
    let mut last = None;
    for (index, piece) in (0..).zip(bytes.chunks(MAX_PART)) {
        last = Some(pc.ask(&Request::LoadPart(Part {
            crc,
            offset: index * u32::try_from(MAX_PART).unwrap(),
            bytes: piece.iter().copied().collect(),
        })));
    }
    last.unwrap()
}

fn bytes_of(record: &CameraParameters) -> Vec<u8> {
    let upload = Upload::of(record).unwrap();
    upload.parts(MAX_PART).flat_map(|part| part.bytes).collect()
}

fn crc_of(bytes: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes)
}

fn refused(refusal: Refusal) -> Answer {
    Answer::Refused(refusal)
}

#[test]
fn calibration_in_parts_of_any_length_is_in_use_with_the_last_of_them() {
    let upload = Upload::of(&other()).unwrap();
    let total = bytes_of(&other()).len();
    for length in [1, 7, 60, MAX_PART] {
        let mut pc = Pc::loaded();
        let begun = pc.ask(&begin_load(&other()));
        assert_eq!(begun, Answer::Loading(0));
        let mut received = 0;
        for part in upload.parts(length) {
            assert!((principal_distance_mm(&mut pc) - 51.3712).abs() < 1e-6);
            received += part.bytes.len();
            let answer = pc.ask(&Request::LoadPart(part));
            if received < total {
                assert_eq!(answer, Answer::Loading(u32::try_from(received).unwrap()));
            } else {
                let Answer::Loaded(id) = answer else {
                    panic!("{answer:?}");
                };
                assert_eq!((id.crc, id.storage), (upload.crc(), Storage::Volatile));
                assert_eq!(pc.event, Some(LinkEvent::Loaded(id)));
            }
        }
        assert_eq!(received, total);
        assert!((principal_distance_mm(&mut pc) - 60.0).abs() < 1e-6);
    }
}

#[test]
fn part_that_is_not_the_next_is_refused_and_the_load_goes_on() {
    let mut pc = Pc::loaded();
    let upload = Upload::of(&other()).unwrap();
    let parts: Vec<_> = upload.parts(30).map(Request::LoadPart).collect();
    pc.ask(&begin_load(&other()));
    let wrong = |expected| refused(Refusal::PartOutOfOrder { expected });
    assert_eq!(pc.ask(&parts[1]), wrong(0));
    assert_eq!(pc.ask(&parts[0]), Answer::Loading(30));
    assert_eq!(
        pc.ask(&parts[0]),
        wrong(30),
        "once more, under a new number"
    );
    assert_eq!(pc.ask(&parts[2]), wrong(30));
    for part in &parts[1..parts.len() - 1] {
        assert!(matches!(pc.ask(part), Answer::Loading(_)));
    }
    let last = pc.ask(parts.last().unwrap());
    assert!(matches!(last, Answer::Loaded(_)), "{last:?}");
}

#[test]
fn part_whose_answer_was_lost_is_answered_again_and_taken_once() {
    let mut pc = Pc::loaded();
    let upload = Upload::of(&other()).unwrap();
    for request in upload.requests() {
        let header = Header {
            session: SESSION,
            sequence: pc.next,
        };
        let first = pc.ask(&request);
        assert_eq!(pc.ask_as(header, &request), first, "{request:?}");
        assert_eq!(pc.event, Some(LinkEvent::Repeated));
    }
    assert!((principal_distance_mm(&mut pc) - 60.0).abs() < 1e-6);
}

#[test]
fn part_of_another_load_is_refused_and_the_load_goes_on() {
    let mut pc = Pc::loaded();
    pc.ask(&begin_load(&other()));
    let foreign = Upload::of(&camera_parameters()).unwrap();
    let part = foreign.requests().nth(1).unwrap();
    assert_eq!(pc.ask(&part), refused(Refusal::OtherLoad));
    for request in Upload::of(&other()).unwrap().requests().skip(1) {
        let answer = pc.ask(&request);
        assert!(!matches!(answer, Answer::Refused(_)), "{answer:?}");
    }
    assert!((principal_distance_mm(&mut pc) - 60.0).abs() < 1e-6);
}

#[test]
fn parameters_and_parts_that_are_too_long_are_refused() {
    let mut pc = Pc::loaded();
    let most = u32::try_from(CALIBRATION_CAPACITY).unwrap();
    let begin = |length| Request::BeginLoad {
        length,
        crc: 1,
        keeps_flight: false,
    };
    for length in [0, most + 1, u32::MAX] {
        let begin = begin(length);
        assert_eq!(pc.ask(&begin), refused(Refusal::LoadLength { length }));
    }
    let part = |offset, length| {
        Request::LoadPart(Part {
            crc: 1,
            offset,
            bytes: std::iter::repeat_n(0, length).collect(),
        })
    };
    assert_eq!(pc.ask(&begin(60)), Answer::Loading(0));
    assert_eq!(pc.ask(&part(0, 61)), refused(Refusal::PartTooLong));
    assert_eq!(pc.ask(&part(0, 59)), Answer::Loading(59));
    assert_eq!(pc.ask(&part(59, 2)), refused(Refusal::PartTooLong));
    // All of the room there is can be filled.
    assert_eq!(pc.ask(&begin(most)), Answer::Loading(0));
    for offset in [0, 64, 128, 192, 256] {
        assert_eq!(pc.ask(&part(offset, 64)), Answer::Loading(offset + 64));
    }
    assert!(matches!(
        pc.ask(&part(320, CALIBRATION_CAPACITY - 320)),
        Answer::Refused(Refusal::LoadCrc { .. })
    ));
    assert!((principal_distance_mm(&mut pc) - 51.3712).abs() < 1e-6);
}

#[test]
fn load_that_was_interrupted_begins_anew_and_ends_with_its_session() {
    let mut pc = Pc::loaded();
    let requests: Vec<_> = Upload::of(&other()).unwrap().requests().collect();
    assert_eq!(pc.ask(&requests[1]), refused(Refusal::NoLoad));
    pc.ask(&requests[0]);
    pc.ask(&requests[1]);
    // Announced again, it begins at its beginning.
    assert_eq!(pc.ask(&requests[0]), Answer::Loading(0));
    assert_eq!(
        pc.ask(&requests[2]),
        refused(Refusal::PartOutOfOrder { expected: 0 })
    );
    assert!(matches!(pc.ask(&requests[1]), Answer::Loading(_)));
    // A new session has none, and the calibration is the one before.
    let Answer::Connected(identity) = pc.ask(&Request::Connect) else {
        panic!("not connected");
    };
    let crc = Upload::of(&camera_parameters()).unwrap().crc();
    assert_eq!(identity.calibration.unwrap().crc, crc);
    assert_eq!(pc.ask(&requests[2]), refused(Refusal::NoLoad));
    assert!((principal_distance_mm(&mut pc) - 51.3712).abs() < 1e-6);
    assert!(matches!(pc.load(&other()), Answer::Loaded(_)));
}

#[test]
fn parameters_with_another_crc_than_announced_are_not_used() {
    let mut pc = Pc::loaded();
    let bytes = bytes_of(&other());
    let crc = crc_of(&bytes);
    let computed = refused(Refusal::LoadCrc { computed: crc });
    assert_eq!(send_bytes(&mut pc, &bytes, crc ^ 1), computed);
    // The load is over; the calibration is the one before.
    let part = Upload::of(&other()).unwrap().requests().nth(1).unwrap();
    assert_eq!(pc.ask(&part), refused(Refusal::NoLoad));
    assert!((principal_distance_mm(&mut pc) - 51.3712).abs() < 1e-6);
    let loaded = send_bytes(&mut pc, &bytes, crc);
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
}

#[test]
fn bytes_that_are_no_record_are_not_used() {
    let mut pc = Pc::loaded();
    let whole = bytes_of(&other());
    let cut = &whole[..whole.len() - 1];
    let longer = [&whole[..], &[0]].concat();
    // The last bytes are an empty serial number and version 0.
    let mut not_printable = whole.clone();
    not_printable[whole.len() - 17] = 7;
    let much = vec![0xff; CALIBRATION_CAPACITY];
    for bytes in [cut, &longer, &not_printable, &much] {
        let answer = send_bytes(&mut pc, bytes, crc_of(bytes));
        assert_eq!(answer, refused(Refusal::NoRecord));
        let part = Upload::of(&other()).unwrap().requests().nth(1).unwrap();
        assert_eq!(pc.ask(&part), refused(Refusal::NoLoad));
    }
    assert!((principal_distance_mm(&mut pc) - 51.3712).abs() < 1e-6);
}

#[test]
fn load_of_a_calibration_that_is_not_usable_is_over() {
    let mut pc = Pc::loaded();
    let mut bad = other();
    bad.calibration.pixel_um = -1.0;
    let error = Quantity::PixelUm.check(-1.0).unwrap_err();
    assert_eq!(pc.load(&bad), refused(Refusal::Calibration(error.into())));
    let part = Upload::of(&bad).unwrap().requests().nth(2).unwrap();
    assert_eq!(pc.ask(&part), refused(Refusal::NoLoad));
    assert!((principal_distance_mm(&mut pc) - 51.3712).abs() < 1e-6);
}

#[test]
fn load_that_meets_an_armed_camera_waits() {
    let mut board = Board::prepared_at(0);
    let requests: Vec<_> = Upload::of(&other()).unwrap().requests().collect();
    assert_eq!(board.pc.ask(&requests[0]), Answer::Loading(0));
    board.arm();
    assert_eq!(board.pc.ask(&requests[1]), refused(Refusal::FrameInFlight));
    board.command(Command::Disarm);
    assert!(matches!(board.pc.ask(&requests[1]), Answer::Loading(_)));
    assert!(matches!(board.pc.ask(&requests[2]), Answer::Loaded(_)));
    assert_eq!(
        board.pc.ask(&Request::Status),
        refused(Refusal::NotPrepared)
    );
}

#[test]
fn calibration_of_the_board_itself_is_told_as_stored() {
    let mut board = Board::connected(fmc_camera::io::link::message::ResetCause::PowerOn, 0);
    let id = board.pc.station.load(&other(), Storage::Stored).unwrap();
    assert_eq!(id.storage, Storage::Stored);
    let Answer::Connected(identity) = board.pc.ask(&Request::Connect) else {
        panic!("not connected");
    };
    assert_eq!(identity.calibration, Some(id));
    assert_eq!(board.prepare(), Answer::Prepared);
    assert_eq!(board.status().calibration, Some(id));
    board.arm();
    board.trigger(0);
    assert_eq!(board.record(1).calibration, Some(id));
    // A load of the board's own waits for the flight as one over the link does.
    let again = board.pc.station.load(&other(), Storage::Stored);
    assert_eq!(again, Err(Refusal::FrameInFlight));
}
