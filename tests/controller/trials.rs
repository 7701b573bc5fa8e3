//! Trials of a mechanism with nothing but a number for its place.

use fmc_camera::flight::bring_up::{NotTried, Trial, TrialEnd, TrialReport};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::drive::flown_drive::FlownDrive;
use fmc_camera::flight::drive::{FmcDrive, StageReading};
use fmc_camera::flight::event::Action;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::input_levels::InputLevels;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

use crate::controller::bench::{camera, identified};

const JOG: Trial = Trial::Jog { way_um: 20.0 };
const DUTY: Trial = Trial::Duty {
    duty: 0.05,
    time_s: 0.01,
};

/// Mechanism whose place is told, or which is where its set point is, less an error.
#[derive(Debug, Default)]
struct Bare {
    place_mm: Option<f32>,
    behind_mm: Option<f32>,
    has_force: bool,
}

impl FmcDrive for Bare {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        let reading = self.place_mm.map(|offset_mm| StageReading {
            time: now,
            offset_mm,
        });
        reading.ok_or(Fault::Encoder)
    }

    fn follow(&mut self, _: Time, setpoint: Setpoint) -> Result<(), Fault> {
        self.has_force = true;
        if let Some(behind_mm) = self.behind_mm {
            self.place_mm = Some(setpoint.offset_mm - behind_mm);
        }
        Ok(())
    }

    fn release(&mut self) {
        self.has_force = false;
    }
}

impl FlownDrive for Bare {
    fn push(&mut self, _: Time, _: f32) -> Result<(), Fault> {
        self.has_force = true;
        Ok(())
    }

    fn set_reference(&mut self) {}
}

struct Board {
    deck: FlownDeck<Bare>,
    now: Time,
}

impl Board {
    fn new(place_mm: Option<f32>) -> Self {
        let drive = Bare {
            place_mm,
            ..Bare::default()
        };
        let deck = FlownDeck::new(drive, Start::Unreferenced);
        let now = Time::START;
        let mut board = Self { deck, now };
        board.round();
        board
    }

    fn round(&mut self) -> Vec<Action> {
        self.now = self.now.plus_s(1e-3);
        self.deck.round(self.now).into_iter().collect()
    }

    fn see(&mut self, limit_low: bool, limit_high: bool) {
        self.deck.see(InputLevels {
            limit_low,
            limit_high,
            ..InputLevels::GOOD
        });
    }

    /// Runs the trial that is under way to its end, and returns its report.
    fn run_on(&mut self) -> TrialReport {
        for _ in 0..1000 {
            self.round();
            let report = self.deck.trial().unwrap();
            if report.end.is_some() {
                assert!(!self.deck.drive().has_force);
                return report;
            }
        }
        panic!("{:?} never ends", self.deck.trial());
    }
}

#[test]
fn trial_with_force_is_refused_without_a_reading_and_at_either_switch() {
    let mut blind = Board::new(None);
    for trial in [JOG, DUTY] {
        assert_eq!(blind.deck.try_out(trial), Err(NotTried::NoReading));
    }
    assert_eq!(blind.deck.trial(), None);
    let shutter = Trial::Shutter { exposure_s: 1e-3 };
    assert_eq!(blind.deck.try_out(shutter), Ok(()));
    for (limit_low, limit_high) in [(true, false), (false, true), (true, true)] {
        let mut board = Board::new(Some(0.0));
        board.see(limit_low, limit_high);
        for trial in [JOG, DUTY] {
            assert_eq!(board.deck.try_out(trial), Err(NotTried::LimitSwitch));
        }
        assert_eq!(board.deck.try_out(shutter), Ok(()));
    }
}

#[test]
fn trial_ends_where_the_encoder_has_no_reading_any_more() {
    for trial in [JOG, DUTY] {
        let mut board = Board::new(Some(0.25));
        board.deck.try_out(trial).unwrap();
        board.round();
        assert!(board.deck.drive().has_force);
        board.deck.drive_mut().place_mm = None;
        let report = board.run_on();
        assert_eq!(report.end, Some(TrialEnd::Drive));
        assert_eq!((report.from_mm, report.to_mm), (Some(0.25), None));
    }
}

#[test]
fn trial_ends_at_either_switch() {
    for (limit_low, limit_high) in [(true, false), (false, true)] {
        for trial in [JOG, DUTY] {
            let mut board = Board::new(Some(0.0));
            board.deck.try_out(trial).unwrap();
            board.round();
            board.see(limit_low, limit_high);
            assert_eq!(board.run_on().end, Some(TrialEnd::LimitSwitch));
        }
    }
}

#[test]
fn jog_whose_stage_stays_behind_at_its_end_has_not_followed() {
    for (behind_mm, end) in [
        (0.0, TrialEnd::Done),
        (0.009, TrialEnd::Done),
        (0.011, TrialEnd::NotFollowing),
        (-0.018, TrialEnd::NotFollowing),
    ] {
        let mut board = Board::new(Some(0.0));
        board.deck.drive_mut().behind_mm = Some(behind_mm);
        board.deck.try_out(JOG).unwrap();
        let mut rounds = 0;
        while board.deck.trial().unwrap().end.is_none() {
            board.round();
            rounds += 1;
            // A silent encoder would end it earlier.
            let wobble_mm = if rounds % 2 == 0 { 0.0006 } else { 0.0 };
            board.deck.drive_mut().behind_mm = Some(behind_mm + wobble_mm);
        }
        let report = board.deck.trial().unwrap();
        assert_eq!(report.end, Some(end), "{behind_mm}: {report:?}");
        // 20 ms of way, and 100 ms of hold.
        assert!((120..=123).contains(&rounds), "{rounds}");
        assert!(!board.deck.drive().has_force);
    }
}

#[test]
fn duty_of_nothing_that_moves_nothing_is_complete() {
    let still = |duty| {
        let mut board = Board::new(Some(0.0));
        let time_s = 0.005;
        board.deck.try_out(Trial::Duty { duty, time_s }).unwrap();
        board.run_on().end
    };
    assert_eq!(still(0.0), Some(TrialEnd::Done));
    assert_eq!(still(0.1), Some(TrialEnd::NotFollowing));
}

#[test]
fn shutter_that_has_not_been_told_to_open_is_not_told_to_close_by_a_load() {
    for (rounds, closes) in [(0, vec![]), (1, vec![Action::CloseShutter])] {
        let mut board = Board::new(Some(0.0));
        let exposure_s = 0.01;
        board.deck.try_out(Trial::Shutter { exposure_s }).unwrap();
        for _ in 0..rounds {
            assert!(matches!(board.round()[..], [Action::OpenShutter { .. }]));
        }
        board.deck.load(identified(&camera()));
        assert_eq!(board.deck.trial().unwrap().end, Some(TrialEnd::Loaded));
        assert_eq!(board.round(), closes);
        assert_eq!(board.round(), []);
    }
}
