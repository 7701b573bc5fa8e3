//! Tests of the link under faults: every result is right, or an error.

use fmc_camera::flight::camera::{CameraParameters, FrameError};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::geometry::mesh::MeshRow;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::MAX_POINTS;
use fmc_camera::io::link::message::{Answer, Grid, Refusal, ResetCause};
use proptest::prelude::*;

use super::client::{Client, TRIES};
use super::error::{DeviceError, DifferentResult};
use super::faulty_port::{Fault, FaultyPort};
use super::link_error::LinkError;
use super::remote::Remote;
use super::{CorrectingDevice, Device, InProcess};

fn camera() -> CameraParameters {
    let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    lens.distortion = Brown {
        k1: -1e-6,
        k2: 2e-10,
        p1: 1e-6,
        b1: 1e-5,
        ..Brown::default()
    };
    CameraParameters::new(lens)
}

fn points(count: u16) -> Vec<SensorPoint> {
    (0..count)
        .map(|index| SensorPoint::new(0.1 * f32::from(index) - 20.0, 0.05 * f32::from(index)))
        .collect()
}

fn grid() -> Grid {
    let side = |half: f32| (0..21_u8).map(move |index| half * (f32::from(index) / 10.0 - 1.0));
    Grid {
        x_mm: side(40.0).collect(),
        y_mm: side(30.0).collect(),
    }
}

const VERTICES: VertexRow = VertexRow {
    first_col_px: 480,
    row_px: 160,
    spacing_px: 16,
    count: 64,
    origin_px: [320, 64],
};

const EXPOSURE: Exposure = Exposure::new(0.1, 0.005);

/// Returns a camera that has been exposed, on a wire without faults so far.
fn exposed() -> (Remote<FaultyPort>, FaultyPort) {
    let port = FaultyPort::new([]);
    let mut remote = Remote::connect("test", port.clone()).unwrap();
    remote.load(&camera()).unwrap();
    remote.expose(&EXPOSURE).unwrap();
    (remote, port)
}

fn link_error<T: std::fmt::Debug>(result: Result<T, DeviceError>) -> LinkError {
    match result.unwrap_err() {
        DeviceError::Link { error, .. } => error,
        other => panic!("{other}"),
    }
}

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
    let row = MeshRow {
        first: SensorPoint::new(-40.0, 10.0),
        step_mm: 1.25,
        count: 64,
    };
    let on_row: Vec<_> = row.points().collect();
    let expected: Vec<_> = twin.correct(&on_row).unwrap();
    let expected: Vec<_> = expected.iter().map(|point| point.distortion).collect();
    assert_eq!(remote.row(row).unwrap(), expected);
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
    let mut remote = Remote::connect("test", FaultyPort::new([])).unwrap();
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
    let row = MeshRow {
        first: SensorPoint::new(0.0, 0.0),
        step_mm: 0.1,
        count: 65,
    };
    assert!(matches!(
        link_error(remote.row(row)),
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
fn second_host_takes_the_session_and_the_first_is_told() {
    let (mut first, port) = exposed();
    let mut second = Remote::connect("second", port.another()).unwrap();
    assert_eq!(
        link_error(first.correct(&points(3))),
        LinkError::SessionEnded
    );
    // The calibration belongs to the camera and stays; the frame belonged to the first host.
    assert_eq!(second.correct(&points(3)), Err(DeviceError::NoFrame));
    second.load(&camera()).unwrap();
    second.expose(&EXPOSURE).unwrap();
    second.correct(&points(100)).unwrap();
    assert_eq!(
        link_error(first.interior_orientation()),
        LinkError::SessionEnded
    );
    first.reconnect().unwrap();
    first.load(&camera()).unwrap();
    assert_eq!(
        link_error(second.interior_orientation()),
        LinkError::SessionEnded
    );
}

#[test]
fn restart_of_the_camera_ends_the_session_and_a_new_one_starts_afresh() {
    let (mut remote, port) = exposed();
    assert_eq!(remote.identity().reset_cause, ResetCause::PowerOn);
    port.restart();
    let error = remote.correct(&points(3)).unwrap_err();
    assert!(error.to_string().contains("has restarted"), "{error}");
    remote.reconnect().unwrap();
    assert_eq!(remote.identity().reset_cause, ResetCause::Watchdog);
    assert_eq!(remote.identity().calibration, None);
    assert_eq!(remote.correct(&points(3)), Err(DeviceError::NoFrame));
}

#[test]
fn reset_starts_the_camera_again() {
    let (mut remote, _) = exposed();
    remote.reset().unwrap();
    assert_eq!(remote.identity().reset_cause, ResetCause::Requested);
    assert_eq!(remote.expose(&EXPOSURE), Err(DeviceError::NoFrame));
    assert_eq!(remote.counters().unwrap().unwrap().done, 1);
}

#[test]
fn request_is_given_up_after_the_documented_tries_and_nothing_follows() {
    let (mut remote, port) = exposed();
    port.set_faults([Fault::Lost; TRIES as usize]);
    let LinkError::NoAnswer { tries, heard, .. } = link_error(remote.interior_orientation()) else {
        panic!();
    };
    assert_eq!((tries, heard.bytes), (TRIES, 0));
    // The wire is free of faults again, but what the camera did meanwhile is not known.
    assert!(matches!(
        link_error(remote.interior_orientation()),
        LinkError::NoAnswer { .. }
    ));
    remote.reconnect().unwrap();
    port.set_faults([Fault::Lost; TRIES as usize - 1]);
    remote.counters().unwrap().unwrap();
}

#[test]
fn lost_answer_is_given_again_without_acting_twice() {
    let (mut remote, port) = exposed();
    let before = remote.counters().unwrap().unwrap();
    // The request arrives and the answer is lost, twice.
    port.set_faults([Fault::None, Fault::Lost, Fault::None, Fault::Lost]);
    remote.correct(&points(10)).unwrap();
    let after = remote.counters().unwrap().unwrap();
    assert_eq!(after.done - before.done, 2);
    assert_eq!(after.repeated - before.repeated, 2);
}

#[test]
fn late_answers_of_an_earlier_session_are_ignored() {
    let (mut remote, port) = exposed();
    port.set_faults([Fault::None, Fault::Echoed(1)]);
    remote.counters().unwrap().unwrap();
    port.set_faults([Fault::Lost, Fault::None]);
    remote.reconnect().unwrap();
    remote.load(&camera()).unwrap();
    remote.expose(&EXPOSURE).unwrap();
    remote.correct(&points(10)).unwrap();
}

#[test]
fn connect_after_a_host_that_died_in_the_middle_of_a_batch() {
    let (_, port) = exposed();
    // Half a frame, whose rest never comes.
    port.inject(&[0, 200, 1, 2, 3, 4, 5, 6, 7, 8]);
    let mut next = Remote::connect("next", port.clone()).unwrap();
    next.load(&camera()).unwrap();
    next.expose(&EXPOSURE).unwrap();
    assert_eq!(next.counters().unwrap().unwrap().truncated, 1);
}

#[test]
fn closed_port_is_an_error_at_once() {
    let (mut remote, port) = exposed();
    port.close();
    assert_eq!(link_error(remote.interior_orientation()), LinkError::Closed);
}

#[test]
fn power_off_ends_the_session() {
    let mut client = Client::new(FaultyPort::new([]));
    client.connect().unwrap();
    client.power_off().unwrap();
    assert_eq!(client.counters(), Err(LinkError::SessionEnded));
}

fn fault() -> impl Strategy<Value = Fault> {
    prop_oneof![
        12 => Just(Fault::None),
        2 => Just(Fault::Lost),
        2 => (any::<usize>(), 1_u8..).prop_map(|(at, bits)| Fault::Corrupted { at, bits }),
        2 => any::<u8>().prop_map(Fault::Truncated),
        2 => Just(Fault::Duplicated),
        2 => (1_u8..12).prop_map(Fault::Delayed),
        2 => (1_u8..12).prop_map(Fault::Echoed),
        1 => Just(Fault::Restart),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_result_is_right_or_an_error(faults in proptest::collection::vec(fault(), 0..80)) {
        let port = FaultyPort::new(faults);
        let Ok(mut remote) = Remote::connect("test", port) else {
            return Ok(());
        };
        let mut twin = InProcess::default();
        twin.load(&camera()).unwrap();
        let points = points(100);
        for vh in [0.06, 0.1, 0.16] {
            let exposure = Exposure::new(vh, 0.005);
            let record = twin.expose(&exposure).unwrap();
            let answers = (|| {
                remote.load(&camera())?;
                let record = remote.expose(&exposure)?;
                let corrected = remote.correct(&points)?;
                let distorted = remote.distort(&points)?;
                let gridded = remote.correct_grid(&grid())?;
                Ok((record, corrected, distorted, gridded))
            })();
            match answers {
                Ok(answers) => {
                    let expected = (
                        record,
                        twin.correct(&points).unwrap(),
                        twin.distort(&points).unwrap(),
                        twin.correct_grid(&grid()).unwrap(),
                    );
                    prop_assert_eq!(answers, expected);
                }
                // Faults of the wire may end the session, but no answer may be taken for that to
                // another request.
                Err(DeviceError::Link { .. } | DeviceError::NoFrame) => {
                    let _ = remote.reconnect();
                }
                Err(other) => prop_assert!(false, "{}", other),
            }
        }
    }
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
fn reset_whose_answer_is_lost_is_still_a_reset() {
    let (mut remote, port) = exposed();
    port.set_faults([Fault::None, Fault::Lost]);
    remote.reset().unwrap();
}

#[test]
fn request_out_of_order_ends_the_conversation() {
    let (mut remote, port) = exposed();
    port.tamper(|answer| *answer = Answer::Refused(Refusal::OutOfOrder { expected: 9 }));
    let first = link_error(remote.interior_orientation());
    port.tamper(|_| {});
    assert_eq!(link_error(remote.interior_orientation()), first);
}
