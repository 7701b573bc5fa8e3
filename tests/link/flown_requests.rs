//! Requests to a camera on a board, and its refusals.

use fmc_camera::flight::camera::{Camera, Mechanism};
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::FmcDrive;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::{Command, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::flown_deck::{FlownDeck, NotFlyable};
use fmc_camera::flight::rig::RigStep;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::io::link::message::{Answer, Grid, Observations, Refusal, Request, ResetCause};

use crate::link::board::{Board, COUNT_AT_START};
use crate::link::pc::{Pc, begin_load, camera_parameters};
#[test]
fn only_what_is_told_may_be_told_and_what_finds_no_place_is_refused() {
    let mut board = Board::connected(ResetCause::PowerOn, 0);
    let arm = Event::Command(Command::Arm);
    let refused = |answer| match answer {
        Answer::Refused(refusal) => refusal,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(board.tell(arm)), Refusal::NotPrepared);
    // This trigger is not counted as lost, because there is no camera.
    board.deck().capture(Time::START, Event::Trigger);
    board.pc.load(&camera_parameters());
    board.prepare();
    for wired in [
        Event::Trigger,
        Event::TimePulse,
        Event::Shutter(ShutterEdge::Opened),
        Event::LimitSwitch,
        Event::Drive(Fault::Drive),
        Event::Tick,
        Event::Lost(1),
    ] {
        assert_eq!(refused(board.tell(wired)), Refusal::NotTold, "{wired:?}");
    }
    for celsius in [f32::NAN, f32::INFINITY, 1000.0, -1000.0] {
        let told = board.tell(Event::Command(Command::Temperature(celsius)));
        let Refusal::Settings(range) = refused(told) else {
            panic!("{celsius} °C");
        };
        assert_eq!(range.quantity, Quantity::TemperatureC);
        assert_eq!((range.min, range.max), (-100.0, 100.0));
        assert_eq!(range.value.to_bits(), celsius.to_bits());
    }
    let vh = Event::Vh(VhSample::Direct(0.1));
    for _ in 0..4 {
        assert_eq!(board.tell(vh), Answer::Told);
    }
    assert_eq!(refused(board.tell(vh)), Refusal::QueueFull);
    // A command finds room all the same.
    assert_eq!(board.tell(Event::Command(Command::Disarm)), Answer::Told);
    board.round();
    assert_eq!(board.tell(vh), Answer::Told);
    board.round();
    let counts = board.status().counts;
    assert_eq!((counts.triggers, counts.lost_events), (0, 0));

    let mut rig = Pc::loaded();
    assert_eq!(refused(rig.ask(&Request::Tell(arm))), Refusal::OnRig);
    let step = RigStep::default();
    assert_eq!(refused(board.pc.ask(&Request::Rig(step))), Refusal::NoRig);
}

#[test]
fn nothing_that_lasts_longer_than_a_round_is_begun_while_the_stage_has_force_on_it() {
    let mut board = Board::prepared_at(0);
    board.arm();
    let long = [
        Request::Digest(Grid {
            x_mm: heapless_of(0.0),
            y_mm: heapless_of(0.0),
        }),
        Request::StartFit(FitOptions::default()),
        Request::Observe(Observations::new()),
        Request::Fit,
        begin_load(&camera_parameters()),
        Request::Prepare(FlightSettings::default()),
    ];
    board.trigger(0);
    let flown = board.pc.ask(&Request::Flown);
    assert!(matches!(flown, Answer::Flown(1, _)), "{flown:?}");
    for request in &long {
        let answer = board.pc.ask(request);
        assert_eq!(
            answer,
            Answer::Refused(Refusal::FrameInFlight),
            "{request:?}"
        );
    }
    board.command(Command::Disarm);
    for request in &long[..2] {
        let answer = board.pc.ask(request);
        assert!(!matches!(answer, Answer::Refused(_)), "{answer:?}");
    }
}

#[test]
fn nothing_is_loaded_or_prepared_while_it_flies_without_force_on_the_stage() {
    let mut board = Board::prepared_at(0);
    let long = [
        begin_load(&camera_parameters()),
        Request::Prepare(FlightSettings::default()),
        Request::StartFit(FitOptions::default()),
    ];
    board.command(Command::Arm);
    assert_eq!(board.status().state, State::Degraded(Fault::Encoder));
    assert!(!board.deck().drive_mut().powered());
    for request in &long {
        let answer = board.pc.ask(request);
        assert_eq!(
            answer,
            Answer::Refused(Refusal::FrameInFlight),
            "{request:?}"
        );
    }
    // Records can still be taken.
    assert_eq!(board.pc.acknowledge(0), Answer::Kept(0));
    board.command(Command::Disarm);
    for request in &long {
        let answer = board.pc.ask(request);
        assert!(!matches!(answer, Answer::Refused(_)), "{answer:?}");
    }
}

#[test]
fn armed_tdi_camera_is_busy_without_a_stage() {
    let mut camera = camera_parameters();
    camera.mechanism = Mechanism::Tdi {
        first_transfer: 0.5,
    };
    let drive = RigDrive::new(DriveSettings::default()).unwrap();
    let mut deck = FlownDeck::new(drive, ResetCause::PowerOn.unreferenced()).with_row_clock();
    deck.load(Camera::new(camera).unwrap());
    deck.prepare(&FlightSettings::default()).unwrap();
    let mut round = |number: u64, event| {
        let now = Time::from_us(1000 * number);
        deck.set_now(now);
        deck.tell(event).unwrap();
        deck.round(now);
        let controller = deck.controller().unwrap();
        (controller.state(), controller.is_busy())
    };
    let vh = Event::Vh(VhSample::Direct(0.1));
    assert_eq!(round(1, vh), (State::Standby, false));
    let arm = Event::Command(Command::Arm);
    assert_eq!(round(2, arm), (State::Armed, true));
    let disarm = Event::Command(Command::Disarm);
    assert_eq!(round(3, disarm), (State::Standby, false));
}

#[test]
fn encoder_is_seen_in_the_status_before_anybody_has_said_where_the_stage_stands() {
    let mut board = Board::connected(ResetCause::PowerOn, 0);
    board.pc.load(&camera_parameters());
    let offset_mm = |board: &mut Board| board.deck().offset_mm();
    assert_eq!(offset_mm(&mut board), None, "before the first round");
    board.round();
    let started_mm = offset_mm(&mut board).unwrap();
    assert!((started_mm - 1.2345).abs() < 1e-6, "{started_mm} mm");
    board.prepare();
    // The stage is pushed by 0.1 mm.
    board.count(COUNT_AT_START + 1000);
    board.round();
    let status = board.status();
    assert!(status.is_place_lost);
    let pushed_mm = status.offset_mm.unwrap() - started_mm;
    assert!((pushed_mm - 0.1).abs() < 1e-6, "{pushed_mm} mm");
    board.command(Command::Referenced);
    assert_eq!(board.status().offset_mm, Some(0.0));
}

fn heapless_of<const N: usize>(value: f32) -> heapless::Vec<f32, N> {
    std::iter::once(value).collect()
}

#[test]
fn second_prepare_takes_new_drive_settings_and_keeps_the_place() {
    let mut board = Board::prepared_at(0);
    board.arm();
    board.command(Command::Disarm);
    board.count(COUNT_AT_START + 1000);
    let offset_mm = |board: &mut Board| {
        let reading = board.deck().drive_mut().position(Time::START).unwrap();
        reading.offset_mm
    };
    assert!((offset_mm(&mut board) - 0.1).abs() < 1e-6);
    let mut settings = FlightSettings::default();
    settings.drive.encoder_step_um = 0.2;
    settings.drive.encoder_reversed = true;
    assert_eq!(board.pc.ask(&Request::Prepare(settings)), Answer::Prepared);
    assert!((offset_mm(&mut board) + 0.2).abs() < 1e-6);
    board.round();
    let status = board.status();
    assert!(!status.is_place_lost);
    assert_eq!(status.counts.triggers, 0);
}

#[test]
fn reference_is_taken_in_standby_alone() {
    let mut board = Board::prepared_at(0);
    board.arm();
    let count = board.deck().drive_mut().position(Time::START).unwrap();
    board.command(Command::Referenced);
    board.round();
    let unchanged = board.deck().drive_mut().position(Time::START).unwrap();
    // The stage is at the waiting place, at most 51 µm from its place before; a new zero there
    // would make its offset 0.
    assert!((unchanged.offset_mm - count.offset_mm).abs() < 1e-3);
    assert!(unchanged.offset_mm.abs() > 1e-3, "{unchanged:?}");
    assert_eq!(board.deck().controller().unwrap().state(), State::Armed);
}

#[test]
fn tdi_camera_needs_an_output_that_clocks_its_rows() {
    let mut board = Board::connected(ResetCause::PowerOn, 0);
    let mut camera = camera_parameters();
    camera.mechanism = Mechanism::Tdi {
        first_transfer: 0.5,
    };
    let loaded = board.pc.load(&camera);
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    assert_eq!(board.prepare(), Answer::Refused(Refusal::NoRowClock));

    let drive = RigDrive::new(DriveSettings::default()).unwrap();
    let mut clocking = FlownDeck::new(drive, ResetCause::PowerOn.unreferenced()).with_row_clock();
    let settings = FlightSettings::default();
    assert_eq!(clocking.prepare(&settings), Err(NotFlyable::NoCamera));
    clocking.load(Camera::new(camera).unwrap());
    assert_eq!(clocking.prepare(&settings), Ok(()));
}

#[test]
fn settings_for_another_kind_of_drive_than_the_boards_are_refused() {
    let mut board = Board::prepared_at(0);
    let mut settings = FlightSettings::default();
    settings.drive.kind = DriveKind::PositionCommand;
    assert_eq!(
        board.pc.ask(&Request::Prepare(settings)),
        Answer::Refused(Refusal::OtherDrive(DriveKind::PositionCommand))
    );
    // The flight before goes on.
    board.arm();
    let said = NotFlyable::OtherDrive(DriveKind::PositionCommand).to_string();
    assert!(
        said.contains("a position command with an absolute sensor"),
        "{said}"
    );
}
