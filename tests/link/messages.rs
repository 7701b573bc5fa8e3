//! Messages as bytes.

use fmc_camera::flight::bring_up::Trial;
use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::{CameraParameters, Mechanism};
use fmc_camera::flight::control_loop::MAX_EVENTS;
use fmc_camera::flight::event::{AttitudeSample, Event};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::grid_memory::GridMemoryError;
use fmc_camera::flight::rig::RigStep;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::flight::time::Time;
use fmc_camera::geometry::camera_grids::CameraGridsError;
use fmc_camera::geometry::estimation::fit::Fit;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::geometry::five_coefficient::FiveCoefficients;
use fmc_camera::geometry::focus_table::{FOCUS_ROWS, FocusRow, FocusTable};
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::grid::{GridCarrier, GridChecksums, GridError};
use fmc_camera::geometry::mesh::format::{MAX_WORD_BYTES, MeshFormat};
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::geometry::shutter::ShutterProfile;
use fmc_camera::io::instruments::WireBytes;
use fmc_camera::io::instruments::counters::{
    AutopilotCounters, InstrumentCounters, ReceiverCounters,
};
use fmc_camera::io::link::loading::Upload;
use fmc_camera::io::link::message::{
    Answer, Ending, Grid, Header, Identity, Part, Refusal, Request, ResetCause,
};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};
use fmc_camera::io::link::{
    CALIBRATION_CAPACITY, LONGEST_PACKET, LONGEST_PAYLOAD, MAX_GRID_PART, MAX_OBSERVATIONS,
    MAX_PART, MAX_POINTS, PROTOCOL_VERSION,
};
use fmc_camera::io::store::{
    Authentication, NothingStored, Origin, Permission, Signature, SlotFault, StoreOrder,
};

use crate::link::pc::{camera_parameters, packet};

/// Header whose numbers take the most bytes.
const LONGEST_HEADER: Header = Header {
    session: u32::MAX,
    sequence: u16::MAX,
};

/// Mesh row whose numbers take the most bytes.
const LONGEST_MESH_ROW: VertexRow = VertexRow {
    first_col_px: u32::MAX,
    row_px: u32::MAX,
    spacing_px: u16::MAX,
    count: u16::MAX,
    origin_px: [u32::MAX; 2],
};

const FAR_BYTES: WireBytes = WireBytes {
    receiver: u32::MAX,
    autopilot: u32::MAX,
};

const FAR_COUNTERS: InstrumentCounters = InstrumentCounters {
    receiver: ReceiverCounters {
        bytes: u32::MAX,
        other_position: u32::MAX,
        ..ReceiverCounters::NONE
    },
    autopilot: AutopilotCounters {
        system: Some(u8::MAX),
        ..AutopilotCounters::NONE
    },
    crowded_out: u32::MAX,
};

/// A round with as many events as there can be, each of them long.
fn longest_step() -> RigStep {
    let attitude = AttitudeSample {
        pitch_deg: f32::MIN,
        roll_deg: f32::MAX,
        drift_deg: f32::MIN,
        rates_deg_s: [f32::MAX; 3],
    };
    let event = (Time::from_us(u64::MAX), Event::Attitude(attitude));
    RigStep {
        time: Time::from_us(u64::MAX),
        encoder_count: i32::MIN,
        events: std::iter::repeat_n(event, MAX_EVENTS).collect(),
        index_count: Some(i32::MAX),
    }
}

fn payload_of(packet: &Packet) -> Vec<u8> {
    let mut receiver = PacketReceiver::new();
    let (last, bytes) = packet.bytes().split_last().unwrap();
    for byte in bytes {
        assert!(receiver.receive(*byte).is_none());
    }
    receiver.receive(*last).unwrap().unwrap().to_vec()
}

/// Returns a record with every number, each in its longest form.
fn longest_record() -> CameraParameters {
    let mut record = camera_parameters();
    record.calibration.fitted = Some(FiveCoefficients::default());
    record.mechanism = Mechanism::Stage {
        acceleration_mm_s2: 1.0,
        settling_ms: 1.0,
        run_up: RunUp::FromRest,
        jerk_mm_s3: Some(1.0),
        max_speed_mm_s: Some(1.0),
    };
    record.shutter = ShutterProfile::Trapezoid {
        opening_fraction: 0.1,
        closing_fraction: 0.1,
    };
    record.serial = SerialNumber::new("0123456789abcdef").unwrap();
    record.version = u32::MAX;
    record.grids = GridChecksums {
        lens: Some(u32::MAX),
        sensor: Some(u32::MAX),
    };
    let row = FocusRow {
        temperature_c: 1.0,
        focus_shift_um: 1.0,
    };
    record.focus = FocusTable::new(&[row; FOCUS_ROWS]).unwrap();
    record
}

fn far_observation() -> Observation<f32> {
    Observation {
        x_mm: f32::MAX,
        y_mm: f32::MIN,
        dx_mm: f32::MAX,
        dy_mm: f32::MIN,
        regressor_mm: f32::MAX,
        sigma_mm: f32::MIN_POSITIVE,
    }
}

#[test]
fn longest_messages_fit_and_come_back_as_they_went() {
    let far = SensorPoint::new(f32::MIN, f32::MAX);
    let full = || std::iter::repeat_n(far, MAX_POINTS).collect();
    for request in [
        Request::Correct(full()),
        Request::Distort(full()),
        Request::BeginLoad {
            length: u32::MAX,
            crc: u32::MAX,
            keeps_flight: true,
        },
        Request::LoadPart(Part {
            crc: u32::MAX,
            offset: u32::MAX,
            bytes: std::iter::repeat_n(u8::MAX, MAX_PART).collect(),
        }),
        Request::GridPart(Part {
            crc: u32::MAX,
            offset: u32::MAX,
            bytes: std::iter::repeat_n(u8::MAX, MAX_GRID_PART).collect(),
        }),
        Request::Observe(std::iter::repeat_n(far_observation(), MAX_OBSERVATIONS).collect()),
        Request::Digest(Grid {
            x_mm: std::iter::repeat_n(f32::MAX, MAX_POINTS).collect(),
            y_mm: std::iter::repeat_n(f32::MIN, MAX_POINTS).collect(),
        }),
        Request::Mesh(LONGEST_MESH_ROW, MeshFormat::Single),
        Request::Corrections(LONGEST_MESH_ROW),
        Request::Wired(longest_step(), FAR_BYTES),
        Request::Instruments,
        Request::Expose(Exposure {
            opening_offset_mm: Some(-0.1),
            ..Exposure::new(0.1, 0.01)
        }),
    ] {
        let payload = payload_of(&packet(LONGEST_HEADER, &request));
        let (header, read) = Request::read(&payload).unwrap();
        assert_eq!((header, read), (LONGEST_HEADER, Some(request)));
    }
    let corrected = Corrected {
        point: far,
        ..Corrected::default()
    };
    let far_correction = PixelCorrection {
        cols_px: f32::MAX,
        rows_px: f32::MIN,
    };
    let uncovered = CameraGridsError::Grid {
        carrier: GridCarrier::Sensor,
        error: GridError::Uncovered {
            from_mm: [f32::MIN; 2],
            to_mm: [f32::MAX; 2],
            region_from_mm: [f32::MIN; 2],
            region_to_mm: [f32::MAX; 2],
        },
    };
    let long = "x".repeat(40);
    for answer in [
        Answer::Points(std::iter::repeat_n(corrected, MAX_POINTS).collect()),
        Answer::Fitted(Fit {
            options: FitOptions::default(),
            points: u32::MAX,
            unknowns: u32::MAX,
            values: [f32::MAX; 6],
            standard_deviations: [f32::MAX; 6],
            correlations: [[f32::MIN; 6]; 6],
            sigma0: f32::MAX,
            sigma0_as_printed: Some(f32::MAX),
            condition: f32::MAX,
        }),
        Answer::Mesh(std::iter::repeat_n(u8::MAX, MAX_POINTS * MAX_WORD_BYTES).collect()),
        Answer::Corrections(std::iter::repeat_n(far_correction, MAX_POINTS).collect()),
        Answer::Instruments(FAR_COUNTERS),
        Answer::Refused(Refusal::OtherBytes(FAR_BYTES)),
        Answer::Refused(Refusal::Grids(GridMemoryError::Unfit(uncovered))),
        Answer::Connected(Identity::new(&long, &long[..24], true, ResetCause::Fault)),
    ] {
        let mut packet = Packet::EMPTY;
        answer.write(LONGEST_HEADER, &mut packet).unwrap();
        assert!(packet.bytes().len() <= LONGEST_PACKET);
        let (header, read) = Answer::read(&payload_of(&packet)).unwrap();
        assert_eq!((header, read), (LONGEST_HEADER, Some(answer)));
    }
    let mut packet = Packet::EMPTY;
    let answer = Answer::Points(std::iter::repeat_n(corrected, MAX_POINTS).collect());
    answer.write(LONGEST_HEADER, &mut packet).unwrap();
    // The buffers are 5 bytes longer than the longest payload.
    assert_eq!(payload_of(&packet).len(), LONGEST_PAYLOAD - 5);
}

#[test]
fn longest_record_of_a_camera_is_kept_until_it_is_complete_with_room_to_spare() {
    let upload = Upload::of(&longest_record()).unwrap();
    let bytes: usize = upload.parts(MAX_PART).map(|part| part.bytes.len()).sum();
    assert!(bytes > MAX_PART && bytes <= CALIBRATION_CAPACITY, "{bytes}");
}

#[test]
fn bytes_on_the_wire_are_those_of_the_description() {
    let header = Header {
        session: 0x0102,
        sequence: 3,
    };
    let request = packet(header, &Request::Connect);
    // Version 11; session 0x0102, seven bits a byte; number 3; request 0. The zero at the end is
    // COBS's second block.
    let encoded = [5, 11, 0x82, 2, 3, 1];
    let checked = [&[0x86, 0x80], &encoded[..]].concat();
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&checked);
    let crc = [0, 7, 14, 21, 28].map(|shift| ((crc >> shift) & 127 | 128).to_le_bytes()[0]);
    assert_eq!(request.bytes(), [&[0], &checked[..], &crc, &[0]].concat());
    assert_eq!(PROTOCOL_VERSION, 11);
    let latest = format!("|---|---|\n| {PROTOCOL_VERSION} |");
    assert!(include_str!("../../CHANGELOG.md").contains(&latest));
}

#[test]
fn quantities_keep_the_numbers_they_were_given() {
    for (quantity, number) in [
        (Quantity::PrincipalDistanceMm, 0),
        (Quantity::VhPerS, 28),
        (Quantity::DisagreementPercent, 57),
        (Quantity::SmearBudgetPx, 58),
        (Quantity::DutyDelayS, 78),
    ] {
        assert_eq!(Quantity::ALL.get(number), Some(&quantity));
        let mut packet = Packet::EMPTY;
        let error = quantity.check(f32::NAN).unwrap_err();
        Answer::Refused(Refusal::Settings(error))
            .write(LONGEST_HEADER, &mut packet)
            .unwrap();
        let payload = payload_of(&packet);
        // The number comes first, then value and range.
        assert_eq!(
            usize::from(payload[payload.len() - 13]),
            number,
            "{quantity}"
        );
    }
}

#[test]
fn requests_and_answers_keep_the_numbers_they_were_given() {
    let header = Header {
        session: 1,
        sequence: 2,
    };
    let attitude = Event::Attitude(AttitudeSample {
        pitch_deg: 1.0,
        roll_deg: 2.0,
        drift_deg: 3.0,
        rates_deg_s: [0.1, 0.2, 0.3],
    });
    let corrections = [PixelCorrection {
        cols_px: 1.5,
        rows_px: -0.25,
    }];
    let part = Part {
        crc: 1,
        offset: 2,
        bytes: [3, 4].into_iter().collect(),
    };
    let grid_part = Part {
        crc: 1,
        offset: 2,
        bytes: [3, 4].into_iter().collect(),
    };
    let begin_grid = Request::BeginGrid {
        carrier: GridCarrier::Lens,
        length: 1,
        crc: 2,
    };
    let nothing_stored = NothingStored {
        slots: [SlotFault::Blank, SlotFault::NoRecord],
    };
    let unsigned = StoreOrder {
        origin: Origin::default(),
        authentication: None,
    };
    let signed = StoreOrder {
        authentication: Some(Authentication {
            signature: Signature::new(&[7; Signature::BYTES]),
            permission: Some(Permission { store: 1, crc: 2 }),
        }),
        ..unsigned.clone()
    };
    let begin_load = Request::BeginLoad {
        length: 1,
        crc: 2,
        keeps_flight: true,
    };
    // The number of a request follows version, session and number of the message.
    for (request, number) in vec![
        (Request::Connect, 0),
        (begin_load, 1),
        (Request::LoadPart(part), 6),
        (Request::Reset(Ending::Forced), 9),
        (Request::Fit, 13),
        (Request::Flown, 19),
        (Request::Tell(attitude), 20),
        (Request::Mesh(LONGEST_MESH_ROW, MeshFormat::Single), 21),
        (Request::Corrections(LONGEST_MESH_ROW), 22),
        (begin_grid, 25),
        (Request::GridPart(grid_part), 26),
        (Request::ConnectReading, 27),
        (Request::Store(unsigned), 28),
        (Request::Store(signed), 28),
        (Request::Stored, 29),
        (Request::Inputs, 30),
        (Request::Try(Trial::Jog { way_um: 1.0 }), 31),
    ] {
        let payload = payload_of(&packet(header, &request));
        assert_eq!(payload[3], number, "{request:?}");
        assert_eq!(Request::read(&payload), Ok((header, Some(request))));
    }
    for (answer, number) in [
        (Answer::Loading(200), 4),
        (Answer::Ending, 7),
        (Answer::Refused(Refusal::OnRig), 8),
        (Answer::Prepared, 11),
        (Answer::Told, 17),
        (Answer::Mesh([1, 2, 3, 4].into_iter().collect()), 18),
        (Answer::Corrections(corrections.into_iter().collect()), 19),
        (Answer::GridLoaded(GridCarrier::Sensor), 21),
        (Answer::Stored(Err(nothing_stored)), 22),
    ] {
        let mut packet = Packet::EMPTY;
        answer.write(header, &mut packet).unwrap();
        let payload = payload_of(&packet);
        assert_eq!(payload[3], number, "{answer:?}");
        assert_eq!(Answer::read(&payload), Ok((header, Some(answer))));
    }
    // The number of corrections comes first, then columns and rows in little endian.
    let mut packet = Packet::EMPTY;
    let answer = Answer::Corrections(corrections.into_iter().collect());
    answer.write(header, &mut packet).unwrap();
    let numbers = [1.5_f32, -0.25].map(f32::to_le_bytes);
    assert_eq!(
        payload_of(&packet)[4..],
        [&[1], numbers.as_flattened()].concat()
    );
}

#[test]
fn what_follows_the_header_is_one_message_to_the_last_byte() {
    let header = Header {
        session: 5,
        sequence: 6,
    };
    let whole = payload_of(&packet(header, &Request::Expose(Exposure::new(0.1, 0.01))));
    for length in 0..whole.len() {
        let read = Request::read(&whole[..length]);
        assert!(!matches!(read, Ok((_, Some(_)))), "cut to {length}");
    }
    let mut longer = whole.clone();
    longer.push(0);
    assert_eq!(Request::read(&longer), Ok((header, None)));
    let mut other = whole;
    other[3] = 200; // no request has this number
    assert_eq!(Request::read(&other), Ok((header, None)));
}

#[test]
fn names_that_are_too_long_are_left_empty() {
    let long = "x".repeat(41);
    let identity = Identity::new(&long, &long, true, ResetCause::PowerOn);
    assert_eq!((identity.build.as_str(), identity.board.as_str()), ("", ""));
}
