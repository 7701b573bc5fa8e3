//! A board with a modelled stage, for trials before a camera is loaded.

use fmc_camera::flight::bring_up::{Trial, TrialReport};
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{Answer, Inputs, Refusal, Request, ResetCause};

use crate::link::board::{Board, COUNT_AT_START};
use crate::link::pc::camera_parameters;

pub(crate) const JOG: Trial = Trial::Jog { way_um: 100.0 };
pub(crate) const DUTY: Trial = Trial::Duty {
    duty: 0.05,
    time_s: 0.02,
};
pub(crate) const SHUTTER: Trial = Trial::Shutter { exposure_s: 5e-3 };

/// A board with a stage of 0.3 kg and 22 N·s/m, to which the default gains belong.
pub(crate) struct Bench {
    pub(crate) board: Board,
    /// Way of the stage from its start, mm.
    pub(crate) way_mm: f32,
    pub(crate) speed_mm_s: f32,
    /// Force at full duty, N.
    pub(crate) force_n: f32,
    pub(crate) mass_kg: f32,
    /// Coulomb friction, N.
    pub(crate) friction_n: f32,
    /// Counts of the encoder for a way of the stage, mm.
    pub(crate) encoder: fn(f32) -> f32,
    /// Largest way from the start, and largest speed.
    pub(crate) farthest_mm: f32,
    pub(crate) fastest_mm_s: f32,
    pub(crate) largest_duty: f32,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self::of(Board::connected(ResetCause::PowerOn, 0))
    }

    /// Returns a bench whose board keeps its flight in a memory, after a reset.
    pub(crate) fn kept_in(cause: ResetCause, memory: &'static FlightMemory) -> Self {
        Self::of(Board::kept_in(cause, 0, Some(memory)))
    }

    fn of(board: Board) -> Self {
        let mut bench = Self {
            board,
            way_mm: 0.0,
            speed_mm_s: 0.0,
            force_n: 6.0,
            mass_kg: 0.3,
            friction_n: 0.0,
            encoder: |way_mm| 1e4 * way_mm,
            farthest_mm: 0.0,
            fastest_mm_s: 0.0,
            largest_duty: 0.0,
        };
        bench.round();
        bench
    }

    pub(crate) fn round(&mut self) {
        let duty = self.duty();
        self.largest_duty = self.largest_duty.max(duty.abs());
        for _ in 0..10 {
            let force_n = self.force_n * duty - 22e-3 * self.speed_mm_s;
            let speed_mm_s = self.speed_mm_s + 1e3 * force_n / self.mass_kg * 1e-4;
            // Friction slows the stage down, at most to a standstill.
            let slowed_mm_s = 1e3 * self.friction_n / self.mass_kg * 1e-4;
            self.speed_mm_s = speed_mm_s - speed_mm_s.clamp(-slowed_mm_s, slowed_mm_s);
            self.way_mm += self.speed_mm_s * 1e-4;
            self.farthest_mm = self.farthest_mm.max(self.way_mm.abs());
            self.fastest_mm_s = self.fastest_mm_s.max(self.speed_mm_s.abs());
        }
        let counts: i32 = format!("{:.0}", (self.encoder)(self.way_mm))
            .parse()
            .unwrap();
        self.board.count(COUNT_AT_START + counts);
        self.board.round();
    }

    pub(crate) fn duty(&mut self) -> f32 {
        self.board.deck().drive().duty()
    }

    pub(crate) fn inputs(&mut self) -> Inputs {
        match self.board.pc.ask(&Request::Inputs) {
            Answer::Inputs(inputs) => inputs,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn report(&mut self) -> TrialReport {
        self.inputs().trial.unwrap()
    }

    pub(crate) fn begin(&mut self, trial: Trial) {
        assert_eq!(self.board.pc.ask(&Request::Try(trial)), Answer::Told);
    }

    /// Runs until the trial has ended; nothing more comes over the link. Returns its rounds, and
    /// its report.
    pub(crate) fn run(&mut self, trial: Trial) -> (u16, TrialReport) {
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

    pub(crate) fn load(&mut self) {
        let loaded = self.board.pc.load(&camera_parameters());
        assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    }

    /// Returns `true` if the shutter's wire says that it is to be open.
    pub(crate) fn is_shutter_open(&mut self) -> bool {
        let now_us = self.board.counter_us;
        self.board.shutter.look(now_us).is_high
    }

    /// Lets the released stage come to rest.
    pub(crate) fn coast(&mut self) {
        for _ in 0..200 {
            self.round();
        }
    }

    /// Asks for another trial while one is under way.
    pub(crate) fn refused_meanwhile(&mut self) -> Refusal {
        match self.board.pc.ask(&Request::Try(DUTY)) {
            Answer::Refused(refusal) => refusal,
            other => panic!("{other:?}"),
        }
    }

    /// Runs the trial that is under way to its end.
    pub(crate) fn run_on(&mut self) -> TrialReport {
        while self.board.deck().trial().unwrap().end.is_none() {
            self.round();
        }
        self.report()
    }

    pub(crate) fn refused(&mut self, trial: Trial) -> Refusal {
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
