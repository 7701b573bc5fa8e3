//! Answers compared with the same code in this process.

use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::io::link::MAX_POINTS;
use fmc_camera::io::link::message::{Answer, Grid, Refusal};

use super::{EXPOSURE, VERTICES, camera, exposed, grid, link_error, points};
use crate::device::error::{DeviceError, DifferentResult};
use crate::device::faulty_port::FaultyPort;
use crate::device::link_error::LinkError;
use crate::device::remote::{Remote, Session};
use crate::device::{CorrectingDevice, Device, FlownCamera as _, InProcess};

#[test]
fn remote_camera_answers_what_the_one_in_process_does() {
    let (mut remote, _) = exposed();
    let mut twin = InProcess::default();
    twin.load(&camera()).unwrap();
    let record = twin.expose(&EXPOSURE).unwrap();
    assert_eq!(remote.interior_orientation().unwrap(), record);
    for count in [0, 1, 64, 65, 200] {
        let points = points(count);
        assert_eq!(remote.correct(&points), twin.correct(&points));
        assert_eq!(remote.distort(&points), twin.distort(&points));
    }
    assert_eq!(remote.correct_grid(&grid()), twin.correct_grid(&grid()));
    for format in MeshFormat::ALL {
        assert_eq!(remote.mesh(&VERTICES, format), twin.mesh(&VERTICES, format));
    }
    assert_eq!(remote.corrections(&VERTICES), twin.corrections(&VERTICES));
    let off_image = VertexRow {
        row_px: 6016,
        ..VERTICES
    };
    let refused = remote.corrections(&off_image);
    assert!(matches!(refused, Err(DeviceError::Mesh(_))), "{refused:?}");
    assert_eq!(refused, twin.corrections(&off_image));
    // A refusal differs in no bit either.
    let before = VertexRow {
        origin_px: [900, 0],
        ..VERTICES
    };
    let refused = remote.mesh(&before, MeshFormat::Uq12Q4);
    assert!(matches!(refused, Err(DeviceError::Mesh(_))), "{refused:?}");
    assert_eq!(refused, twin.mesh(&before, MeshFormat::Uq12Q4));
    assert_eq!(remote.evidence().by_digest, 441);
    assert_eq!(remote.evidence().by_value, 2 * 330 + 56);
    assert!(remote.description().contains("board memory"));
}

#[test]
fn refusals_arrive_with_their_reason_and_place() {
    let mut remote = Remote::connect("test", FaultyPort::new([]), Session::Whole).unwrap();
    assert_eq!(remote.expose(&EXPOSURE), Err(DeviceError::NoFrame));
    let mut bad = camera();
    bad.calibration.principal_distance_mm = -1.0;
    assert!(matches!(
        remote.load(&bad),
        Err(DeviceError::Calibration(_))
    ));
    remote.load(&camera()).unwrap();
    assert_eq!(remote.correct(&points(1)), Err(DeviceError::NoFrame));
    let fast = Exposure::new(1.0, 0.005);
    assert!(matches!(remote.expose(&fast), Err(DeviceError::Frame(_))));
    remote.expose(&EXPOSURE).unwrap();
    let mut off = points(100);
    off[70].x_mm = 41.0;
    assert_eq!(
        remote.correct(&off),
        Err(DeviceError::OffSensor { index: 70 })
    );
    off[70].x_mm = 60.0;
    assert!(matches!(
        remote.distort(&off),
        Err(DeviceError::Distort { index: 70, .. })
    ));
    let row = VertexRow {
        count: 65,
        ..VERTICES
    };
    assert!(matches!(
        link_error(remote.corrections(&row)),
        LinkError::Refused {
            refusal: Refusal::TooMany,
            ..
        }
    ));
    // The session continues after a refusal.
    remote.correct(&points(100)).unwrap();
    assert_eq!(remote.counters().unwrap().unwrap().wrong_crc, 0);
}

#[test]
fn camera_that_computes_otherwise_is_found_out_with_exposure_point_and_values() {
    let (mut remote, port) = exposed();
    port.tamper(|answer| match answer {
        Answer::Digest(digest) => *digest ^= 1,
        Answer::Points(points) if points.len() == 64 => {
            let last = &mut points[63].distortion.dx_mm;
            *last = last.next_up();
        }
        _ => {}
    });
    let Err(DeviceError::Different(difference)) = remote.correct_grid(&grid()) else {
        panic!("not found out");
    };
    assert_eq!(difference.exposure, Some(EXPOSURE));
    let text = difference.to_string();
    for part in [
        "V/H 0.1",
        "exposure 0.005 s",
        "point 63 at x -40 mm, y -21 mm",
        "the camera answers",
        "this PC",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(matches!(
        remote.correct(&points(64)),
        Err(DeviceError::Different(_))
    ));
    remote.correct(&points(63)).unwrap();
}

#[test]
fn every_answer_is_compared_with_the_twin_to_the_last_bit() {
    let found = |change, ask: fn(&mut Remote<FaultyPort>) -> Result<(), DeviceError>| {
        let (mut remote, port) = exposed();
        port.tamper(change);
        match ask(&mut remote) {
            Err(DeviceError::Different(difference)) => difference.result,
            other => panic!("{other:?}"),
        }
    };
    let digest_alone = found(
        |answer| {
            if let Answer::Digest(digest) = answer {
                *digest ^= 1;
            }
        },
        |remote| remote.correct_grid(&grid()).map(drop),
    );
    assert!(matches!(digest_alone, DifferentResult::Digest { .. }));
    let sample = found(
        |answer| {
            if let Answer::Points(points) = answer {
                points[0].point.y_mm = points[0].point.y_mm.next_down();
            }
        },
        |remote| remote.correct_grid(&grid()).map(drop),
    );
    assert!(matches!(sample, DifferentResult::Point { index: 0, .. }));
    let mesh = found(
        |answer| {
            if let Answer::Mesh(bytes) = answer {
                bytes[17] ^= 1;
            }
        },
        |remote| remote.mesh(&VERTICES, MeshFormat::S16Q3).map(drop),
    );
    assert_eq!(mesh, DifferentResult::Mesh { row: VERTICES });
    let corrections = found(
        |answer| {
            if let Answer::Corrections(corrections) = answer {
                corrections[63].rows_px = corrections[63].rows_px.next_up();
            }
        },
        |remote| remote.corrections(&VERTICES).map(drop),
    );
    assert_eq!(corrections, DifferentResult::Mesh { row: VERTICES });
    let record = found(
        |answer| {
            if let Answer::InteriorOrientation(record) = answer {
                record.motion.centroid_mm = -record.motion.centroid_mm;
            }
        },
        |remote| remote.expose(&EXPOSURE).map(drop),
    );
    assert!(matches!(
        record,
        DifferentResult::InteriorOrientation { .. }
    ));
    let calibration = found(
        |answer| {
            if let Answer::Loaded(calibration) = answer {
                calibration.crc ^= 1;
            }
        },
        |remote| remote.load(&camera()),
    );
    assert!(matches!(calibration, DifferentResult::Calibration { .. }));
    let refusing = found(
        |answer| *answer = Answer::Refused(Refusal::Exposure(FrameError::NotFitted)),
        |remote| remote.expose(&EXPOSURE).map(drop),
    );
    assert!(matches!(
        refusing,
        DifferentResult::Refusal {
            camera: Some(_),
            twin: None
        }
    ));
}

#[test]
fn answer_to_something_else_is_an_error() {
    let (mut remote, port) = exposed();
    port.tamper(|answer| *answer = Answer::Digest(0));
    assert!(matches!(
        link_error(remote.correct(&points(1))),
        LinkError::Unexpected { request: "correct" }
    ));
    let (mut remote, port) = exposed();
    port.tamper(|answer| {
        if let Answer::Corrections(corrections) = answer {
            corrections.pop();
        }
    });
    assert!(matches!(
        link_error(remote.corrections(&VERTICES)),
        LinkError::Unexpected {
            request: "corrections"
        }
    ));
    let (mut remote, port) = exposed();
    port.tamper(|answer| {
        if let Answer::Points(points) = answer {
            points.pop();
        }
    });
    assert!(matches!(
        link_error(remote.correct(&points(10))),
        LinkError::Unexpected { .. }
    ));
}

#[test]
fn longest_messages_fit_a_frame() {
    let (mut remote, _) = exposed();
    let long = Grid {
        x_mm: [1.0; MAX_POINTS].into_iter().collect(),
        y_mm: [2.0; MAX_POINTS].into_iter().collect(),
    };
    remote.correct_grid(&long).unwrap();
}

#[test]
fn firmware_older_than_the_counts_of_the_wires_has_none_and_keeps_its_session() {
    let (mut remote, port) = exposed();
    assert_eq!(remote.instruments(), Ok(None));
    port.tamper(|answer| {
        if matches!(answer, Answer::Refused(Refusal::NoInstruments)) {
            *answer = Answer::Refused(Refusal::Unknown);
        }
    });
    assert_eq!(remote.instruments(), Ok(None));
    assert_eq!(remote.expose(&EXPOSURE).map(|_| ()), Ok(()));
}
