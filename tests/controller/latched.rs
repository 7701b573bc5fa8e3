//! Places of the stage that hardware latches between two readings.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::frame_record::{ExposedFrame, Outcome};
use fmc_camera::flight::time::Time;

use super::bench::{Bench, in_state, only, settings};

/// Shake of the stage, mm, and the part of its period from one round to the next.
const SHAKE_MM: f32 = 0.0004;
const PERIODS_PER_ROUND: f32 = 0.43;

/// Exposure time, s.
const EXPOSURE_S: f32 = 0.001;

fn shake_mm(time: Time) -> f32 {
    let rounds = 1e3 * time.seconds_since(Time::from_us(1_000_000));
    SHAKE_MM * libm::sinf(core::f32::consts::TAU * PERIODS_PER_ROUND * rounds)
}

/// Flies a short frame with a stage that shakes, and hands over what is latched every quarter of a
/// millisecond with this much added to it, mm; `None` for a mechanism that latches nothing.
fn fly(shake_mm: fn(Time) -> f32, latched_mm: Option<f32>) -> ExposedFrame {
    let mut settings = settings();
    settings.exposure_s = EXPOSURE_S;
    let mut bench = Bench::new(settings);
    bench.arm();
    bench.shake_mm = Some(shake_mm);
    bench.send(Event::Trigger);
    while bench.camera.controller().record(1).is_none() {
        let before = bench.now;
        if let Some(added_mm) = latched_mm {
            for quarter in 1..4_u8 {
                let time = before.plus_s(0.25e-3 * f32::from(quarter));
                let Some(setpoint) = bench.camera.controller().setpoint(time) else {
                    continue;
                };
                let offset_mm = setpoint.offset_mm + shake_mm(time) + added_mm;
                bench.send_at(time, Event::Latched(StageReading { time, offset_mm }));
            }
        }
        bench.round();
    }
    exposed(&bench)
}

fn exposed(bench: &Bench) -> ExposedFrame {
    let Outcome::Exposed(frame) = only(bench).outcome else {
        panic!("{:?}", only(bench));
    };
    frame
}

#[test]
fn short_exposure_of_a_stage_that_shakes_is_known_by_what_is_latched_in_it() {
    let still = fly(|_| 0.0, None);
    let samples = 1000_u16;
    let mean_mm = (0..samples)
        .map(|at| (f32::from(at) + 0.5) / f32::from(samples))
        .map(|part| shake_mm(still.opened.plus_s(part * EXPOSURE_S)))
        .sum::<f32>()
        / f32::from(samples);
    let error_mm = |latched_mm| {
        let frame = fly(shake_mm, latched_mm);
        assert_eq!(frame.opened, still.opened);
        frame.interior.principal_point.y_mm - still.interior.principal_point.y_mm - mean_mm
    };
    let (with, without) = (error_mm(Some(0.0)), error_mm(None));
    assert!(with.abs() < 2e-5, "{with}");
    assert!(without.abs() > 4.0 * with.abs(), "{without}, {with}");
}

#[test]
fn place_that_is_latched_where_the_stage_cannot_be_is_left_out() {
    let without = fly(shake_mm, None);
    for added_mm in [-0.02, 0.02, f32::NAN, f32::INFINITY] {
        let with = fly(shake_mm, Some(added_mm));
        assert_eq!(with.interior, without.interior, "{added_mm}");
    }
}

#[test]
fn place_that_is_latched_of_a_released_stage_changes_nothing() {
    let mut bench = Bench::new(settings());
    bench.run(3);
    let reading = StageReading {
        time: bench.now,
        offset_mm: 0.0,
    };
    bench.send(Event::Latched(reading));
    assert_eq!(bench.camera.controller().state(), State::Standby);
    let mut bench = in_state(State::Exposing);
    bench.send(Event::Latched(StageReading {
        time: Time::START,
        offset_mm: 0.0,
    }));
    bench.run(200);
    exposed(&bench);
}
