//! Bring-up of a board before a camera is loaded: its lines, and trials of mechanism and shutter.

use fmc_camera::flight::bring_up::{
    LineLevels, MAX_DUTY, MAX_DUTY_S, MAX_DUTY_WAY_UM, MAX_JOG_ERROR_UM, MAX_JOG_UM, MAX_TRIAL_S,
    NotTried, Trial, TrialEnd, TrialReport,
};
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::io::link::message::{Answer, Inputs, Refusal, Request, ResetCause};

use crate::link::board::{Board, COUNT_AT_START};
use crate::link::pc::{Pc, camera_parameters};

/// Error of a jog, µm: the integral of the loop has not come to rest when the stage is released. It
/// shows sign and step of encoder and motor.
const JOG_WITHIN_UM: f32 = 10.0;

const JOG: Trial = Trial::Jog { way_um: 100.0 };
const DUTY: Trial = Trial::Duty {
    duty: 0.05,
    time_s: 0.02,
};
const SHUTTER: Trial = Trial::Shutter { exposure_s: 5e-3 };

/// A board with a stage of 0.3 kg and 22 N·s/m, to which the default gains belong.
struct Bench {
    board: Board,
    /// Way of the stage from its start, mm.
    way_mm: f32,
    speed_mm_s: f32,
    /// Force at full duty, N.
    force_n: f32,
}

impl Bench {
    fn new() -> Self {
        let mut bench = Self {
            board: Board::connected(ResetCause::PowerOn, 0),
            way_mm: 0.0,
            speed_mm_s: 0.0,
            force_n: 6.0,
        };
        bench.round();
        bench
    }

    fn round(&mut self) {
        let duty = self.duty();
        for _ in 0..10 {
            let force_n = self.force_n * duty - 22e-3 * self.speed_mm_s;
            self.speed_mm_s += 1e3 * force_n / 0.3 * 1e-4;
            self.way_mm += self.speed_mm_s * 1e-4;
        }
        let counts: i32 = format!("{:.0}", 1e4 * self.way_mm).parse().unwrap();
        self.board.count(COUNT_AT_START + counts);
        self.board.round();
    }

    fn duty(&mut self) -> f32 {
        self.board.deck().drive().duty()
    }

    fn inputs(&mut self) -> Inputs {
        match self.board.pc.ask(&Request::Inputs) {
            Answer::Inputs(inputs) => inputs,
            other => panic!("{other:?}"),
        }
    }

    fn report(&mut self) -> TrialReport {
        self.inputs().trial.unwrap()
    }

    fn begin(&mut self, trial: Trial) {
        assert_eq!(self.board.pc.ask(&Request::Try(trial)), Answer::Told);
    }

    /// Runs until the trial has ended; nothing more comes over the link. Returns its rounds, and
    /// its report.
    fn run(&mut self, trial: Trial) -> (u16, TrialReport) {
        self.begin(trial);
        for round in 0..1000 {
            self.round();
            if self.board.deck().trial().unwrap().end.is_some() {
                assert!(self.duty().abs() <= 0.0);
                assert!(!self.board.deck().drive().powered());
                return (round, self.report());
            }
        }
        panic!("{trial:?} never ends");
    }

    /// Asks for another trial while one is under way.
    fn refused_meanwhile(&mut self) -> Refusal {
        match self.board.pc.ask(&Request::Try(DUTY)) {
            Answer::Refused(refusal) => refusal,
            other => panic!("{other:?}"),
        }
    }

    /// Runs the trial that is under way to its end.
    fn run_on(&mut self) -> TrialReport {
        while self.board.deck().trial().unwrap().end.is_none() {
            self.round();
        }
        self.report()
    }

    fn refused(&mut self, trial: Trial) -> Refusal {
        match self.board.pc.ask(&Request::Try(trial)) {
            Answer::Refused(refusal) => {
                self.round();
                assert!(self.duty().abs() <= 0.0, "nothing moves");
                refusal
            }
            other => panic!("{other:?}"),
        }
    }
}

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
fn jog_of_a_reversed_or_stuck_stage_ends_before_it_is_far() {
    for force_n in [-6.0, 0.0] {
        let mut bench = Bench::new();
        bench.force_n = force_n;
        let (_, report) = bench.run(Trial::Jog { way_um: MAX_JOG_UM });
        assert_eq!(report.end, Some(TrialEnd::NotFollowing));
        assert!(report.largest_error_um > MAX_JOG_ERROR_UM);
        let moved_mm = report.to_mm.unwrap() - report.from_mm.unwrap();
        assert!(moved_mm.abs() < 0.25, "{moved_mm} mm");
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
    (bench.force_n, bench.speed_mm_s) = (0.0, 0.0);
    let (rounds, report) = bench.run(Trial::Duty {
        duty: MAX_DUTY,
        time_s: MAX_DUTY_S,
    });
    assert_eq!(report.end, Some(TrialEnd::Done));
    assert!(1e-3 * f32::from(rounds) <= MAX_TRIAL_S, "{rounds}");
}

#[test]
fn shutter_opens_for_its_time_and_its_edges_are_counted() {
    let mut bench = Bench::new();
    bench.begin(SHUTTER);
    for _ in 0..60 {
        bench.round();
    }
    let inputs = bench.inputs();
    assert_eq!(inputs.trial.unwrap().end, Some(TrialEnd::Done));
    assert_eq!(
        (inputs.edges.shutter_opened, inputs.edges.shutter_closed),
        (1, 1)
    );
    assert!((bench.way_mm).abs() <= 0.0);
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
