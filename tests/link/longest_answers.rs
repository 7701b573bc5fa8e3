//! Frame records and answers whose numbers take the most bytes: each fits its buffer.

use fmc_camera::flight::calibration_id::{CalibrationId, SerialNumber, Storage};
use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::control_loop::RoundActions;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::Action;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::fault::{Fault, Faults};
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, Flags, FrameRecord, Outcome, Reason};
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::rig::RigAnswer;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcTime;
use fmc_camera::flight::vh::{VhEstimate, VhSource};
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera::io::link::digest;
use fmc_camera::io::link::message::{Answer, Counters, Header, Identity, Request, Status};
use fmc_camera::io::link::packet::Packet;
use fmc_camera::io::link::{LONGEST_PACKET, LONGEST_READING};
use fmc_camera::io::store::{NothingStored, StoredIdentity};

use crate::link::pc::{Pc, camera_parameters};

const HEADER: Header = Header {
    session: u32::MAX,
    sequence: u16::MAX,
};

/// Bytes of a packet around a message: version, header, number of the answer, COBS, length and CRC.
const HEADERS: usize = 32;

const LATE: Time = Time::from_us(u64::MAX);

fn calibration() -> CalibrationId {
    CalibrationId {
        serial: SerialNumber::new("0123456789abcdef").unwrap(),
        version: u32::MAX,
        crc: u32::MAX,
        storage: Storage::Volatile,
    }
}

/// A record in which nothing is left out and every whole number is as long as can be.
fn longest_record() -> FrameRecord {
    let camera = Camera::new(camera_parameters()).unwrap();
    let interior = camera.frame(&Exposure::new(0.1, 0.005)).unwrap().interior;
    let (mut faults, mut flags) = (Faults::NONE, Flags::NONE);
    for fault in Fault::ALL {
        faults.insert(fault);
    }
    for flag in Flag::ALL {
        flags.insert(flag);
    }
    FrameRecord {
        sequence: u32::MAX,
        trigger: LATE,
        outcome: Outcome::Exposed(ExposedFrame {
            opened: LATE,
            closed: LATE,
            centroid: LATE,
            centroid_utc: Some(UtcTime {
                unix_us: u64::MAX,
                sigma_s: f32::MAX,
            }),
            vh: Some(VhEstimate {
                vh_per_s: f32::MAX,
                sigma_per_s: f32::MAX,
                age_s: f32::MAX,
                source: VhSource::Terrain,
                extrapolated: true,
            }),
            planned_opening_mm: f32::MIN,
            planned_travel_mm: f32::MIN,
            interior,
            principal_point_sigma: PrincipalPointSigma {
                frame_mm: f32::MAX,
                common_mm: f32::MAX,
            },
            smear_um: f32::MAX,
            smear_px: f32::MAX,
        }),
        faults,
        flags,
        calibration: Some(calibration()),
        boot: u32::MAX,
        flight: u32::MAX,
    }
}

/// Returns the answer's bytes on the wire, after reading it back.
fn sent(answer: &Answer) -> usize {
    let mut packet = Packet::EMPTY;
    assert!(answer.write(HEADER, &mut packet).is_some(), "{answer:?}");
    let bytes = packet.bytes().len();
    assert!(bytes <= LONGEST_PACKET, "{bytes}: {answer:?}");
    bytes
}

#[test]
fn longest_frame_record_fits_its_digest_and_its_answer() {
    let record = longest_record();
    let crc = digest::of_frame_record(&record);
    assert!(crc.is_some());
    let refused = FrameRecord {
        outcome: Outcome::Refused(Reason::Fault(Fault::ALL[0])),
        ..record
    };
    assert!(digest::of_frame_record(&refused).is_some());
    let with = sent(&Answer::FrameRecord(Some((record, u32::MAX))));
    let without = sent(&Answer::FrameRecord(None));
    // Longer than any record of a flight, and shorter than the digest's 256 bytes and a CRC.
    assert!(
        (200..256 + 5).contains(&(with - without)),
        "{with} {without}"
    );
}

#[test]
fn longest_answers_of_a_flight_fit_a_packet() {
    let mut pc = Pc::loaded();
    let Answer::Counters(counters) = pc.ask(&Request::Counters) else {
        panic!()
    };
    let open = Action::OpenShutter {
        at: LATE,
        exposure_s: f32::MAX,
    };
    let mut actions = RoundActions::new();
    while actions.push(open).is_ok() {}
    let record = longest_record();
    let Outcome::Exposed(exposed) = record.outcome else {
        panic!()
    };
    for answer in [
        Answer::Rig(RigAnswer {
            duty: f32::MIN,
            powered: true,
            actions,
            state: State::Fault(Fault::ALL[0]),
        }),
        Answer::Loaded(calibration()),
        Answer::Flown(u32::MAX, exposed.interior),
        Answer::Counters(Counters {
            stack_used_bytes: u32::MAX,
            ..counters
        }),
    ] {
        sent(&answer);
    }
    // Status and counters of the wires are counts, each of five bytes at most, and a calibration's
    // identity; a session for reading has less room than others.
    let longest = |bytes: usize| 5 * bytes / size_of::<u32>() + HEADERS;
    assert!(longest(size_of::<Status>()) < LONGEST_READING);
    assert!(longest(size_of::<InstrumentCounters>()) < LONGEST_READING);
    assert!(longest(size_of::<Identity>()) < LONGEST_READING);
    let stored = size_of::<Result<StoredIdentity, NothingStored>>();
    assert!(longest(stored) < LONGEST_READING);
    let record = Answer::FrameRecord(Some((longest_record(), u32::MAX)));
    assert!(sent(&record) < LONGEST_READING);
}
