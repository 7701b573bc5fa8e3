//! Requests that the camera does not act on.

use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::message::{
    Answer, Ending, Grid, Header, Identity, Points, Refusal, Request, ResetCause,
};
use fmc_camera::io::link::station::{LinkEvent, Station};

use crate::link::pc::{Pc, SESSION, begin_load, camera_parameters};

const EXPOSURE: Exposure = Exposure::new(0.1, 0.005);

/// Byte that ends a packet.
type End = fn(&mut Pc) -> Answer;

fn batch(points: &[(f32, f32)]) -> Points {
    points
        .iter()
        .map(|(x, y)| SensorPoint::new(*x, *y))
        .collect()
}

#[test]
fn nothing_is_done_before_what_it_needs() {
    let mut pc = Pc::connected();
    let no_calibration = Answer::Refused(Refusal::NoCalibration);
    assert_eq!(pc.ask(&Request::Expose(EXPOSURE)), no_calibration);
    pc.load(&camera_parameters());
    let grid = Grid {
        x_mm: heapless::Vec::new(),
        y_mm: heapless::Vec::new(),
    };
    for request in [
        Request::InteriorOrientation,
        Request::Correct(batch(&[(0.0, 0.0)])),
        Request::Distort(batch(&[(0.0, 0.0)])),
        Request::Digest(grid),
    ] {
        assert_eq!(pc.ask(&request), Answer::Refused(Refusal::NoFrame));
    }
    assert_eq!(pc.station.counters().refused, 5);
}

#[test]
fn frame_ends_with_its_session_and_with_a_refused_exposure_or_a_new_calibration() {
    let point = Request::Correct(batch(&[(0.0, 0.0)]));
    let connect = |pc: &mut Pc| pc.ask(&Request::Connect);
    let load = |pc: &mut Pc| pc.load(&camera_parameters());
    let expose = |pc: &mut Pc| pc.ask(&Request::Expose(Exposure::new(5.0, 0.005)));
    let ends: [(&str, End); 3] = [
        ("connect", connect),
        ("calibration", load),
        ("exposure", expose),
    ];
    for (what, end) in ends {
        let mut pc = Pc::loaded();
        pc.ask(&Request::Expose(EXPOSURE));
        assert!(matches!(pc.ask(&point), Answer::Points(_)));
        end(&mut pc);
        assert_eq!(pc.ask(&point), Answer::Refused(Refusal::NoFrame), "{what}");
    }
}

#[test]
fn calibration_that_is_not_usable_is_named_and_the_one_before_stays() {
    let mut pc = Pc::loaded();
    let mut bad = camera_parameters();
    bad.calibration.pixel_um = f32::NAN;
    let Answer::Refused(Refusal::Calibration(CalibrationError::OutOfRange(error))) = pc.load(&bad)
    else {
        panic!("not refused");
    };
    assert_eq!(error.quantity, Quantity::PixelUm);
    let mut folding = camera_parameters();
    folding.calibration.distortion.k1 = 1e-3;
    assert!(matches!(
        pc.load(&folding),
        Answer::Refused(Refusal::Calibration(CalibrationError::Folds { .. }))
    ));
    assert!(matches!(
        pc.ask(&Request::Expose(EXPOSURE)),
        Answer::InteriorOrientation(_)
    ));
}

#[test]
fn setting_out_of_its_range_is_named() {
    let mut pc = Pc::loaded();
    let mut settings = FlightSettings::default();
    settings.drive.velocity_loop.max_duty = 1.5;
    let error = Quantity::MaxDuty.check(1.5).unwrap_err();
    assert_eq!(
        pc.ask(&Request::Prepare(settings)),
        Answer::Refused(Refusal::Settings(error))
    );
    assert_eq!(
        Refusal::Settings(error).to_string(),
        "a setting of the flight is refused: max_duty = 1.5 is outside 0.01 to 1"
    );
}

#[test]
fn exposure_out_of_its_limits_is_named() {
    let mut pc = Pc::loaded();
    for vh_per_s in [-0.1, 0.31, f32::NAN, f32::INFINITY] {
        let answer = pc.ask(&Request::Expose(Exposure::new(vh_per_s, 0.005)));
        let Answer::Refused(Refusal::Exposure(FrameError::OutOfRange(error))) = answer else {
            panic!("{answer:?}");
        };
        assert_eq!(error.quantity, Quantity::VhPerS);
    }
}

#[test]
fn measured_points_off_the_sensor_are_not_corrected() {
    let mut pc = Pc::loaded();
    pc.ask(&Request::Expose(EXPOSURE));
    for off in [
        (27.0, 0.0),
        (0.0, -20.1),
        (f32::NAN, 0.0),
        (0.0, f32::INFINITY),
    ] {
        let refused = |index| Answer::Refused(Refusal::OffSensor { index });
        let points = batch(&[(1.0, 1.0), (2.0, 2.0), off]);
        assert_eq!(pc.ask(&Request::Correct(points)), refused(2), "{off:?}");
        let grid = Grid {
            x_mm: [0.0, off.0].into_iter().collect(),
            y_mm: [off.1].into_iter().collect(),
        };
        let index = u16::from(off.1.abs() < 1.0);
        assert_eq!(pc.ask(&Request::Digest(grid)), refused(index), "{off:?}");
    }
}

#[test]
fn mesh_that_cannot_be_given_is_refused_by_vertex_and_reason() {
    let mut pc = Pc::loaded();
    let row = VertexRow {
        first_col_px: 0,
        row_px: 100,
        spacing_px: 16,
        count: 64,
        origin_px: [0, 0],
    };
    let ask = |pc: &mut Pc, row| pc.ask(&Request::Mesh(row, MeshFormat::Q12Q20));
    assert_eq!(ask(&mut pc, row), Answer::Refused(Refusal::NoFrame));
    pc.ask(&Request::Expose(EXPOSURE));
    assert!(matches!(ask(&mut pc, row), Answer::Mesh(_)));
    let many = VertexRow { count: 65, ..row };
    assert_eq!(ask(&mut pc, many), Answer::Refused(Refusal::TooMany));
    let far = VertexRow {
        first_col_px: 2000,
        ..row
    };
    let Answer::Refused(Refusal::Mesh(MeshError::Format(error))) = ask(&mut pc, far) else {
        panic!("2048 px fit");
    };
    assert!(
        error.value_px > 2047.9 && error.value_px < 2100.0,
        "{error}"
    );
    // No number of the row makes the camera's own numbers overflow.
    for off in [u32::MAX, u32::MAX - 1, 1 << 24] {
        let off_image = VertexRow {
            row_px: off,
            spacing_px: u16::MAX,
            ..row
        };
        let refused = ask(&mut pc, off_image);
        let expected = Answer::Refused(Refusal::Mesh(MeshError::OffImage {
            col_px: 0,
            row_px: off,
        }));
        assert_eq!(refused, expected);
        let origin = VertexRow {
            origin_px: [off; 2],
            ..row
        };
        let refused = ask(&mut pc, origin);
        let is_refused = matches!(
            refused,
            Answer::Refused(Refusal::Mesh(MeshError::Format(_)))
        );
        assert!(is_refused, "{refused:?}");
    }
}

#[test]
fn corrections_that_cannot_be_given_are_refused_by_vertex_and_reason() {
    let mut pc = Pc::loaded();
    let row = VertexRow {
        first_col_px: 14_203 - 62 * 16,
        row_px: 10_651 + 16,
        spacing_px: 16,
        count: 64,
        origin_px: [0, 0],
    };
    let ask = |pc: &mut Pc, row| pc.ask(&Request::Corrections(row));
    assert_eq!(ask(&mut pc, row), Answer::Refused(Refusal::NoFrame));
    pc.ask(&Request::Expose(EXPOSURE));
    // The last vertex is one spacing beyond the last column and row.
    assert!(matches!(ask(&mut pc, row), Answer::Corrections(_)));
    let many = VertexRow { count: 65, ..row };
    assert_eq!(ask(&mut pc, many), Answer::Refused(Refusal::TooMany));
    let off = |col_px, row_px| Refusal::Mesh(MeshError::OffImage { col_px, row_px });
    let right = VertexRow {
        first_col_px: row.first_col_px + 1,
        ..row
    };
    let refused = off(14_203 + 17, row.row_px);
    assert_eq!(ask(&mut pc, right), Answer::Refused(refused));
    // No number of the row makes the camera's own numbers overflow.
    for far in [u32::MAX, u32::MAX - 1, 1 << 24] {
        let row = VertexRow {
            first_col_px: far,
            row_px: far,
            spacing_px: u16::MAX,
            ..row
        };
        assert_eq!(ask(&mut pc, row), Answer::Refused(off(far, far)));
    }
}

#[test]
fn ideal_point_without_a_measured_one_is_named() {
    let mut pc = Pc::loaded();
    pc.ask(&Request::Expose(EXPOSURE));
    let answer = pc.ask(&Request::Distort(batch(&[(1.0, 1.0), (30.0, 1.0)])));
    assert!(
        matches!(
            answer,
            Answer::Refused(Refusal::Distort {
                index: 1,
                error: DistortError::OffSensor(_)
            })
        ),
        "{answer:?}"
    );
}

#[test]
fn request_out_of_order_is_refused_with_the_number_expected() {
    let mut pc = Pc::connected();
    for sequence in [pc.next + 1, pc.next.wrapping_sub(2), 40_000] {
        let header = Header {
            session: SESSION,
            sequence,
        };
        let expected = pc.next;
        assert_eq!(
            pc.ask_as(header, &begin_load(&camera_parameters())),
            Answer::Refused(Refusal::OutOfOrder { expected })
        );
    }
    assert_eq!(pc.station.counters().out_of_order, 3);
    // Nothing was loaded, and the right number is still accepted.
    assert_eq!(
        pc.ask(&Request::Expose(EXPOSURE)),
        Answer::Refused(Refusal::NoCalibration)
    );
}

#[test]
fn session_of_another_host_ends_the_first() {
    let mut pc = Pc::loaded();
    let other = Header {
        session: 2,
        sequence: 0,
    };
    pc.ask_as(other, &Request::Connect);
    let ended = Answer::Refused(Refusal::OtherSession);
    assert_eq!(pc.ask(&Request::InteriorOrientation), ended);
    assert_eq!(pc.event, Some(LinkEvent::Refused(Refusal::OtherSession)));
    // The second session continues undisturbed.
    let next = Header {
        session: 2,
        sequence: 1,
    };
    let answer = pc.ask_as(next, &Request::Expose(EXPOSURE));
    assert!(
        matches!(answer, Answer::InteriorOrientation(_)),
        "{answer:?}"
    );
    assert_eq!(pc.station.counters().other_session, 1);
}

#[test]
fn before_a_session_only_connecting_is_answered_otherwise_than_by_refusal() {
    let mut pc = Pc::unconnected();
    for request in [
        Request::Counters,
        Request::Reset(Ending::Forced),
        Request::PowerOff(Ending::Forced),
    ] {
        assert_eq!(pc.ask(&request), Answer::Refused(Refusal::OtherSession));
        assert_eq!(pc.event, Some(LinkEvent::Refused(Refusal::OtherSession)));
    }
}

#[test]
fn camera_without_a_power_switch_says_so() {
    let mut pc = Pc::unconnected();
    let identity = Identity::new("", "", false, ResetCause::Watchdog);
    pc.station = Station::new(identity, || 0);
    pc.ask(&Request::Connect);
    assert_eq!(
        pc.ask(&Request::PowerOff(Ending::Forced)),
        Answer::Refused(Refusal::NoPowerSwitch)
    );
}
