//! Numbers that are none, and stages that nothing is asked of.

use super::*;
use crate::flight::camera::Mechanism;
use crate::flight::controller::state::State;
use crate::flight::controller::{Actions, Controller, Start};
use crate::flight::event::Action;
use crate::flight::prepared_camera::PreparedCamera;
use crate::flight::settings::FlightSettings;
use crate::{CalibrationParameters, Camera, CameraParameters};

const NOW: Time = Time::from_us(1_000_000);

fn camera() -> CameraParameters {
    CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75))
}

fn prepared(camera: &CameraParameters, settings: &FlightSettings) -> PreparedCamera {
    let camera = Camera::new(*camera).unwrap();
    PreparedCamera::new(camera, settings, Start::Orderly).unwrap()
}

fn with_mark() -> FlightSettings {
    let mut settings = FlightSettings::default();
    settings.drive.index_mm = Some(0.0);
    settings
}

#[test]
fn stage_is_not_sent_from_or_to_a_place_that_is_no_number_or_outside_the_stroke() {
    let mut camera = prepared(&camera(), &FlightSettings::default());
    let (setup, controller) = camera.flown();
    for place_mm in [f32::NAN, f32::INFINITY, 2.001, -2.001] {
        assert!(!controller.stage.go_to(&setup, NOW, place_mm));
        assert!(controller.stage.is_released(), "{place_mm}");
    }
    controller.stage.read_mm = Some(f32::NAN);
    assert!(!controller.stage.go_to(&setup, NOW, 0.0));
    assert!(controller.stage.is_released());
    controller.stage.read_mm = Some(0.5);
    assert!(controller.stage.go_to(&setup, NOW, 0.0));
    let place_mm = controller.stage.place_mm(NOW);
    assert!((place_mm - 0.5).abs() < 1e-6, "{place_mm}");
}

#[test]
fn camera_whose_last_reading_is_no_number_does_not_move_its_stage_and_reports_the_encoder() {
    let mut camera = prepared(&camera(), &FlightSettings::default());
    let (setup, controller) = camera.flown();
    controller.stage.read_mm = Some(f32::NAN);
    let mut actions = Actions::new();
    controller.resume(&setup, NOW, &mut actions);
    assert_eq!(actions, [Action::Fault(Fault::Encoder)]);
    assert!(controller.stage.is_released() && controller.is_place_lost());
}

#[test]
fn stage_whose_next_place_is_no_number_is_released_with_a_fault_of_the_drive() {
    let mut camera = prepared(&camera(), &FlightSettings::default());
    let (setup, controller) = camera.flown();
    let mut actions = Actions::new();
    controller.resume(&setup, NOW, &mut actions);
    assert!(!controller.stage.is_released());
    controller.stage.approached_mm = Some(f32::NAN);
    controller.go_back(&setup, NOW, &mut actions);
    assert_eq!(actions, [Action::Fault(Fault::Drive), Action::ReleaseStage]);
    assert_eq!(controller.state(), State::Fault(Fault::Drive));
}

#[test]
fn second_look_asks_nothing_of_rows_and_of_a_stage_whose_place_is_lost() {
    let mechanism = Mechanism::Tdi {
        first_transfer: 0.5,
    };
    let rows = CameraParameters {
        mechanism,
        ..camera()
    };
    let mut rows = prepared(&rows, &FlightSettings::default());
    let (setup, controller) = rows.flown();
    assert!(controller.stage.moves_as_set(&setup, NOW, 0.01));
    let mut staged = prepared(&camera(), &FlightSettings::default());
    let (setup, controller) = staged.flown();
    assert!(!controller.stage.moves_as_set(&setup, NOW, 0.01));
    controller.stage.fail(Fault::Encoder);
    assert!(controller.stage.moves_as_set(&setup, NOW, 0.01));
}

/// Notes a crossing of the mark at a place, with readings about it that move on by a step a round.
fn cross(controller: &mut Controller, is_along: bool, step_mm: f32, place_mm: f32) {
    controller.stage.track.clear();
    let mut time = NOW;
    for round in 0..5_u8 {
        time = time.plus_s(1e-3);
        controller.stage.track.push(StagePlace {
            time,
            offset_mm: (f32::from(round) - 3.5) * step_mm,
            reading: PlaceReading::of_round(0.0),
        });
    }
    controller.stage.latched_index = Some(LatchedIndex {
        // The reading is 0.1 ms old.
        reading_mm: place_mm - 0.1 * step_mm,
        next_sequence: 1,
        is_along,
    });
}

#[test]
fn crossing_counts_if_the_readings_about_it_move_as_the_stage_was_told() {
    for (is_along, step_mm, counts) in [
        (true, 0.01, true),
        (true, -0.01, false),
        (true, 0.0, false),
        (false, 0.01, false),
        (false, 0.0, false),
        (false, -0.01, true),
    ] {
        let mut camera = prepared(&camera(), &with_mark());
        let (setup, controller) = camera.flown();
        // A crossing along the axis, with which one against it makes a pair.
        cross(controller, true, 0.01, 0.0);
        controller.judge_index(&setup, &mut Actions::new());
        assert!(controller.stage.index.is_found());
        let before = (
            controller.stage.index.last_mm(),
            controller.stage.play_watch,
        );
        cross(controller, is_along, step_mm, 5e-5);
        let mut actions = Actions::new();
        controller.judge_index(&setup, &mut actions);
        assert!(actions.is_empty() && controller.stage.latched_index.is_none());
        let after = (
            controller.stage.index.last_mm(),
            controller.stage.play_watch,
        );
        assert_eq!(before != after, counts, "{is_along}, {step_mm} mm");
    }
}
