//! The way to the waiting place: it takes up the play as the run-up does.

use fmc_camera::CameraParameters;
use fmc_camera::flight::camera::Mechanism;
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::settings::EncoderSide;
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::RunUp;

use crate::controller::bench::{Bench, camera};

/// Following tolerance with default settings, mm: 10 µm and a tenth of 8.3 µm of friction.
const FOLLOWING_MM: f32 = 0.010_833;

/// Flies a few frames at a V/H that changes at once, 1/s. Returns for every arrival at a waiting
/// place the last way there, mm along the FMC axis, and the place.
fn arrivals(
    camera: &CameraParameters,
    settings: FlightSettings,
    vh_per_s: [f32; 2],
) -> Vec<(f32, f32)> {
    let mut bench = Bench::with(camera, settings, Start::Orderly);
    bench.run(2);
    bench.send(Event::Command(Command::Arm));
    let (mut way_mm, mut before_mm, mut was_ready) = (0.0_f32, 0.0, false);
    let mut found = Vec::new();
    for round in 0..3000 {
        // The change comes in a way back of a screw without a mark.
        bench.vh_per_s = Some(vh_per_s[usize::from(round > 1070)]);
        bench.round();
        let place_mm = bench.place_mm();
        let moved_mm = place_mm - before_mm;
        way_mm = if way_mm * moved_mm < 0.0 { 0.0 } else { way_mm } + moved_mm;
        before_mm = place_mm;
        let is_ready = bench.camera.controller().state() == State::Armed;
        if is_ready && !was_ready {
            found.push((way_mm, place_mm));
            bench.run(20);
            bench.send(Event::Trigger);
        }
        was_ready = is_ready;
    }
    found
}

fn staged(run_up: RunUp) -> CameraParameters {
    let mut parameters = camera();
    if let Mechanism::Stage { run_up: it, .. } = &mut parameters.mechanism {
        *it = run_up;
    }
    parameters
}

#[test]
fn stage_comes_to_its_waiting_place_in_the_direction_in_which_it_leaves() {
    for run_up in [RunUp::Centred, RunUp::FromRest] {
        for (direction, sign) in [
            (FlightDirection::Forward, 1.0_f32),
            (FlightDirection::Reverse, -1.0),
        ] {
            for (side, play_um) in [
                (EncoderSide::Screw, 5.0_f32),
                (EncoderSide::Screw, 50.0),
                (EncoderSide::Stage, 12.0),
            ] {
                for index_mm in [None, Some(0.3)] {
                    let mut settings = FlightSettings {
                        direction,
                        ..FlightSettings::default()
                    };
                    settings.drive.index_mm = index_mm;
                    settings.drive.encoder_side = side;
                    settings.drive.play_um = play_um;
                    let play_mm = 1e-3 * play_um;
                    // Twice the following tolerance, in which an encoder on the stage has its play.
                    let least_mm = match side {
                        EncoderSide::Screw => 2.0 * FOLLOWING_MM + play_mm,
                        EncoderSide::Stage => 2.0 * (FOLLOWING_MM + play_mm),
                    };
                    let found = arrivals(&staged(run_up), settings, [0.1, 0.17]);
                    let case = format!("{run_up:?} {direction:?} {side:?} {play_um} {index_mm:?}");
                    assert!(found.len() >= 9, "{case}: {found:?}");
                    for (way_mm, _) in &found {
                        let along_mm = sign * way_mm;
                        assert!(along_mm > least_mm - 1e-5, "{case}: {way_mm} {found:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn stage_without_play_goes_straight_to_its_waiting_place() {
    let mut settings = FlightSettings::default();
    settings.drive.play_um = 0.0;
    let found = arrivals(&staged(RunUp::Centred), settings, [0.17, 0.17]);
    assert!(found.len() >= 9);
    for (way_mm, place_mm) in found {
        assert!(way_mm < -0.1 && place_mm < -0.1, "{way_mm} to {place_mm}");
    }
}

#[test]
fn stroke_that_ends_before_the_way_shortens_it() {
    // At 0.17 1/s and a tenth more the run-up needs 0.175 mm of ramp and 0.094 mm of settling
    // before half the exposure, 0.031 mm: the stage waits at -0.2995 mm.
    let mut parameters = staged(RunUp::Centred);
    parameters.limits.vh_per_s = [0.05, 0.17];
    parameters.calibration.stroke_mm = 0.62;
    let found = arrivals(&parameters, FlightSettings::default(), [0.17, 0.17]);
    assert!(found.len() >= 9);
    let shortest_mm = found.iter().map(|it| it.0).fold(f32::INFINITY, f32::min);
    assert!((shortest_mm - 0.0105).abs() < 1e-4, "{found:?}");
}
