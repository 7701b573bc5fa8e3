//! Sequences of events that once led astray: each comment says how.

use fmc_camera::flight::camera::{CameraRecord, Mechanism};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::event::{Action, AttitudeSample, Command, Event, ShutterEdge, Supply};
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::fault::{Fault, Faults};
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, Flags, FrameRecord, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;

use crate::bench::{Bench, camera};

/// A round of a given length, with a reading of a stage that is off its set point; `None`: no reading.
fn round(bench: &mut Bench, round_s: f32, off_mm: Option<f32>) {
    bench.now = bench.now.plus_s(round_s);
    bench.send(Event::Vh(VhSample::Direct(0.1)));
    while let Some((time, edge)) = bench.edges.first().copied()
        && time <= bench.now
    {
        bench.edges.remove(0);
        bench.send_at(time, Event::Shutter(edge));
    }
    if let Some(off_mm) = off_mm {
        let reading = StageReading {
            time: bench.now,
            offset_mm: bench.place_mm() + off_mm,
        };
        bench.send(Event::Stage(reading));
    }
    bench.send(Event::Tick);
}

fn late_round(bench: &mut Bench) {
    bench.now = bench.now.plus_s(0.001);
    bench.round();
}

fn tdi() -> CameraRecord {
    CameraRecord {
        mechanism: Mechanism::Tdi {
            first_transfer: 0.5,
        },
        ..camera()
    }
}

fn exposing_for(exposure_s: f32) -> Bench {
    let mut bench = Bench::new(FlightSettings {
        exposure_s,
        ..FlightSettings::default()
    });
    bench.arm();
    bench.send(Event::Trigger);
    bench.run_until(200, |it| it == State::Exposing);
    bench
}

fn stalled() -> Bench {
    let mut bench = Bench::new(FlightSettings {
        exposure_s: 0.02,
        ..FlightSettings::default()
    });
    bench.arm();
    bench.send(Event::Trigger);
    bench.run(8);
    bench.stage_follows = false;
    bench.run_until(200, |it| it == State::Degraded(Fault::Stall));
    bench
}

fn exposed(record: &FrameRecord) -> ExposedFrame {
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    frame
}

fn closes(bench: &Bench) -> usize {
    let is_close = |it: &&(Time, Action)| it.1 == Action::CloseShutter;
    bench.actions.iter().filter(is_close).count()
}

fn is_unflagged(record: &FrameRecord) -> bool {
    record.flags == Flags::NONE
        && record.faults == Faults::NONE
        && exposed(record).principal_point_sigma_mm < 1e-3
}

// The stage is driven after a fault.

#[test]
fn stall_outlives_a_brown_out() {
    // `resume` forgets `degraded`: supply low and good again drives a stalled stage that nobody has cleared.
    let mut bench = stalled();
    bench.send(Event::Supply(Supply::Low));
    bench.run(5);
    bench.send(Event::Supply(Supply::Good));
    for _ in 0..20 {
        bench.round();
        assert!(
            bench.controller.setpoint(bench.now).is_none(),
            "driven in {}",
            bench.controller.state()
        );
    }
}

#[test]
fn place_lost_in_standby_is_not_driven_blind() {
    // In standby the fault is noted, `is_place_lost` stays, arming drives the stage with its watch switched off.
    let mut bench = Bench::new(FlightSettings::default());
    bench.run(2);
    bench.send(Event::Drive(Fault::Encoder));
    bench.send(Event::Command(Command::Arm));
    bench.run(2);
    // It goes the wrong way by half a millimetre, and nobody sees it.
    for _ in 0..20 {
        round(&mut bench, 1e-3, Some(-0.5));
    }
    assert!(
        bench.controller.setpoint(bench.now).is_none(),
        "still driven, {}",
        bench.controller.state()
    );
}

#[test]
fn stall_outlives_an_overload() {
    // `overload` replaces `degraded` during an exposure; a second later the camera is armed, its stage without force,
    // and the next trigger drives it from 0 mm, wherever it is.
    let mut bench = stalled();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Exposing);
    for _ in 0..3 {
        late_round(&mut bench);
    }
    bench.run(1500);
    let state = bench.controller.state();
    bench.send(Event::Trigger);
    let driven_to = bench.controller.setpoint(bench.now);
    assert_eq!(
        (state, driven_to),
        (State::Degraded(Fault::Stall), None),
        "the stage is at {} mm",
        bench.stage.offset_mm
    );
}

// Wrong principal points without flag or fault.

#[test]
fn glitch_of_a_stage_without_force_is_no_motion() {
    // Without force readings are not looked at: one wrong reading is integrated into the centroid.
    let mut bench = stalled();
    let place_mm = bench.stage.offset_mm;
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Exposing);
    bench.run(5);
    round(&mut bench, 1e-3, Some(0.5));
    bench.run(60);
    let record = bench.records()[1];
    let off_mm = exposed(&record).interior.motion.centroid_mm - place_mm;
    assert!(
        off_mm.abs() < 1e-3 || record.flags.contains(Flag::EncoderGlitch),
        "{off_mm} mm off, flags {:?}",
        record.flags.iter().collect::<Vec<_>>()
    );
}

#[test]
fn closing_edge_never_seen_is_not_a_measured_centroid() {
    // The shutter closed in time, its edge was lost: the centroid is that of 54 ms, σ is 30 nm.
    // `ShutterLong` with a closing edge that was seen looks the same.
    let mut bench = exposing_for(1.0 / 300.0);
    bench.edges.clear();
    bench.run(100);
    let record = bench.records()[0];
    let frame = exposed(&record);
    // Planned and true: 0.
    let off_mm = frame.interior.motion.centroid_mm;
    assert!(
        off_mm.abs() <= 3.0 * frame.principal_point_sigma_mm
            || record.flags.contains(Flag::StaticCorrection)
            || record.flags.contains(Flag::ExtrapolatedMotion),
        "{off_mm} mm off, σ {} mm, flags {:?}",
        frame.principal_point_sigma_mm,
        record.flags.iter().collect::<Vec<_>>()
    );
}

#[test]
fn lost_place_is_not_found_again_by_clearing_it() {
    // 0.5 mm of counts are added, the fault is cleared, nothing has been referenced: frames are "measured" again.
    let mut bench = Bench::armed();
    for _ in 0..3 {
        round(&mut bench, 1e-3, Some(0.5));
    }
    bench.run_until(200, |it| it == State::Degraded(Fault::Encoder));
    bench.send(Event::Command(Command::ClearFault));
    // From here on the loop is closed on the wrong count: reading = set point = true place + 0.5 mm.
    bench.run(2);
    bench.send(Event::Command(Command::Arm));
    bench.run(1500);
    for _ in 0..2 {
        bench.send(Event::Trigger);
        bench.run(200);
    }
    let record = bench.records()[1];
    assert!(!is_unflagged(&record), "0.5 mm off: {record:?}");
}

#[test]
fn gap_in_the_readings_is_flagged() {
    // `is_covered` looks at the ends alone: 12 of 20 ms are interpolated as if they had been measured.
    let mut bench = exposing_for(0.02);
    bench.run(3);
    bench.is_read = false;
    bench.run(12);
    bench.is_read = true;
    bench.run(60);
    let record = bench.records()[0];
    assert!(!is_unflagged(&record), "{record:?}");
}

#[test]
fn wobble_in_the_exposure_is_smear() {
    // 9 µm away from the set point and back: travel is right, so smear is "0.1 px"; it is 1 px.
    let mut bench = exposing_for(0.02);
    for tick in 1..=18_u8 {
        let off_um = 0.9 * f32::from(if tick < 10 { tick } else { 18 - tick });
        round(&mut bench, 1e-3, Some(1e-3 * off_um));
    }
    bench.run(60);
    let record = bench.records()[0];
    let smear_px = exposed(&record).smear_px;
    assert!(
        record.flags.contains(Flag::SmearOverBudget) || smear_px > 0.8,
        "smear {smear_px} px, faults {:?}",
        record.faults.iter().collect::<Vec<_>>()
    );
}

#[test]
fn reading_from_the_future_does_not_end_all_measuring() {
    // The time of a reading is not checked: all later ones are "not later" and left out of the path for 10 s, which
    // is then the straight line to that reading.
    let mut bench = Bench::armed();
    let reading = StageReading {
        time: bench.now.plus_s(10.0),
        offset_mm: bench.place_mm(),
    };
    bench.send(Event::Stage(reading));
    bench.run(10);
    bench.send(Event::Trigger);
    bench.run(100);
    let record = bench.records()[0];
    let centroid_mm = exposed(&record).interior.motion.centroid_mm;
    assert!(
        centroid_mm.abs() < 1e-3
            || record.flags.contains(Flag::PlannedMotion)
            || record.faults.contains(Fault::Encoder),
        "{centroid_mm} mm, flags {:?} faults {:?}",
        record.flags.iter().collect::<Vec<_>>(),
        record.faults.iter().collect::<Vec<_>>()
    );
}

// The shutter opens without the stage at speed.

/// When the shutter's command leaves in the frame of [`Bench::armed`] triggered at once.
fn command() -> Time {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Tracking);
    let opens = bench.actions.iter().find_map(|(_, action)| match action {
        Action::OpenShutter { at, .. } => Some(*at),
        _ => None,
    });
    opens.unwrap()
}

/// Rounds with their times relative to the command, s, of a stage that falls back by 7 % of its speed from 8 ms before.
fn slow_stage(ends_s: &[f32]) -> Bench {
    const SLOW_MM_S: f32 = -0.7;
    let command = command();
    let slow_from = command.plus_s(-0.008);
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    let go = |bench: &mut Bench, to: Time| {
        let off_mm = SLOW_MM_S * to.seconds_since(slow_from).max(0.0);
        let round_s = to.seconds_since(bench.now);
        round(bench, round_s, Some(off_mm.max(-0.0095)));
    };
    while bench.now.plus_s(0.001) < command.plus_s(ends_s[0]) {
        let to = bench.now.plus_s(0.001);
        go(&mut bench, to);
    }
    for end_s in ends_s {
        go(&mut bench, command.plus_s(*end_s));
    }
    for _ in 0..60 {
        let to = bench.now.plus_s(0.001);
        go(&mut bench, to);
    }
    bench
}

#[test]
fn stage_not_at_speed_is_seen_with_rounds_of_1_4_ms() {
    // Control: punctual rounds refuse the frame.
    let punctual = slow_stage(&[-0.0015, -0.0005, 0.0005, 0.0015]);
    assert_eq!(
        punctual.records()[0].outcome,
        Outcome::Refused(Reason::NotAtSpeed)
    );
    // No round in the last millisecond before the command (1.4 ms are not even late): nobody looks at the speed.
    let bench = slow_stage(&[-0.001_05, 0.000_35, 0.0015]);
    assert_eq!(bench.controller.counts().late_ticks, 0);
    assert_eq!(
        bench.records()[0].outcome,
        Outcome::Refused(Reason::NotAtSpeed)
    );
}

#[test]
fn command_taken_back_is_not_repeated_without_a_look_at_the_speed() {
    // Taken back 0.9 ms before it leaves; the next round, 0.1 ms before, sends it again: `now < planned` is not checked.
    let bench = slow_stage(&[-0.0009, -0.0001, 0.0009]);
    assert_eq!(
        bench.records()[0].outcome,
        Outcome::Refused(Reason::NotAtSpeed)
    );
}

#[test]
fn shutter_does_not_open_on_readings_that_have_ceased() {
    // The slope of old readings counts for ever; there is no fault for an encoder that says nothing.
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run(5);
    bench.is_read = false;
    bench.run(100);
    let opens = |it: &(Time, Action)| matches!(it.1, Action::OpenShutter { .. });
    assert!(
        !bench.actions.iter().any(opens),
        "{:?}",
        bench.records()[0].outcome
    );
}

// The shutter is left open; faults in the wrong record.

#[test]
fn second_shutter_that_does_not_close_is_told_to() {
    // `fail` after `give_up_exposure` notes for the next frame, whose own long exposure is then taken for reported.
    let mut bench = exposing_for(1.0 / 300.0);
    bench.edges.clear();
    bench.run_until(100, |it| it == State::Fault(Fault::ShutterLong));
    bench.send(Event::Command(Command::ClearFault));
    bench.arm();
    bench.actions.clear();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Exposing);
    bench.edges.clear();
    bench.run_until(100, |it| it == State::Fault(Fault::ShutterLong));
    assert_eq!(closes(&bench), 1, "{:?}", bench.actions);
}

#[test]
fn good_frame_after_a_long_one_is_good() {
    let mut bench = exposing_for(1.0 / 300.0);
    bench.edges.clear();
    bench.run_until(100, |it| it == State::Fault(Fault::ShutterLong));
    bench.send(Event::Command(Command::ClearFault));
    bench.arm();
    bench.send(Event::Trigger);
    bench.run(100);
    let [first, second] = bench.records()[..] else {
        panic!();
    };
    assert!(first.faults.contains(Fault::ShutterLong));
    assert_eq!(second.faults, Faults::NONE);
}

#[test]
fn clock_fault_is_in_one_record() {
    let mut bench = exposing_for(1.0 / 300.0);
    bench.edges.clear();
    bench.now = Time::from_us(3_600_000_000);
    bench.run(5);
    bench.send(Event::Command(Command::ClearFault));
    bench.arm();
    bench.send(Event::Trigger);
    bench.run(100);
    let [first, second] = bench.records()[..] else {
        panic!();
    };
    assert!(first.faults.contains(Fault::Clock));
    assert!(!second.faults.contains(Fault::Clock));
}

#[test]
fn shutter_open_across_a_long_round_is_told_to_close() {
    // One round of 0.2 s: given up at once, neither told to close nor `ShutterLong` in its own record.
    let mut bench = exposing_for(1.0 / 300.0);
    bench.edges.clear();
    bench.now = bench.now.plus_s(0.2);
    bench.run(60);
    let record = bench.records()[0];
    assert_eq!(
        (closes(&bench), record.faults.contains(Fault::ShutterLong)),
        (1, true)
    );
}

// Degraded modes that are not reached, or left.

#[test]
fn dead_encoder_leaves_static_correction() {
    // A drive whose `position` fails says so in every round; each time `fail` goes from degraded to fault again.
    let mut bench = Bench::armed();
    bench.is_read = false;
    let dead = |bench: &mut Bench, rounds: u32| {
        for _ in 0..rounds {
            bench.send(Event::Drive(Fault::Encoder));
            bench.round();
        }
    };
    dead(&mut bench, 200);
    for _ in 0..10 {
        bench.send(Event::Trigger);
        dead(&mut bench, 97);
    }
    let counts = bench.controller.counts();
    assert!(counts.exposed > 5, "{counts:?}");
}

#[test]
fn late_round_with_a_trigger_is_no_lost_place() {
    // The profile begins 1 ms after the trigger's stamp, in the past: a step of the set point, of which the stage (2 m/s²)
    // makes good what it can. Named encoder; the place is lost.
    let mut bench = Bench::armed();
    let start_mm = bench.place_mm();
    let trigger = bench.now.plus_s(0.000_01);
    bench.now = bench.now.plus_s(0.0055);
    bench.send_at(trigger, Event::Trigger);
    let began = bench.now;
    for _ in 0..6 {
        let time_s = bench.now.seconds_since(began);
        let target_mm = bench.place_mm();
        let stage_mm = target_mm.min(start_mm + 0.5 * 2000.0 * time_s * time_s);
        let offset_mm = stage_mm;
        let reading = StageReading {
            time: bench.now,
            offset_mm,
        };
        bench.send(Event::Stage(reading));
        bench.send(Event::Tick);
        bench.now = bench.now.plus_s(0.001);
    }
    assert_ne!(bench.controller.state(), State::Fault(Fault::Encoder));
}

#[test]
fn tdi_camera_disarmed_in_a_brown_out_is_disarmed() {
    // `resume` without a stage is armed at once and leaves `is_disarming` standing.
    let mut bench = Bench::with(&tdi(), FlightSettings::default(), Start::Orderly);
    bench.arm();
    bench.send(Event::Supply(Supply::Low));
    bench.send(Event::Command(Command::Disarm));
    bench.send(Event::Supply(Supply::Good));
    bench.run(5);
    bench.send(Event::Trigger);
    bench.run(60);
    assert_eq!(
        bench.records()[0].outcome,
        Outcome::Refused(Reason::NotArmed)
    );
}

#[test]
fn stage_of_a_camera_disarmed_in_a_brown_out_stays() {
    let mut bench = Bench::armed();
    bench.send(Event::Supply(Supply::Low));
    bench.send(Event::Command(Command::Disarm));
    bench.run(5);
    bench.send(Event::Supply(Supply::Good));
    bench.round();
    assert_eq!(bench.controller.state(), State::Standby);
    assert!(bench.controller.setpoint(bench.now).is_none());
}

#[test]
fn tdi_camera_overloaded_in_its_run_up_is_degraded() {
    // `call_off` asks `ready()` before `degraded` is set.
    let mut bench = Bench::with(&tdi(), FlightSettings::default(), Start::Orderly);
    bench.arm();
    late_round(&mut bench);
    late_round(&mut bench);
    bench.send(Event::Trigger);
    late_round(&mut bench);
    assert_eq!(
        bench.records()[0].outcome,
        Outcome::Refused(Reason::Fault(Fault::Overload))
    );
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Overload));
}

#[test]
fn three_late_rounds_in_two_seconds_are_no_overload() {
    // `late_since` moves with every late round: the window is a chain, not [`OVERLOAD_WINDOW_S`].
    let mut bench = Bench::armed();
    for _ in 0..3 {
        late_round(&mut bench);
        bench.run(900);
    }
    bench.run(1);
    assert_eq!(bench.controller.state(), State::Armed);
}

// What a record says.

#[test]
fn attitude_that_cannot_be_used_is_not_in_the_smear() {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run(15);
    bench.send(Event::Attitude(AttitudeSample {
        pitch_deg: f32::NAN,
        roll_deg: 0.0,
        drift_deg: 0.0,
        rates_deg_s: [0.0; 3],
    }));
    bench.run(100);
    assert!(!bench.records()[0].flags.contains(Flag::WithAttitude));
}

#[test]
fn shutter_that_opens_before_its_command_is_not_opened_again() {
    // The command waits at the board for another 1.7 ms; nothing takes it back.
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Tracking);
    bench.edges.clear();
    bench.send(Event::Shutter(ShutterEdge::Opened));
    bench.round();
    assert_eq!(closes(&bench), 1, "{:?}", bench.actions);
}

#[test]
fn exposure_cut_by_a_clock_jump_is_not_measured() {
    // As `clock_that_jumps_ends_the_frame_and_is_a_fault`, one round later: the last light is an assumption, the path up
    // to it "continued", σ 30 nm.
    let mut bench = exposing_for(1.0 / 300.0);
    bench.run(1);
    bench.edges.clear();
    bench.now = Time::from_us(3_600_000_000);
    bench.run(5);
    let record = bench.records()[0];
    assert!(
        record.flags.contains(Flag::StaticCorrection),
        "σ {} mm, flags {:?}",
        exposed(&record).principal_point_sigma_mm,
        record.flags.iter().collect::<Vec<_>>()
    );
}

#[test]
fn round_before_the_one_before_is_a_jump_of_the_clock() {
    // Stamps of interrupts may be 10 ms old; rounds come in order.
    let mut bench = Bench::armed();
    bench.now = bench.now.plus_s(-0.006);
    bench.round();
    assert_eq!(bench.controller.state(), State::Fault(Fault::Clock));
}

#[test]
fn attitude_of_a_camera_flown_backwards_is_about_its_own_axes() {
    // Rates are about the camera's axes, the camera is not turned: in flight against the axis they act the other way.
    // (If the sample is meant about the axes of the flight, its comment and that of `Attitude` are wrong instead.)
    let smear_px = |direction, pitch_rate_deg_s| {
        let mut bench = Bench::new(FlightSettings {
            direction,
            ..FlightSettings::default()
        });
        bench.arm();
        bench.send(Event::Drive(Fault::Drive));
        bench.run_until(200, |it| it == State::Degraded(Fault::Drive));
        bench.send(Event::Attitude(AttitudeSample {
            pitch_deg: 0.0,
            roll_deg: 0.0,
            drift_deg: 0.0,
            rates_deg_s: [pitch_rate_deg_s, 0.0, 0.0],
        }));
        bench.send(Event::Trigger);
        bench.run(100);
        exposed(&bench.records()[0]).smear_px
    };
    let ahead = [1.0, -1.0].map(|rate| smear_px(FlightDirection::Forward, rate));
    let back = [1.0, -1.0].map(|rate| smear_px(FlightDirection::Reverse, rate));
    assert!((ahead[0] - ahead[1]).abs() > 1.0);
    assert!(
        (back[0] - ahead[1]).abs() < 0.01 && (back[1] - ahead[0]).abs() < 0.01,
        "ahead {ahead:?} px, back {back:?} px"
    );
}

#[cfg(feature = "link")]
mod link {
    use super::*;
    use fmc_camera::io::link::deck::{FlightDeck, RigDeck};

    #[test]
    fn watchdog_is_not_forgotten_by_preparing_twice() {
        // `RigDeck::prepare` spends its start on the first controller; the second knows nothing, and no record does.
        let mut deck = RigDeck::new(Start::AfterWatchdog);
        deck.prepare(&camera(), 1, &FlightSettings::default())
            .unwrap();
        deck.prepare(&camera(), 1, &FlightSettings::default())
            .unwrap();
        assert_eq!(
            deck.controller().unwrap().state(),
            State::Fault(Fault::Watchdog)
        );
    }
}
