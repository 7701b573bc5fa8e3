//! Frames without faults.

use fmc_camera::flight::camera::Mechanism;
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::settings::{DriveSettings, EncoderSide};
use fmc_camera::flight::event::{Action, Event};
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::fault::Faults;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, Flags, Outcome};
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::smear_prediction::COVERAGE;
use fmc_camera::flight::time::Time;

use crate::controller::bench::{Bench, camera, identified, settings};

#[test]
fn trigger_leads_through_all_states_to_a_measured_record() {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    let mut spread = 0.0;
    let mut states = vec![bench.camera.controller().state()];
    for _ in 0..200 {
        if bench.camera.controller().state() == State::Exposing {
            spread = bench.camera.controller().vh().relative_variance();
        }
        bench.round();
        if states.last() != Some(&bench.camera.controller().state()) {
            states.push(bench.camera.controller().state());
        }
    }
    assert_eq!(
        states,
        [
            State::RunUp,
            State::Tracking,
            State::Exposing,
            State::FlyBack,
            State::Armed
        ]
    );
    let [record] = bench.records()[..] else {
        panic!("one record");
    };
    assert_eq!((record.sequence, record.faults), (1, Faults::NONE));
    assert_eq!(record.flags, Flags::NONE);
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    // 10 mm/s for 1/300 s, centred: 33.3 µm about the calibrated principal point.
    let motion = frame.interior.motion;
    assert!((motion.travel_mm - 0.0333).abs() < 2e-4, "{motion:?}");
    assert!(motion.centroid_mm.abs() < 2e-5, "{motion:?}");
    // σ of V/H given directly, which repeats itself: 0.0005 1/s, and 0.003 1/s per √s for the
    // latency of 0.1 s and the 0.019 s from trigger to centroid.
    let vh = frame.vh.unwrap();
    assert!((vh.age_s - 0.119).abs() < 0.002, "{vh:?}");
    assert!((vh.sigma_per_s - 0.00115).abs() < 1e-5, "{vh:?}");
    // With the spread of V/H over the track, 0.5 ° of attitude and 0.02 °/s about three axes, in
    // parts of V/H; R²/f² = 0.3251.
    let (corner, angle) = (1.3251, 0.5_f32.to_radians());
    let rate = corner * 0.02_f32.to_radians() / 0.1;
    let relative = vh.sigma_per_s / 0.1;
    let elsewhere = spread + angle * angle;
    let variance = relative * relative + corner * elsewhere + 3.0 * rate * rate;
    let expected_px = COVERAGE * 33.333 / 8.75 * libm::sqrtf(variance);
    assert!(
        (frame.smear_px - expected_px).abs() < 0.002,
        "{}",
        frame.smear_px
    );
    // A step of 0.1 µm has σ of 0.029 µm, and the zero 0.05 µm; what all frames have in common is
    // not below a fifth of the tolerance at the index mark, 0.2 µm.
    let sigma = frame.principal_point_sigma;
    assert!((0.01e-3..0.03e-3).contains(&sigma.frame_mm), "{sigma:?}");
    assert!((0.061e-3..0.062e-3).contains(&sigma.common_mm), "{sigma:?}");
}

#[test]
fn settings_that_cannot_be_flown_are_refused_with_their_numbers() {
    let refused = |settings| {
        PreparedCamera::new(identified(&camera()), &settings, Start::Orderly)
            .unwrap_err()
            .to_string()
    };
    let nominal = FlightSettings::default();
    for (settings, expected) in [
        (
            FlightSettings {
                exposure_s: 0.5,
                ..nominal
            },
            "exposure_s = 0.5 is outside 0.0002 to 0.033333335",
        ),
        (
            FlightSettings {
                shutter_latency_s: f32::NAN,
                ..nominal
            },
            "shutter_latency_s = NaN is outside 0 to 1",
        ),
        (
            FlightSettings {
                trigger_interval_s: 0.05,
                ..nominal
            },
            "s, there are 0.0500 s",
        ),
    ] {
        let found = refused(settings);
        assert!(found.contains(expected), "{found}");
    }
    let slow = FlightSettings {
        trigger_interval_s: 0.5,
        ..nominal
    };
    assert!(PreparedCamera::new(identified(&camera()), &slow, Start::Orderly).is_ok());
}

/// Returns the exposure of a flight in a direction, with an encoder on a part of the mechanism.
fn fly(direction: FlightDirection, encoder_side: EncoderSide) -> ExposedFrame {
    let mut bench = Bench::new(FlightSettings {
        direction,
        drive: DriveSettings {
            encoder_side,
            ..settings().drive
        },
        ..settings()
    });
    bench.arm();
    // The strokes take as long either way to within a few rounds; σ of V/H counts its samples.
    while bench.now < Time::from_us(3_000_000) {
        bench.round();
    }
    bench.send(Event::Trigger);
    bench.run(200);
    let [record] = bench.records()[..] else {
        panic!("one record");
    };
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    frame
}

#[test]
fn reverse_flight_mirrors_the_record() {
    let [forward, reverse] = [FlightDirection::Forward, FlightDirection::Reverse]
        .map(|direction| fly(direction, EncoderSide::Stage));
    let (there, back) = (forward.interior.motion, reverse.interior.motion);
    assert!((there.travel_mm + back.travel_mm).abs() < 1e-7 && back.travel_mm < -0.03);
    assert!((there.centroid_mm + back.centroid_mm).abs() < 1e-7);
    assert!((forward.smear_um - reverse.smear_um).abs() < 1e-3);
}

#[test]
fn stage_pushed_against_the_axis_is_ahead_of_its_screw_by_the_play() {
    let [forward, reverse] = [FlightDirection::Forward, FlightDirection::Reverse]
        .map(|direction| fly(direction, EncoderSide::Screw));
    let mirrored = fly(FlightDirection::Reverse, EncoderSide::Stage);
    let play_mm = 1e-3 * DriveSettings::default().play_um;
    let ahead_mm = reverse.interior.motion.centroid_mm - mirrored.interior.motion.centroid_mm;
    assert!((ahead_mm - play_mm).abs() < 1e-6, "{ahead_mm}");
    let [along, against] = [forward, reverse].map(|frame| frame.principal_point_sigma.common_mm);
    // The play is known to a tenth of it.
    assert!(
        along < 1e-4 && (against - 0.1 * play_mm).abs() < 1e-5,
        "{along}, {against}"
    );
}

#[test]
fn rows_of_a_tdi_sensor_need_no_stage() {
    let mut record = camera();
    record.mechanism = Mechanism::Tdi {
        first_transfer: 0.5,
    };
    let mut bench = Bench::with(&record, FlightSettings::default(), Start::Orderly);
    bench.is_read = false;
    bench.arm();
    bench.send(Event::Trigger);
    bench.run(50);
    let [record] = bench.records()[..] else {
        panic!("one record");
    };
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    // A row of the image's motion is more than a quarter of a pixel.
    assert_eq!(record.faults, Faults::NONE);
    assert!(record.flags.iter().eq([Flag::SmearOverBudget]));
    assert!((frame.interior.motion.travel_mm - 0.0333).abs() < 2e-4);
    assert!(
        !bench
            .actions
            .iter()
            .any(|(_, it)| *it == Action::ReleaseStage)
    );
}
