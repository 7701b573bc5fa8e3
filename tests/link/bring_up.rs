//! Bring-up of a board before a camera is loaded: its lines, and trials of mechanism and shutter.

use fmc_camera::flight::bring_up::{
    JOG_WITHIN_UM, LineLevels, MAX_DUTY, MAX_DUTY_S, MAX_DUTY_WAY_UM, MAX_JOG_ERROR_UM, MAX_JOG_UM,
    MAX_TRIAL_S, NotTried, Trial, TrialEnd,
};
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{Answer, Refusal, Request, ResetCause};

use crate::link::board::Board;
use crate::link::pc::{Pc, camera_parameters};
use crate::link::trial_bench::{Bench, DUTY, JOG, SHUTTER};

#[test]
fn edges_are_counted_and_levels_are_told_before_a_camera_is_loaded() {
    let mut bench = Bench::new();
    assert_eq!(bench.inputs().lines, None);
    let lines = LineLevels {
        encoder_a: true,
        limit_high: true,
        ..LineLevels::default()
    };
    bench.board.deck().note_lines(lines);
    bench.board.deck().count_lost(7);
    for _ in 0..3 {
        let stamp = bench.board.counter_us;
        bench.board.stamps.push((stamp, Event::Trigger));
        bench.board.stamps.push((stamp, Event::TimePulse));
        bench.round();
    }
    bench.board.deck().drive_mut().set_index(Some(4));
    bench.board.levels.limit_high = true;
    bench.round();
    let inputs = bench.inputs();
    assert_eq!(inputs.lines, Some(lines));
    let edges = inputs.edges;
    assert_eq!((edges.trigger, edges.time_pulse, edges.index), (3, 3, 1));
    assert_eq!(
        (edges.shutter_opened, edges.shutter_closed, edges.lost),
        (0, 0, 7)
    );
    assert_eq!((inputs.limit_low, inputs.limit_high), (false, true));
    assert!(!inputs.supply_low && inputs.offset_mm.is_some() && inputs.trial.is_none());
}

#[test]
fn jog_moves_the_stage_by_its_way_and_releases_it() {
    for way_um in [100.0, -MAX_JOG_UM] {
        let mut bench = Bench::new();
        let (rounds, report) = bench.run(Trial::Jog { way_um });
        assert_eq!(report.end, Some(TrialEnd::Done));
        assert!(1e-3 * f32::from(rounds) <= MAX_TRIAL_S + 2e-3, "{rounds}");
        let moved_um = 1e3 * (report.to_mm.unwrap() - report.from_mm.unwrap());
        assert!(
            (moved_um - way_um).abs() < JOG_WITHIN_UM,
            "{moved_um} of {way_um} µm"
        );
        assert!(report.largest_error_um < MAX_JOG_ERROR_UM);
        let rests = bench.way_mm;
        for _ in 0..50 {
            bench.round();
        }
        assert!((bench.way_mm - rests).abs() < 0.005);
    }
}

#[test]
fn duty_lasts_for_its_time_or_until_the_stage_is_far_enough() {
    let mut bench = Bench::new();
    bench.begin(DUTY);
    bench.round();
    assert!((bench.duty() - 0.05).abs() < 1e-3);
    for _ in 0..20 {
        bench.round();
    }
    assert_eq!(bench.report().end, Some(TrialEnd::Done));
    // 0.05 of 273 mm/s, which it reaches with the time constant of 13.6 ms, for 20 ms.
    assert!((bench.way_mm - 0.13).abs() < 0.02, "{}", bench.way_mm);

    let (_, report) = bench.run(Trial::Duty {
        duty: -MAX_DUTY,
        time_s: MAX_DUTY_S,
    });
    assert_eq!(report.end, Some(TrialEnd::FarEnough));
    let moved_um = 1e3 * (report.from_mm.unwrap() - report.to_mm.unwrap());
    let farthest_um = MAX_DUTY_WAY_UM + 120.0;
    assert!(
        (MAX_DUTY_WAY_UM..farthest_um).contains(&moved_um),
        "{moved_um}"
    );
}

#[test]
fn shutter_opens_for_its_time_and_its_edges_are_counted() {
    let mut bench = Bench::new();
    let (rounds, report) = bench.run(SHUTTER);
    assert_eq!(report.end, Some(TrialEnd::Done));
    // Lead and exposure, from the first round on.
    assert!((25..=26).contains(&rounds), "{rounds}");
    for _ in 0..5 {
        bench.round();
    }
    let edges = bench.inputs().edges;
    assert_eq!((edges.shutter_opened, edges.shutter_closed), (1, 1));
    assert!((bench.way_mm).abs() <= 0.0);
}

#[test]
fn shutter_that_is_open_or_about_to_open_refuses_another_trial_and_is_closed_by_what_ends_it() {
    const LONG: Trial = Trial::Shutter { exposure_s: 0.1 };
    for (rounds, is_open) in [(3, false), (30, true)] {
        for end in [TrialEnd::SupplyLow, TrialEnd::Loaded, TrialEnd::Done] {
            let mut bench = Bench::new();
            // `Done` stands for a camera that is loaded before the trial, and prepared in it.
            if end == TrialEnd::Done {
                bench.load();
            }
            bench.begin(LONG);
            for _ in 0..rounds {
                bench.round();
            }
            assert_eq!(bench.is_shutter_open(), is_open);
            for trial in [LONG, JOG] {
                let refusal = bench.refused(trial);
                assert_eq!(refusal, Refusal::NotTried(NotTried::UnderWay));
            }
            match end {
                TrialEnd::SupplyLow => bench.board.levels.supply_low = true,
                TrialEnd::Loaded => bench.load(),
                _ => assert_eq!(bench.board.prepare(), Answer::Prepared),
            }
            bench.round();
            let expected = match end {
                TrialEnd::Done => TrialEnd::Loaded,
                end => end,
            };
            assert_eq!(bench.report().end, Some(expected));
            for _ in 0..150 {
                assert!(!bench.is_shutter_open(), "{expected:?} after {rounds}");
                bench.round();
            }
        }
    }
}

#[test]
fn trial_has_the_default_settings_after_a_flight_with_others() {
    let mut bench = Bench::new();
    bench.load();
    let mut settings = FlightSettings::default();
    settings.drive.motor_reversed = true;
    settings.drive.encoder_reversed = true;
    settings.drive.encoder_step_um = 0.2;
    let answer = bench.board.pc.ask(&Request::Prepare(settings));
    assert_eq!(answer, Answer::Prepared);
    bench.round();
    bench.load();
    // No round comes between the camera and the trial.
    let (_, report) = bench.run(JOG);
    assert_eq!(report.end, Some(TrialEnd::Done));
    assert!(
        (bench.way_mm - 0.1).abs() < 1e-3 * JOG_WITHIN_UM,
        "{}",
        bench.way_mm
    );
    let moved_mm = report.to_mm.unwrap() - report.from_mm.unwrap();
    assert!((moved_mm - 0.1).abs() < 1e-3 * JOG_WITHIN_UM, "{report:?}");
}

#[test]
fn prepared_camera_refuses_trials_over_a_reset_and_takes_them_after_a_load() {
    let memory: &'static FlightMemory = Box::leak(Box::new(FlightMemory::blank()));
    let mut bench = Bench::kept_in(ResetCause::PowerOn, memory);
    bench.load();
    assert_eq!(bench.board.prepare(), Answer::Prepared);
    bench.round();
    for cause in [ResetCause::Requested, ResetCause::Watchdog] {
        bench = Bench::kept_in(cause, memory);
        let refusal = bench.refused(JOG);
        assert_eq!(refusal, Refusal::NotTried(NotTried::Prepared));
        let told = refusal.to_string();
        assert!(told.contains("switch it off and on, or load"), "{told}");
    }
    bench.load();
    bench.round();
    assert_eq!(bench.run(JOG).1.end, Some(TrialEnd::Done));
}

#[test]
fn trials_are_refused_outside_their_bounds_and_where_they_are_not_safe() {
    let mut bench = Bench::new();
    for trial in [
        Trial::Jog {
            way_um: MAX_JOG_UM + 0.1,
        },
        Trial::Jog { way_um: f32::NAN },
        Trial::Duty {
            duty: -0.21,
            time_s: 0.1,
        },
        Trial::Duty {
            duty: 0.1,
            time_s: 0.21,
        },
        Trial::Duty {
            duty: 0.1,
            time_s: -1.0,
        },
        Trial::Shutter { exposure_s: 0.2 },
        Trial::Shutter { exposure_s: 0.0 },
    ] {
        let refusal = bench.refused(trial);
        assert!(
            matches!(refusal, Refusal::NotTried(NotTried::OutOfBounds { .. })),
            "{trial:?}: {refusal:?}"
        );
        assert!(refusal.to_string().contains(" is outside "), "{refusal}");
    }
    bench.begin(JOG);
    assert_eq!(
        bench.refused_meanwhile(),
        Refusal::NotTried(NotTried::UnderWay)
    );
    assert_eq!(bench.run_on().end, Some(TrialEnd::Done));

    bench.board.levels.limit_low = true;
    bench.round();
    for trial in [JOG, DUTY] {
        assert_eq!(
            bench.refused(trial),
            Refusal::NotTried(NotTried::LimitSwitch)
        );
    }
    bench.board.levels.limit_low = false;
    bench.board.levels.supply_low = true;
    bench.round();
    for trial in [JOG, DUTY, SHUTTER] {
        assert_eq!(bench.refused(trial), Refusal::NotTried(NotTried::SupplyLow));
    }

    let mut prepared = Board::prepared_at(0);
    prepared.round();
    for _ in 0..2 {
        for trial in [JOG, DUTY, SHUTTER] {
            let answer = prepared.pc.ask(&Request::Try(trial));
            assert_eq!(
                answer,
                Answer::Refused(Refusal::NotTried(NotTried::Prepared))
            );
        }
        prepared.command(Command::Referenced);
        prepared.command(Command::Arm);
    }

    let mut rig = Pc::connected();
    assert_eq!(rig.ask(&Request::Try(JOG)), Answer::Refused(Refusal::OnRig));
    assert_eq!(
        rig.ask(&Request::Inputs),
        Answer::Refused(Refusal::NoInputs)
    );
}

#[test]
fn trial_ends_where_rounds_fail_to_come() {
    for trial in [JOG, DUTY] {
        let mut bench = Bench::new();
        bench.begin(trial);
        for _ in 0..5 {
            bench.round();
        }
        bench.board.counter_us += 6000;
        bench.round();
        assert!(bench.duty().abs() <= 0.0);
        assert_eq!(bench.report().end, Some(TrialEnd::Pause));
    }
}

#[test]
fn trial_ends_where_a_switch_closes_the_supply_falls_or_a_camera_is_loaded() {
    for end in [TrialEnd::LimitSwitch, TrialEnd::SupplyLow, TrialEnd::Loaded] {
        for trial in [JOG, DUTY] {
            let mut bench = Bench::new();
            bench.begin(trial);
            for _ in 0..5 {
                bench.round();
            }
            assert!(bench.duty().abs() > 0.0);
            match end {
                TrialEnd::LimitSwitch => bench.board.levels.limit_high = true,
                TrialEnd::SupplyLow => bench.board.levels.supply_low = true,
                _ => {
                    let loaded = bench.board.pc.load(&camera_parameters());
                    assert!(matches!(loaded, Answer::Loaded(_)));
                    assert!(bench.duty().abs() <= 0.0);
                }
            }
            bench.round();
            assert!(bench.duty().abs() <= 0.0, "{end:?} {trial:?}");
            assert_eq!(bench.report().end, Some(end));
        }
    }
}
