//! Conversation of a PC and a camera without errors.

use fmc_camera::flight::calibration_id::{CalibrationId, SerialNumber, Storage};
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::five_coefficient::FiveCoefficients;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::{CorrectionMesh, PixelCorrection};
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::digest;
use fmc_camera::io::link::message::{Answer, Ending, Grid, Header, Points, Request, ResetCause};
use fmc_camera::io::link::station::LinkEvent;

use crate::link::pc::{Pc, SESSION, STACK_USED, camera_parameters};

const EXPOSURE: Exposure = Exposure::new(0.17, 1.0 / 200.0);

fn points() -> Points {
    [(20.0, 10.0), (-26.7, 20.0), (0.0, 0.0)]
        .map(|(x, y)| SensorPoint::new(x, y))
        .into_iter()
        .collect()
}

#[test]
fn answers_are_those_of_the_library_bit_by_bit() {
    let mut pc = Pc::loaded();
    let frame = Camera::new(camera_parameters())
        .unwrap()
        .frame(&EXPOSURE)
        .unwrap();
    assert_eq!(
        pc.ask(&Request::Expose(EXPOSURE)),
        Answer::InteriorOrientation(frame.interior)
    );
    assert_eq!(pc.event, Some(LinkEvent::Exposed));
    assert_eq!(
        pc.ask(&Request::InteriorOrientation),
        Answer::InteriorOrientation(frame.interior)
    );
    assert_eq!(pc.event, Some(LinkEvent::Answered));

    let measured = points();
    let ideal = measured
        .iter()
        .map(|point| frame.correction.correct(*point))
        .collect();
    let Answer::Points(answered) = pc.ask(&Request::Correct(measured.clone())) else {
        panic!("no points");
    };
    assert_eq!(Answer::Points(answered), Answer::Points(ideal));

    let again = measured
        .iter()
        .map(|point| frame.correction.distort(*point).unwrap())
        .collect();
    assert_eq!(pc.ask(&Request::Distort(measured)), Answer::Points(again));
}

#[test]
fn a_mesh_arrives_as_the_library_stores_it_in_every_format() {
    let mut pc = Pc::loaded();
    let frame = Camera::new(camera_parameters())
        .unwrap()
        .frame(&EXPOSURE)
        .unwrap();
    pc.ask(&Request::Expose(EXPOSURE));
    for format in MeshFormat::ALL {
        for count in [0, 1, 64] {
            let row = VertexRow {
                first_col_px: 700,
                row_px: 801,
                spacing_px: 16,
                count,
                origin_px: [600, 700],
            };
            let Answer::Mesh(bytes) = pc.ask(&Request::Mesh(row, format)) else {
                panic!("no mesh");
            };
            let mesh = SourceMesh::new(&frame.correction, row.spacing_px);
            let mut expected = vec![0; usize::from(count) * format.bytes()];
            row.write_words(&mesh, format, &mut expected).unwrap();
            assert_eq!(bytes.as_slice(), expected);
            assert_eq!(bytes.len(), usize::from(count) * format.bytes());
        }
    }
}

#[test]
fn corrections_of_vertices_arrive_as_the_library_gives_them() {
    let mut pc = Pc::loaded();
    let frame = Camera::new(camera_parameters())
        .unwrap()
        .frame(&EXPOSURE)
        .unwrap();
    pc.ask(&Request::Expose(EXPOSURE));
    for (spacing_px, count) in [(16, 0), (16, 1), (16, 64), (224, 64), (0, 2)] {
        let row = VertexRow {
            first_col_px: 7,
            row_px: 801,
            spacing_px,
            count,
            origin_px: [u32::MAX; 2],
        };
        let Answer::Corrections(answered) = pc.ask(&Request::Corrections(row)) else {
            panic!("no corrections");
        };
        let mut expected = [PixelCorrection::default(); 64];
        let mesh = CorrectionMesh::new(&frame.correction, spacing_px);
        let expected = row.corrections(&mesh, &mut expected).unwrap();
        assert_eq!(answered.as_slice(), expected);
        assert_eq!(answered.len(), usize::from(count));
        for vertex in &answered {
            assert!(vertex.rows_px.abs() > 1.0, "{vertex:?}");
        }
    }
}

#[test]
fn digest_of_a_grid_is_that_of_its_points_asked_one_by_one() {
    let mut pc = Pc::loaded();
    pc.ask(&Request::Expose(EXPOSURE));
    let grid = Grid {
        x_mm: [-26.7, -1.25, 0.0, 26.7].into_iter().collect(),
        y_mm: [-20.0, 19.9].into_iter().collect(),
    };
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    for y in [-20.0, 19.9] {
        for x in [-26.7, -1.25, 0.0, 26.7] {
            let point = [SensorPoint::new(x, y)].into_iter().collect();
            let Answer::Points(corrected) = pc.ask(&Request::Correct(point)) else {
                panic!("no points");
            };
            let corrected = corrected[0];
            for value in [
                corrected.point.x_mm,
                corrected.point.y_mm,
                corrected.distortion.dx_mm,
                corrected.distortion.dy_mm,
            ] {
                digest.update(&value.to_le_bytes());
            }
        }
    }
    assert_eq!(
        pc.ask(&Request::Digest(grid)),
        Answer::Digest(digest.finalize())
    );
}

#[test]
fn connecting_tells_who_answers_and_which_calibration_it_holds() {
    let mut pc = Pc::unconnected();
    let Answer::Connected(identity) = pc.ask(&Request::Connect) else {
        panic!("not connected");
    };
    assert_eq!(identity.version, env!("CARGO_PKG_VERSION"));
    assert_eq!(identity.build, "test build");
    assert_eq!(identity.board, "test board");
    assert_eq!(identity.reset_cause, ResetCause::Watchdog);
    assert_eq!(identity.max_points, 64);
    assert_eq!(identity.calibration, None);
    assert_eq!(pc.event, Some(LinkEvent::Connected(SESSION)));

    let record = CameraParameters {
        serial: SerialNumber::new("RC30-5282").unwrap(),
        version: 7,
        ..camera_parameters()
    };
    let calibration = CalibrationId {
        serial: record.serial,
        version: 7,
        crc: digest::of_camera(&record),
        storage: Storage::Volatile,
    };
    assert_eq!(pc.load(&record), Answer::Loaded(calibration));
    assert_eq!(pc.event, Some(LinkEvent::Loaded(calibration)));
    let other = Header {
        session: 7,
        sequence: 99,
    };
    let Answer::Connected(identity) = pc.ask_as(other, &Request::Connect) else {
        panic!("not connected");
    };
    assert_eq!(identity.calibration, Some(calibration));
}

#[test]
fn digest_of_a_calibration_tells_every_field_of_it() {
    let of = |change: fn(&mut fmc_camera::CameraParameters)| {
        let mut record = camera_parameters();
        change(&mut record);
        digest::of_camera(&record)
    };
    let digests = [
        of(|_| {}),
        of(|record| record.calibration.distortion.k1 = -1.6057e-5),
        of(|record| record.calibration.pixel_um = 3.760_000_2),
        of(|record| record.limits.vh_per_s = [0.05, 0.18]),
        of(|record| {
            record.calibration.fitted = Some(FiveCoefficients::default());
        }),
        of(|record| record.version = 1),
        of(|record| record.serial = SerialNumber::new("1").unwrap()),
    ];
    for (index, digest) in digests.iter().enumerate() {
        assert!(!digests[..index].contains(digest), "{index}");
    }
}

#[test]
fn numbers_of_requests_go_round() {
    let mut pc = Pc::unconnected();
    pc.next = u16::MAX;
    for _ in 0..3 {
        pc.ask(&Request::Connect);
        assert!(matches!(pc.ask(&Request::Counters), Answer::Counters(_)));
        pc.next = u16::MAX;
    }
    let last = Header {
        session: SESSION,
        sequence: u16::MAX,
    };
    pc.ask_as(last, &Request::Connect);
    pc.next = 0;
    assert!(matches!(pc.ask(&Request::Counters), Answer::Counters(_)));
}

#[test]
fn counters_tell_the_stack_and_the_overrun() {
    let mut pc = Pc::connected();
    pc.station.count_overrun(3);
    pc.station.count_overrun(u32::MAX);
    let Answer::Counters(counters) = pc.ask(&Request::Counters) else {
        panic!("no counters");
    };
    assert_eq!(counters.overrun_bytes, u32::MAX, "it stops at the end");
    assert_eq!(counters.stack_used_bytes, STACK_USED);
    assert_eq!(counters.done, 1, "the connection");
}

#[test]
fn ending_is_announced_and_left_to_the_board() {
    for (request, event) in [
        (Request::Reset(Ending::Orderly), LinkEvent::Reset),
        (Request::PowerOff(Ending::Orderly), LinkEvent::PowerOff),
    ] {
        let mut pc = Pc::connected();
        assert_eq!(pc.ask(&request), Answer::Ending);
        assert_eq!(pc.event, Some(event));
    }
}
