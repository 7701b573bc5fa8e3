//! Focus over temperature in flight: the table of the calibration, and temperatures that are told.

use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::geometry::focus_table::{FocusRow, FocusTable};
use fmc_camera::geometry::grid::GridChecksums;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::loading::{Upload, parameters};
use fmc_camera::io::link::message::{Answer, Refusal, Request, ResetCause};

use crate::link::in_flight::Flight;
use crate::link::pc::camera_parameters;

fn row(temperature_c: f32, focus_shift_um: f32) -> FocusRow {
    FocusRow {
        temperature_c,
        focus_shift_um,
    }
}

fn with_rows(rows: &[FocusRow]) -> CameraParameters {
    CameraParameters {
        focus: FocusTable::new(rows).unwrap(),
        ..camera_parameters()
    }
}

fn with_table() -> CameraParameters {
    with_rows(&[row(-20.0, -40.0), row(0.0, -10.0), row(40.0, 30.0)])
}

fn armed(camera: &CameraParameters) -> Flight {
    let mut flight = Flight::loaded();
    assert!(matches!(flight.pc.load(camera), Answer::Loaded(_)));
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    flight
}

fn command(flight: &mut Flight, command: Command) {
    flight.round(Some(Event::Command(command)));
}

fn last(flight: &mut Flight) -> (FrameRecord, ExposedFrame) {
    let record = *flight.records().last().unwrap();
    match record.outcome {
        Outcome::Exposed(frame) => (record, frame),
        Outcome::Refused(reason) => panic!("{reason}"),
    }
}

/// Exposes, and returns Δz of the record, µm, with its flags of the temperature.
fn exposed(flight: &mut Flight) -> (f32, Vec<Flag>) {
    flight.expose();
    let (record, frame) = last(flight);
    let of_temperature = [Flag::TemperatureOutside, Flag::TemperatureUnknown];
    let flags = record.flags.iter();
    let flags = flags.filter(|flag| of_temperature.contains(flag));
    (1000.0 * frame.interior.focus_shift_mm, flags.collect())
}

fn is_at(found: &(f32, Vec<Flag>), shift_um: f32, flags: &[Flag]) -> bool {
    (found.0 - shift_um).abs() < 1e-3 && found.1 == flags
}

#[test]
fn shift_by_the_table_is_in_frames_after_the_temperature_and_focus_shift_adds_to_it() {
    let mut flight = armed(&with_table());
    let found = exposed(&mut flight);
    assert!(is_at(&found, 0.0, &[Flag::TemperatureUnknown]), "{found:?}");
    for (celsius, shift_um) in [(-10.0, -25.0), (0.0, -10.0), (10.0, 0.0), (40.0, 30.0)] {
        command(&mut flight, Command::Temperature(celsius));
        let found = exposed(&mut flight);
        assert!(is_at(&found, shift_um, &[]), "{celsius} °C: {found:?}");
        let (_, frame) = last(&mut flight);
        let enlargement = 1e-3 * shift_um / with_table().calibration.exit_pupil_mm;
        assert!((frame.interior.enlargement - enlargement).abs() < 1e-8);
    }
    command(&mut flight, Command::FocusShift(5.0));
    let found = exposed(&mut flight);
    assert!(is_at(&found, 35.0, &[]), "{found:?}");
    for (celsius, shift_um) in [(-30.0, -35.0), (60.0, 35.0)] {
        command(&mut flight, Command::Temperature(celsius));
        let found = exposed(&mut flight);
        assert!(
            is_at(&found, shift_um, &[Flag::TemperatureOutside]),
            "{found:?}"
        );
    }
    // A frame in flight has the temperature of its trigger.
    command(&mut flight, Command::Temperature(40.0));
    flight.round(Some(Event::Trigger));
    command(&mut flight, Command::Temperature(0.0));
    flight.run_until(State::Armed);
    let (_, frame) = last(&mut flight);
    assert!((frame.interior.focus_shift_mm - 0.035).abs() < 1e-6);
}

#[test]
fn camera_without_a_table_takes_temperatures_and_has_neither_shift_nor_flag() {
    let mut flight = armed(&camera_parameters());
    assert!(is_at(&exposed(&mut flight), 0.0, &[]));
    command(&mut flight, Command::Temperature(35.0));
    assert!(is_at(&exposed(&mut flight), 0.0, &[]));
}

#[test]
fn table_and_shift_that_lead_too_far_together_are_refused_with_their_triggers() {
    let camera = with_table();
    let mut flight = armed(&camera);
    let most_um = 10.0 * camera.calibration.principal_distance_mm;
    command(&mut flight, Command::FocusShift(most_um - 20.0));
    command(&mut flight, Command::Temperature(10.0));
    assert!(is_at(&exposed(&mut flight), most_um - 20.0, &[]));
    command(&mut flight, Command::Temperature(40.0));
    flight.round(Some(Event::Trigger));
    let refused = flight.records().last().unwrap().outcome;
    assert_eq!(refused, Outcome::Refused(Reason::OutsideLimits));
}

#[test]
fn temperature_outlives_a_reset_but_not_its_age_and_ends_with_the_flight() {
    let memory: &'static FlightMemory = Box::leak(Box::new(FlightMemory::blank()));
    let mut flight = Flight::after_reset(ResetCause::PowerOn, memory);
    // A volatile calibration comes back with its table.
    let Answer::Loaded(before) = flight.pc.load(&with_table()) else {
        panic!("not loaded");
    };
    assert_eq!(flight.prepare(), Answer::Prepared);
    command(&mut flight, Command::Temperature(20.0));
    let mut flight = Flight::after_reset(ResetCause::Requested, memory);
    assert_eq!(flight.status().calibration, Some(before));
    flight.arm();
    let found = exposed(&mut flight);
    assert!(
        is_at(&found, 10.0, &[Flag::TemperatureUnknown]),
        "{found:?}"
    );
    command(&mut flight, Command::Temperature(20.0));
    assert!(is_at(&exposed(&mut flight), 10.0, &[]));
    command(&mut flight, Command::Disarm);
    assert_eq!(flight.pc.acknowledge(2), Answer::Kept(0));
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    let found = exposed(&mut flight);
    assert!(is_at(&found, 0.0, &[Flag::TemperatureUnknown]), "{found:?}");
}

#[test]
fn table_is_refused_when_it_is_loaded_by_what_is_wrong_with_it() {
    let most_um = 10.0 * camera_parameters().calibration.principal_distance_mm;
    let good = row(20.0, 0.0);
    let mut flight = Flight::loaded();
    for (rows, quantity, value) in [
        (vec![good, row(20.0, 1.0)], Quantity::TemperatureC, 20.0),
        (vec![good, row(10.0, 1.0)], Quantity::TemperatureC, 10.0),
        (vec![good, row(1000.0, 1.0)], Quantity::TemperatureC, 1000.0),
        (
            vec![row(-1000.0, 1.0), good],
            Quantity::TemperatureC,
            -1000.0,
        ),
        (
            vec![good, row(30.0, most_um + 1.0)],
            Quantity::FocusShiftUm,
            most_um + 1.0,
        ),
        (
            vec![row(0.0, -most_um - 1.0), good],
            Quantity::FocusShiftUm,
            -most_um - 1.0,
        ),
    ] {
        let camera = with_rows(&rows);
        let Answer::Refused(Refusal::Calibration(CalibrationError::OutOfRange(range))) =
            flight.pc.load(&camera)
        else {
            panic!("{rows:?}");
        };
        assert_eq!((range.quantity, range.value), (quantity, value), "{range}");
        assert_eq!(
            Camera::new(camera),
            Err(CalibrationError::OutOfRange(range))
        );
    }
    for not_a_number in [
        vec![good, row(f32::NAN, 0.0)],
        vec![good, row(30.0, f32::NAN)],
    ] {
        let refused = flight.pc.load(&with_rows(&not_a_number));
        assert!(matches!(
            refused,
            Answer::Refused(Refusal::Calibration(CalibrationError::OutOfRange(_)))
        ));
    }
    // With run-out of the stage there is less room.
    let mut camera = with_rows(&[good, row(30.0, most_um - 1.0)]);
    assert!(Camera::new(camera).is_ok());
    camera.calibration.flatness.coefficients_um[0] = 2.0;
    assert!(Camera::new(camera).is_err());
}

#[test]
fn bytes_of_a_table_are_those_of_one_camera_and_of_no_other_length() {
    let camera = with_table();
    let upload = Upload::of(&camera).unwrap();
    assert_eq!(parameters(upload.bytes()), Some(camera));
    let plain = Upload::of(&camera_parameters()).unwrap();
    // Behind the fields: no grids, three rows of 8 bytes and their number.
    assert_eq!(upload.bytes()[..plain.bytes().len()], *plain.bytes());
    assert_eq!(upload.bytes().len(), plain.bytes().len() + 2 + 1 + 24);
    assert_ne!(upload.crc(), plain.crc());
    for cut in plain.bytes().len() + 1..upload.bytes().len() {
        assert_eq!(parameters(&upload.bytes()[..cut]), None, "{cut}");
    }
    let more = [upload.bytes(), &[0]].concat();
    assert_eq!(parameters(&more), None);
    // An empty table, and more rows than there may be.
    let behind = |bytes: &[u8]| parameters(&[plain.bytes(), bytes].concat());
    assert_eq!(behind(&[0, 0]), None);
    assert_eq!(behind(&[0, 0, 0]), None);
    assert_eq!(
        behind(&[[0, 0, 17].as_slice(), &[0; 17 * 8]].concat()),
        None
    );
    // One row is no table, which the camera refuses by name.
    let one = behind(&[[0, 0, 1].as_slice(), &[0; 8]].concat()).unwrap();
    let Err(CalibrationError::OutOfRange(range)) = Camera::new(one) else {
        panic!("one row");
    };
    assert_eq!(
        (range.quantity, range.value),
        (Quantity::FocusTableRows, 1.0)
    );
    let both = CameraParameters {
        grids: GridChecksums {
            lens: Some(7),
            sensor: None,
        },
        ..camera
    };
    assert_eq!(parameters(Upload::of(&both).unwrap().bytes()), Some(both));
}

#[test]
fn exchange_checks_the_table_of_the_next_calibration_at_the_present_temperature() {
    let most_um = 10.0 * camera_parameters().calibration.principal_distance_mm;
    let mut flight = armed(&camera_parameters());
    command(&mut flight, Command::FocusShift(most_um - 20.0));
    command(&mut flight, Command::Temperature(40.0));
    command(&mut flight, Command::Disarm);
    // 30 µm of the table besides.
    let refused = flight.pc.exchange(&with_table());
    assert!(
        matches!(refused, Answer::Refused(Refusal::Travel(_))),
        "{refused:?}"
    );
    command(&mut flight, Command::FocusShift(0.0));
    let exchanged = flight.pc.exchange(&with_table());
    assert!(matches!(exchanged, Answer::Loaded(_)), "{exchanged:?}");
    // A settings' check of the camera needs no temperature.
    let mut other = Flight::loaded();
    assert!(matches!(other.pc.load(&with_table()), Answer::Loaded(_)));
    let prepare = Request::Prepare(FlightSettings::default());
    assert_eq!(other.pc.ask(&prepare), Answer::Prepared);
}
