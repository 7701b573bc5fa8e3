//! The time of a cycle that a preparation allows, and marks that rows do not have.

use fmc_camera::flight::camera::{Camera, CameraParameters, FrameError, Mechanism};
use fmc_camera::flight::controller::{ControllerError, Start};
use fmc_camera::flight::exposure::{Exposure, FlightDirection};
use fmc_camera::flight::frame_record::Reason;
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::StrokeTooShort;
use fmc_camera::geometry::principal_point::{PrincipalPointMotion, StageSample};
use fmc_camera::geometry::range::Quantity;

use crate::controller::bench::camera;

fn start(camera: &CameraParameters, settings: &FlightSettings) -> Result<(), ControllerError> {
    PreparedCamera::new(Camera::new(*camera).unwrap(), settings, Start::Orderly).map(|_| ())
}

/// Returns the time from a trigger until the stage waits again, s, by the refusal of a shorter one.
fn needed_s(direction: FlightDirection, index_mm: Option<f32>, play_um: f32) -> f32 {
    let mut settings = FlightSettings {
        direction,
        trigger_interval_s: 0.001,
        ..FlightSettings::default()
    };
    settings.drive.index_mm = index_mm;
    settings.drive.play_um = play_um;
    let refused = start(&camera(), &settings);
    let Err(ControllerError::Travel(FrameError::Time { needed_s, .. })) = refused else {
        panic!("{refused:?}");
    };
    settings.trigger_interval_s = needed_s;
    assert_eq!(start(&camera(), &settings), Ok(()));
    settings.trigger_interval_s = 0.999 * needed_s;
    assert!(start(&camera(), &settings).is_err());
    needed_s
}

#[test]
fn cycle_that_does_not_cross_the_mark_takes_the_time_of_ways_across_it() {
    for direction in [FlightDirection::Forward, FlightDirection::Reverse] {
        for play_um in [0.0, 5.0] {
            let at = |index_mm| needed_s(direction, index_mm, play_um);
            let without_s = at(None);
            for index_mm in [-1.8, 1.8] {
                let with_s = at(Some(index_mm));
                assert!(with_s > without_s + 0.05, "{with_s}, {without_s}");
                assert!(with_s < without_s + 0.4, "{with_s}, {without_s}");
            }
            // The nearer the mark, the shorter are the ways.
            assert!(at(Some(1.2)) < at(Some(1.8)));
            assert!(at(Some(0.0)) < at(Some(1.2)));
        }
    }
}

#[test]
fn rows_have_neither_mark_nor_fly_back() {
    let rows = CameraParameters {
        mechanism: Mechanism::Tdi {
            first_transfer: 0.5,
        },
        ..camera()
    };
    let mut settings = FlightSettings::default();
    // Beyond the stroke, and shorter than any cycle of a stage.
    settings.drive.index_mm = Some(40.0);
    settings.trigger_interval_s = 0.001;
    assert_eq!(start(&rows, &settings), Ok(()));
    assert!(start(&camera(), &settings).is_err());
}

#[test]
fn refusal_of_a_plan_is_the_reason_in_the_record() {
    let stroke = StrokeTooShort {
        from_mm: -2.5,
        to_mm: 1.0,
        half_stroke_mm: 2.0,
    };
    let speed = FrameError::Speed {
        wanted_mm_s: 30.0,
        max_mm_s: 20.0,
    };
    let time = FrameError::Time {
        needed_s: 2.0,
        available_s: 1.0,
    };
    let found = [
        FrameError::Stroke(stroke),
        speed,
        time,
        FrameError::NotFitted,
    ];
    assert_eq!(
        found.map(Reason::from),
        [
            Reason::Stroke,
            Reason::Speed,
            Reason::OutsideLimits,
            Reason::OutsideLimits
        ]
    );
}

#[test]
fn motion_that_leaves_the_stroke_and_comes_back_in_an_exposure_has_no_frame() {
    let camera = Camera::new(camera()).unwrap();
    let exposure = Exposure::new(0.1, 0.01);
    let frame = |farthest_mm: f32| {
        let path = [0.0, 1.0, -1.0, 0.0].map(|part| part * farthest_mm);
        let times_s = [0.0, 0.0025, 0.0075, 0.01];
        let samples = [0, 1, 2, 3].map(|index| StageSample {
            time_s: times_s[index],
            offset_mm: path[index],
        });
        let motion = PrincipalPointMotion::from_samples(&samples, 0.01, camera.shutter()).unwrap();
        assert!(motion.centroid_mm.abs() < 1e-5 && motion.travel_mm.abs() < 1e-5);
        camera.frame_of(&exposure, &motion)
    };
    // The deviation of a triangle is its height by √3.
    assert!(frame(3.4).is_ok());
    let Err(FrameError::OutOfRange(error)) = frame(3.5) else {
        panic!("beyond 2 mm");
    };
    assert_eq!(error.quantity, Quantity::TravelMm);
    assert!(
        (error.value - 3.5 / libm::sqrtf(3.0)).abs() < 1e-4,
        "{error}"
    );
}
