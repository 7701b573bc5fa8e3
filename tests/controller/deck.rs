//! The deck of a board, and cameras that are prepared in place: wires, exchange, and records.

use std::mem::MaybeUninit;

use fmc_camera::Camera;
use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::clock_drift::ClockDrift;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::controller::{ControllerError, NotExchanged, Start};
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::{Action, Command, Event};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::frame_record::{Outcome, Reason};
use fmc_camera::flight::input_levels::InputLevels;
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::rig::{Rig, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;

use crate::controller::bench::{Bench, camera, settings};

fn with_crc(crc: u32) -> Camera {
    Camera::identified(&camera(), crc, Storage::Volatile).unwrap()
}

fn crc(camera: Option<&Camera>) -> Option<u32> {
    camera.and_then(Camera::id).map(|id| id.crc)
}

/// A deck with its time.
struct Board {
    deck: FlownDeck<RigDrive>,
    now: Time,
}

impl Board {
    fn new() -> Self {
        let drive = RigDrive::new(DriveSettings::default()).unwrap();
        Self {
            deck: FlownDeck::new(drive, Start::Orderly),
            now: Time::START,
        }
    }

    fn prepared() -> Self {
        let mut board = Self::new();
        board.deck.load(with_crc(1));
        board.deck.prepare(&FlightSettings::default()).unwrap();
        board
    }

    /// Runs a round with these levels, and returns its actions.
    fn round(&mut self, levels: InputLevels) -> Vec<Action> {
        self.now = self.now.plus_s(1e-3);
        self.deck.set_now(self.now);
        self.deck.see(levels);
        self.deck.round(self.now).into_iter().collect()
    }

    fn is_told_good(&self) -> bool {
        self.deck.controller().unwrap().is_supply_good()
    }
}

#[test]
fn switch_that_finds_no_room_is_told_with_the_next_round_and_the_supply_after_it() {
    let mut board = Board::prepared();
    board.round(InputLevels::GOOD);
    let bad = InputLevels {
        limit_high: true,
        supply_low: false,
        ..InputLevels::GOOD
    };
    // The line has to be closed for two rounds.
    assert_eq!(board.round(bad), []);
    for _ in 0..2 {
        board.deck.capture(board.now, Event::LimitSwitch);
    }
    let both = InputLevels {
        supply_low: true,
        ..bad
    };
    let fault = Action::Fault(Fault::LimitSwitch);
    assert_eq!(board.round(both), [fault]);
    assert!(board.is_told_good(), "the supply has waited, too");
    board.round(both);
    assert!(!board.is_told_good());
}

#[test]
fn change_of_the_supply_that_finds_no_room_is_told_with_the_next_round() {
    let mut board = Board::prepared();
    board.round(InputLevels::GOOD);
    let low = InputLevels {
        supply_low: true,
        ..InputLevels::GOOD
    };
    for _ in 0..2 {
        let good = fmc_camera::flight::event::Supply::Good;
        board.deck.capture(board.now, Event::Supply(good));
    }
    board.round(low);
    assert!(board.is_told_good());
    assert!(!board.deck.is_supply_good(), "its line says so");
    board.round(low);
    assert!(!board.is_told_good());
}

#[test]
fn edges_that_are_lost_are_told_to_a_prepared_camera_and_counted_by_the_board() {
    let mut board = Board::new();
    board.deck.count_lost(3);
    board.deck.load(with_crc(1));
    board.deck.prepare(&FlightSettings::default()).unwrap();
    board.deck.count_lost(4);
    assert_eq!(
        board.round(InputLevels::GOOD),
        [Action::Fault(Fault::Overload)]
    );
    assert_eq!(board.deck.edges().lost, 7);
    let counts = board.deck.controller().unwrap().counts();
    assert_eq!(counts.lost_events, 4, "those of this flight");
}

#[test]
fn deck_shows_the_drift_of_its_clock_and_hands_over_the_settings_of_its_lines_once() {
    let mut board = Board::new();
    assert_eq!(board.deck.clock_drift(), None);
    assert_eq!(board.deck.take_inputs(), None);
    let drift = ClockDrift {
        drift_ppm: 12.0,
        corrected_ppm: 11.5,
    };
    board.deck.note_clock(Some(drift));
    assert_eq!(board.deck.clock_drift(), Some(drift));
    let mut settings = FlightSettings::default();
    settings.inputs.shortest_pulse_ns = 80.0;
    board.deck.load(with_crc(1));
    board.deck.prepare(&settings).unwrap();
    assert_eq!(board.deck.take_inputs(), Some(settings.inputs));
    assert_eq!(board.deck.take_inputs(), None);
}

#[test]
fn records_of_a_flight_are_acknowledged_and_stay_over_an_exchange_of_the_calibration() {
    let mut board = Board::new();
    assert!(board.deck.controller_mut().is_none());
    // Without a flight it is a load.
    board.deck.exchange(with_crc(1));
    assert_eq!(crc(board.deck.camera()), Some(1));
    assert!(board.deck.controller().is_none());
    board.deck.prepare(&FlightSettings::default()).unwrap();
    for crc_of_camera in [1, 2] {
        board.deck.capture(board.now, Event::Trigger);
        let sequence = crc_of_camera;
        let ready = Action::FrameReady(sequence);
        assert_eq!(board.round(InputLevels::GOOD), [ready]);
        let record = board.deck.controller().unwrap().record(sequence).unwrap();
        assert_eq!(record.outcome, Outcome::Refused(Reason::NotArmed));
        assert_eq!(record.calibration.map(|id| id.crc), Some(crc_of_camera));
        let next = with_crc(crc_of_camera + 1);
        assert_eq!(board.deck.check_exchange(&next), Ok(()));
        board.deck.exchange(next);
        assert_eq!(crc(board.deck.camera()), Some(crc_of_camera + 1));
    }
    let controller = board.deck.controller_mut().unwrap();
    assert_eq!(controller.acknowledge(1), 1);
    let left = controller.record(0).unwrap();
    assert_eq!((left.sequence, left.calibration.unwrap().crc), (2, 2));
}

#[test]
fn camera_in_a_place_is_as_one_that_is_returned_and_none_is_put_there_with_wrong_settings() {
    let mut place = MaybeUninit::uninit();
    let mut wrong = settings();
    wrong.exposure_s = f32::NAN;
    let refused = PreparedCamera::new_in(&mut place, &with_crc(1), &wrong, Start::Orderly);
    assert!(matches!(refused, Err(ControllerError::Settings(_))));
    let start = Start::AfterWatchdog;
    let there = PreparedCamera::new_in(&mut place, &with_crc(1), &settings(), start).unwrap();
    let returned = PreparedCamera::new(with_crc(1), &settings(), start).unwrap();
    assert_eq!(there.camera(), &with_crc(1));
    assert_eq!(there.settings(), returned.settings());
    let states = [there, &returned].map(|it| it.controller().state());
    assert_eq!(states, [State::Fault(Fault::Watchdog); 2]);
}

#[test]
fn calibration_is_exchanged_in_standby_and_not_of_an_armed_camera() {
    let mut bench = Bench::armed();
    let refused = bench.camera.exchange(with_crc(2));
    assert_eq!(refused, Err(NotExchanged::FrameInFlight));
    assert_eq!(crc(Some(bench.camera.camera())), Some(0xca1));
    bench.send(Event::Command(Command::Disarm));
    assert_eq!(bench.camera.exchange(with_crc(2)), Ok(()));
    assert_eq!(crc(Some(bench.camera.camera())), Some(2));
    bench.arm();
    bench.send(Event::Trigger);
    bench.run(100);
    let record = bench.camera.controller().record(0).unwrap();
    assert!(matches!(record.outcome, Outcome::Exposed(_)));
    assert_eq!(record.calibration.map(|id| id.crc), Some(2));
}

#[test]
fn rig_makes_no_round_before_its_camera_is_prepared_and_shows_its_force_then() {
    let mut rig = Rig::new(Start::Orderly);
    assert!(rig.controller_mut().is_none());
    assert_eq!(rig.step(&RigStep::default()), None);
    rig.load(with_crc(1));
    rig.prepare(&FlightSettings::default()).unwrap();
    let mut now = Time::START;
    let mut step = |rig: &mut Rig, event| {
        now = now.plus_s(1e-3);
        let step = RigStep {
            time: now,
            events: [(now, event)].into_iter().collect(),
            ..RigStep::default()
        };
        rig.step(&step).unwrap()
    };
    let idle = step(&mut rig, Event::Trigger);
    assert_eq!((idle.state, idle.powered), (State::Standby, false));
    assert_eq!(idle.actions, [Action::FrameReady(1)]);
    let controller = rig.controller_mut().unwrap();
    assert_eq!(controller.acknowledge(1), 0, "none is left");
    assert_eq!(controller.record(0), None);
    let armed = step(&mut rig, Event::Command(Command::Arm));
    assert_eq!((armed.state, armed.powered), (State::FlyBack, true));
    let disarmed = step(&mut rig, Event::LimitSwitch);
    assert!(!disarmed.powered && disarmed.duty.abs() <= 0.0);
    assert_eq!(disarmed.actions, [Action::Fault(Fault::LimitSwitch)]);
}
