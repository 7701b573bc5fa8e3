//! Models of the frames of a flight: a focus shift that is told, and the fitted model.

use fmc_camera::flight::camera::{Camera, CameraParameters, FrameError};
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera::flight::frame_record::{ExposedFrame, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::geometry::five_coefficient::FiveCoefficients;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{Answer, Points, Refusal, Request, ResetCause};

use crate::link::in_flight::Flight;
use crate::link::pc::camera_parameters;

/// The camera of the tests with run-out of its stage, and with a fitted model.
fn fitted() -> CameraParameters {
    let mut camera = camera_parameters();
    camera.calibration.flatness.coefficients_um = [0.0, 1.5, 0.0, 0.0, 0.0];
    camera.calibration.fitted = Some(FiveCoefficients {
        km0: 1e-5,
        km1: 1e-8,
        ..FiveCoefficients::default()
    });
    camera
}

fn armed(camera: &CameraParameters, settings: &FlightSettings) -> Flight {
    let mut flight = Flight::loaded();
    assert!(matches!(flight.pc.load(camera), Answer::Loaded(_)));
    let prepared = flight.pc.ask(&Request::Prepare(*settings));
    assert_eq!(prepared, Answer::Prepared);
    flight.arm();
    flight
}

fn tell(flight: &mut Flight, shift_um: f32) {
    flight.round(Some(Event::Command(Command::FocusShift(shift_um))));
}

fn exposed(flight: &mut Flight) -> ExposedFrame {
    flight.expose();
    match flight.records().last().unwrap().outcome {
        Outcome::Exposed(frame) => frame,
        Outcome::Refused(reason) => panic!("{reason}"),
    }
}

/// Corrects a point of the last frame by the camera, and by this PC from its record.
fn corrected_by_both(
    flight: &mut Flight,
    camera: &CameraParameters,
    frame: &ExposedFrame,
    focus_shift_um: f32,
) {
    let flown = flight.pc.ask(&Request::Flown);
    assert!(matches!(flown, Answer::Flown(..)), "{flown:?}");
    let measured = fmc_camera::geometry::sensor::SensorPoint::new(20.0, -15.0);
    let points: Points = [measured].into_iter().collect();
    let Answer::Points(points) = flight.pc.ask(&Request::Correct(points)) else {
        panic!("not corrected");
    };
    let exposure = Exposure {
        focus_shift_um,
        model: frame.interior.model,
        ..Exposure::new(frame.interior.vh_per_s, frame.interior.exposure_s)
    };
    let camera = Camera::new(*camera).unwrap();
    let here = camera.frame_of(&exposure, &frame.interior.motion).unwrap();
    assert_eq!(here.interior, frame.interior);
    assert_eq!(points[0], here.correction.correct(measured));
}

#[test]
fn focus_shift_that_is_told_is_in_the_frames_after_it_with_the_run_out() {
    let camera = fitted();
    let mut flight = armed(&camera, &FlightSettings::default());
    let plain = exposed(&mut flight);
    let run_out_mm = 1.5e-3 * plain.interior.motion.centroid_mm;
    assert!((plain.interior.focus_shift_mm - run_out_mm).abs() < 1e-8);
    tell(&mut flight, 25.0);
    for _ in 0..2 {
        let frame = exposed(&mut flight);
        let shift_mm = frame.interior.focus_shift_mm;
        let expected_mm = 0.025 + 1.5e-3 * frame.interior.motion.centroid_mm;
        assert!((shift_mm - expected_mm).abs() < 1e-8, "{shift_mm}");
        // κ = Δz/L, and by so much is the image larger.
        let exit_pupil_mm = camera.calibration.exit_pupil_mm;
        assert!((frame.interior.enlargement - shift_mm / exit_pupil_mm).abs() < 1e-9);
        corrected_by_both(&mut flight, &camera, &frame, 25.0);
    }
    // A frame in flight has the one of its trigger.
    flight.round(Some(Event::Trigger));
    tell(&mut flight, 0.0);
    flight.run_until(State::Armed);
    let Outcome::Exposed(frame) = flight.records().last().unwrap().outcome else {
        panic!("not exposed");
    };
    assert!((frame.interior.focus_shift_mm - 0.025).abs() < 1e-4);
    assert!(exposed(&mut flight).interior.focus_shift_mm.abs() < 1e-4);
}

#[test]
fn focus_shift_beyond_the_model_is_refused_with_its_trigger_and_at_an_exchange() {
    let camera = fitted();
    let mut flight = armed(&camera, &FlightSettings::default());
    // A hundredth of the principal distance, less the run-out in the stroke.
    let parameters = camera.calibration;
    let run_out_um = 1.5 * 0.5 * parameters.stroke_mm;
    let most_um = 10.0 * parameters.principal_distance_mm - run_out_um;
    for beyond_um in [most_um + 0.1, -most_um - 0.1, f32::NAN, f32::INFINITY] {
        tell(&mut flight, beyond_um);
        flight.round(Some(Event::Trigger));
        let refused = flight.records().last().unwrap().outcome;
        let expected = Outcome::Refused(Reason::OutsideLimits);
        assert_eq!(refused, expected, "{beyond_um} µm");
    }
    for within_um in [most_um - 0.1, 0.1 - most_um] {
        tell(&mut flight, within_um);
        let shift_mm = exposed(&mut flight).interior.focus_shift_mm;
        assert!((shift_mm - 1e-3 * within_um).abs() < 1e-4, "{shift_mm}");
    }
    flight.round(Some(Event::Command(Command::Disarm)));
    let mut shorter = camera;
    shorter.calibration.principal_distance_mm = 45.0;
    shorter.calibration.exit_pupil_mm = 45.0;
    let refused = flight.pc.exchange(&shorter);
    assert!(
        matches!(
            refused,
            Answer::Refused(Refusal::Travel(FrameError::OutOfRange(_)))
        ),
        "{refused:?}"
    );
    tell(&mut flight, 0.0);
    assert!(matches!(flight.pc.exchange(&shorter), Answer::Loaded(_)));
}

#[test]
fn focus_shift_outlives_a_reset_and_ends_with_the_flight() {
    let memory: &'static FlightMemory = Box::leak(Box::new(FlightMemory::blank()));
    let mut flight = Flight::after_reset(ResetCause::PowerOn, memory);
    assert!(matches!(flight.pc.load(&fitted()), Answer::Loaded(_)));
    assert_eq!(flight.prepare(), Answer::Prepared);
    tell(&mut flight, 25.0);
    let mut flight = Flight::after_reset(ResetCause::Requested, memory);
    flight.arm();
    let shift_mm = exposed(&mut flight).interior.focus_shift_mm;
    assert!((shift_mm - 0.025).abs() < 1e-4, "{shift_mm}");
    flight.round(Some(Event::Command(Command::Disarm)));
    assert_eq!(flight.pc.acknowledge(1), Answer::Kept(0));
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    assert!(exposed(&mut flight).interior.focus_shift_mm.abs() < 1e-4);
}

#[test]
fn flight_by_the_fitted_model_says_so_and_corrects_by_it() {
    let camera = fitted();
    let settings = FlightSettings {
        fitted_model: true,
        ..FlightSettings::default()
    };
    let mut flight = armed(&camera, &settings);
    let frame = exposed(&mut flight);
    assert_eq!(frame.interior.model, CorrectionModel::Fitted);
    assert!(frame.interior.enlargement.abs() < f32::MIN_POSITIVE);
    corrected_by_both(&mut flight, &camera, &frame, 0.0);
    // A camera that has none is none for this flight.
    flight.round(Some(Event::Command(Command::Disarm)));
    let not_fitted = Answer::Refused(Refusal::Travel(FrameError::NotFitted));
    assert_eq!(flight.pc.exchange(&camera_parameters()), not_fitted);
    let mut other = Flight::loaded();
    assert_eq!(other.pc.ask(&Request::Prepare(settings)), not_fitted);
    // Without the setting the calibration corrects, also of a camera that has one.
    let mut exact = armed(&camera, &FlightSettings::default());
    assert_eq!(exposed(&mut exact).interior.model, CorrectionModel::Exact);
}
