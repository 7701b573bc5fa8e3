//! Calibrations that take the place of another between two frames of a flight.

use fmc_camera::flight::calibration_id::CalibrationId;
use fmc_camera::flight::camera::{CameraParameters, FrameError, Mechanism};
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::flown_calibrations::EARLIER_CALIBRATIONS;
use fmc_camera::flight::frame_record::{FrameRecord, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::io::link::after_reset::FlightAfterReset;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::loading::Upload;
use fmc_camera::io::link::message::{Answer, Refusal, Request, ResetCause};

use crate::link::in_flight::{Flight, utc_less_time_us};
use crate::link::pc::camera_parameters;

/// Another calibration of the camera of [`Flight::loaded`].
fn other(principal_distance_mm: f32) -> CameraParameters {
    let mut camera = camera_parameters();
    camera.calibration.principal_distance_mm = principal_distance_mm;
    camera
}

fn loaded(answer: Answer) -> CalibrationId {
    match answer {
        Answer::Loaded(id) => id,
        other => panic!("{other:?}"),
    }
}

fn armed() -> Flight {
    let mut flight = Flight::loaded();
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    flight
}

fn disarm(flight: &mut Flight) {
    flight.round(Some(Event::Command(Command::Disarm)));
    assert_eq!(flight.status().state, State::Standby);
}

/// Arms a camera that is in standby, without another V/H.
fn arm_again(flight: &mut Flight) {
    flight.round(Some(Event::Command(Command::Arm)));
    for _ in 0..3000 {
        if flight.round(None).state == State::Armed {
            return;
        }
    }
    panic!("never armed");
}

/// Principal distance and travel of an exposure, mm, which are those of one calibration.
fn exposed(record: &FrameRecord) -> (f32, f32) {
    match record.outcome {
        Outcome::Exposed(frame) => (
            frame.interior.principal_distance_mm,
            frame.interior.motion.travel_mm,
        ),
        Outcome::Refused(_) => panic!("{record:?}"),
    }
}

#[test]
fn flight_goes_on_with_another_calibration_and_loses_nothing() {
    let mut flight = armed();
    flight.know_utc();
    flight.expose();
    disarm(&mut flight);
    let before = flight.status();
    let [first] = flight.records()[..] else {
        panic!("one record");
    };
    let second = loaded(flight.pc.exchange(&other(60.0)));
    assert_ne!(Some(second), before.calibration);
    let mut after = flight.status();
    assert_eq!(after.calibration, Some(second));
    after.calibration = before.calibration;
    assert_eq!(after, before);
    assert_eq!(flight.records(), [first]);
    // The points of the last frame would be corrected with what the next camera has beside it.
    let no_frame = Answer::Refused(Refusal::NoFrame);
    assert_eq!(flight.pc.ask(&Request::Flown), no_frame);

    arm_again(&mut flight);
    flight.round(Some(Event::Trigger));
    while flight.round(None).state != State::Armed {}
    let [unchanged, next] = flight.records()[..] else {
        panic!("two records");
    };
    assert_eq!(unchanged, first);
    assert_eq!((next.sequence, next.calibration), (2, Some(second)));
    let ((f_mm, travel_mm), (next_f_mm, next_travel_mm)) = (exposed(&first), exposed(&next));
    assert_eq!((f_mm, next_f_mm), (51.3712, 60.0));
    // The stage follows the image of the other lens, to within the rig's steps of 0.1 µm.
    let off_mm = next_travel_mm - travel_mm * 60.0 / 51.3712;
    assert!(off_mm.abs() < 2.2e-4 && next_travel_mm > travel_mm + 2e-3);
    // No pulse, no time and no V/H has come since.
    let off_us = [first, next].map(|record| utc_less_time_us(&record).unwrap());
    assert!(off_us[0].abs_diff(off_us[1]) <= 1, "{off_us:?}");
    assert_eq!(flight.status().counts.triggers, 2);
    // Records that were fetched before the exchange are acknowledged after it.
    assert_eq!(flight.pc.acknowledge(1), Answer::Kept(1));
    assert_eq!(flight.pc.acknowledge(2), Answer::Kept(0));
}

#[test]
fn frame_in_flight_is_of_one_calibration_whenever_another_comes() {
    let undisturbed = {
        let mut flight = armed();
        flight.expose();
        flight.records()
    };
    let mut flight = armed();
    let upload = Upload::of(&other(60.0)).unwrap();
    let requests: Vec<_> = upload.requests_in_flight().collect();
    disarm(&mut flight);
    let (last, others) = requests.split_last().unwrap();
    for request in others {
        assert!(matches!(flight.pc.ask(request), Answer::Loading(_)));
    }
    let mut flight_of_two = flight;
    let mut flight = armed();
    let refused = Answer::Refused(Refusal::FrameInFlight);
    let (mut rounds, mut states) = (0, Vec::new());
    let mut event = Some(Event::Trigger);
    loop {
        let state = flight.round(event.take()).state;
        states.push(state);
        states.dedup();
        rounds += 1;
        assert_eq!(flight.pc.exchange(&other(60.0)), refused, "{state}");
        if state == State::Armed {
            break;
        }
    }
    let cycle = [
        State::RunUp,
        State::Tracking,
        State::Exposing,
        State::FlyBack,
        State::Armed,
    ];
    assert!(
        rounds > 50 && states == cycle,
        "{rounds} rounds, {states:?}"
    );
    assert_eq!(flight.records(), undisturbed);

    // So it is with a last part that was left from before the camera was armed. It waits.
    arm_again_with_vh(&mut flight_of_two);
    let mut event = Some(Event::Trigger);
    loop {
        let state = flight_of_two.round(event.take()).state;
        assert_eq!(flight_of_two.pc.ask(last), refused, "{state}");
        if state == State::Armed {
            break;
        }
    }
    disarm(&mut flight_of_two);
    let second = loaded(flight_of_two.pc.ask(last));
    let [record] = flight_of_two.records()[..] else {
        panic!("one record");
    };
    assert_eq!(record.calibration, undisturbed[0].calibration);
    assert_eq!(exposed(&record), exposed(&undisturbed[0]));
    assert_eq!(flight_of_two.status().calibration, Some(second));
}

fn arm_again_with_vh(flight: &mut Flight) {
    flight.round(Some(Event::Command(Command::Arm)));
    flight.run_until(State::Armed);
}

#[test]
fn camera_that_does_not_fit_the_flight_is_refused_by_name_and_the_one_before_flies_on() {
    let mut flight = Flight::loaded();
    let settings = FlightSettings {
        trigger_interval_s: 0.3,
        ..FlightSettings::default()
    };
    let prepared = flight.pc.ask(&Request::Prepare(settings));
    assert_eq!(prepared, Answer::Prepared);
    let before = flight.status();
    let mut slow = camera_parameters();
    slow.mechanism = Mechanism::Stage {
        acceleration_mm_s2: 100.0,
        settling_ms: 5.0,
        run_up: fmc_camera::flight::stage::RunUp::Centred,
        jerk_mm_s3: None,
        max_speed_mm_s: None,
    };
    let mut rows = camera_parameters();
    rows.mechanism = Mechanism::Tdi {
        first_transfer: 1.0,
    };
    let mut brief = camera_parameters();
    brief.limits.exposure_s = [1e-4, 1e-3];
    let mut folding = camera_parameters();
    folding.calibration.distortion.k1 = 1e-3;
    let mut refusal = |camera: &CameraParameters| {
        let Answer::Refused(refusal) = flight.pc.exchange(camera) else {
            panic!("taken");
        };
        assert_eq!(flight.status(), before);
        let exposed = flight.pc.ask(&Request::Expose(Exposure::new(0.1, 0.005)));
        let Answer::InteriorOrientation(interior) = exposed else {
            panic!("{exposed:?}");
        };
        assert!((interior.principal_distance_mm - 51.3712).abs() < 1e-6);
        refusal
    };
    assert_eq!(refusal(&rows), Refusal::OtherMechanism);
    let Refusal::Travel(FrameError::OutOfRange(found)) = refusal(&brief) else {
        panic!("another refusal");
    };
    assert_eq!((found.quantity, found.max), (Quantity::ExposureS, 1e-3));
    let time = refusal(&slow);
    assert!(
        matches!(time, Refusal::Travel(FrameError::Time { .. })),
        "{time:?}"
    );
    let folds = refusal(&folding);
    assert!(
        matches!(folds, Refusal::Calibration(CalibrationError::Folds { .. })),
        "{folds:?}"
    );
    // The exposure time that was commanded in flight counts, too.
    let mut long = camera_parameters();
    long.limits.exposure_s = [0.003, 0.1];
    loaded(flight.pc.exchange(&long));
    loaded(flight.pc.exchange(&camera_parameters()));
    for command in [Command::ClearFault, Command::Exposure(0.002)] {
        flight.round(Some(Event::Command(command)));
    }
    let Answer::Refused(Refusal::Travel(FrameError::OutOfRange(found))) = flight.pc.exchange(&long)
    else {
        panic!("taken");
    };
    assert_eq!((found.value, found.min), (0.002, 0.003));
    assert_eq!(flight.status().calibration, before.calibration);
    // For another flight each is loaded.
    loaded(flight.pc.load(&rows));
    let not_prepared = Answer::Refused(Refusal::NotPrepared);
    assert_eq!(flight.pc.ask(&Request::Status), not_prepared);
}

#[test]
fn limits_of_the_next_calibration_hold_for_the_triggers_after_it() {
    let mut flight = armed();
    flight.expose();
    disarm(&mut flight);
    let mut narrow = camera_parameters();
    narrow.limits.vh_per_s = [0.01, 0.05];
    loaded(flight.pc.exchange(&narrow));
    arm_again(&mut flight);
    // V/H is 0.1 1/s, as before.
    flight.round(Some(Event::Trigger));
    let refused = flight.records()[1];
    assert_eq!(refused.outcome, Outcome::Refused(Reason::OutsideLimits));
}

#[test]
fn records_of_more_calibrations_than_are_remembered_have_to_be_acknowledged_first() {
    let mut flight = Flight::loaded();
    assert_eq!(flight.prepare(), Answer::Prepared);
    let mut made_with = vec![flight.status().calibration.unwrap()];
    let exchanges: [f32; EARLIER_CALIBRATIONS] = [52.0, 53.0, 54.0];
    for principal_distance_mm in exchanges {
        // Refused in standby: the record names its calibration all the same.
        flight.round(Some(Event::Trigger));
        let next = loaded(flight.pc.exchange(&other(principal_distance_mm)));
        made_with.push(next);
    }
    flight.round(Some(Event::Trigger));
    let all = |flight: &mut Flight| flight.records().into_iter().map(|it| it.calibration);
    let expected: Vec<_> = made_with.iter().copied().map(Some).collect();
    assert!(all(&mut flight).eq(expected.clone()));
    let refused = Answer::Refused(Refusal::RecordsKept(4));
    assert_eq!(flight.pc.exchange(&other(55.0)), refused);
    assert_eq!(flight.pc.acknowledge(1), Answer::Kept(3));
    loaded(flight.pc.exchange(&other(55.0)));
    assert!(all(&mut flight).eq(expected[1..].iter().copied()));
}

#[test]
fn calibration_of_the_exchange_is_that_after_a_reset_and_each_record_keeps_its_own() {
    for is_armed in [false, true] {
        let memory: &'static FlightMemory = Box::leak(Box::new(FlightMemory::blank()));
        let mut flight = Flight::after_reset(ResetCause::PowerOn, memory);
        let first = loaded(flight.pc.load(&camera_parameters()));
        assert_eq!(flight.prepare(), Answer::Prepared);
        flight.arm();
        flight.expose();
        disarm(&mut flight);
        let second = loaded(flight.pc.exchange(&other(60.0)));
        if is_armed {
            arm_again_with_vh(&mut flight);
            flight.expose();
        }
        let before = flight.records();
        for cause in [ResetCause::Watchdog, ResetCause::Requested] {
            let words = Box::new(FlightMemory::of_words(memory.words()));
            let mut flight = Flight::after_reset(cause, Box::leak(words));
            let outcome = if is_armed {
                FlightAfterReset::FliesOn
            } else {
                FlightAfterReset::StandsBy
            };
            assert_eq!(flight.after_reset.outcome, outcome);
            assert_eq!(flight.status().calibration, Some(second));
            assert_eq!(flight.records(), before);
            assert_eq!(before[0].calibration, Some(first));
            flight.round(Some(Event::Trigger));
            let next = *flight.records().last().unwrap();
            assert_eq!(next.calibration, Some(second));
        }
    }
}
