//! A camera on a board in flight.

use fmc_camera::flight::camera::Mechanism;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::step_settings::StepSettings;
use fmc_camera::flight::event::{Command, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome};
use fmc_camera::flight::input_levels::InputLevels;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::link::message::{Answer, Refusal, Request, ResetCause};

use crate::link::board::Board;
use crate::link::pc::camera_parameters;
fn exposed(record: &FrameRecord) -> &ExposedFrame {
    match &record.outcome {
        Outcome::Exposed(frame) => frame,
        Outcome::Refused(reason) => panic!("{}", reason.name()),
    }
}

/// Checks that the exposure is that of the wire to the microsecond, and the travel f·V/H·t to the
/// encoder's step.
fn assert_compensated(record: &FrameRecord) {
    let frame = exposed(record);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    assert!(!record.flags.contains(Flag::NoCompensation));
    assert!(!record.flags.contains(Flag::PlannedMotion));
    assert_eq!(frame.closed.us_since(frame.opened), 3333);
    let travel_mm = 51.3712 * 0.1 * 3.333e-3;
    let off_um = 1e3 * (frame.interior.motion.travel_mm - travel_mm);
    // The line through all readings is off by at most two readings' error of 0.1 µm.
    assert!(off_um.abs() < 0.1, "{off_um} µm");
}

#[test]
fn camera_is_flown_over_the_link_and_by_its_wires_alone() {
    let mut board = Board::prepared_at(0);
    board.round();
    let status = board.status();
    assert_eq!(status.state, State::Standby);
    assert!(
        status.is_place_lost,
        "nobody has said where the stage stands"
    );
    board.command(Command::Arm);
    assert_eq!(board.status().state, State::Degraded(Fault::Encoder));
    board.command(Command::Disarm);

    board.arm();
    assert!(!board.status().is_place_lost);
    board.trigger(300);
    board.trigger(999);
    for sequence in [1, 2] {
        assert_compensated(&board.record(sequence));
    }
    assert_eq!(
        board.pc.ask(&Request::FrameRecord(3)),
        Answer::FrameRecord(None)
    );
    assert_eq!(board.status().kept, 2);
    assert_eq!(board.pc.acknowledge(2), Answer::Kept(0));
    let counts = board.status().counts;
    assert_eq!(
        (counts.triggers, counts.exposed, counts.lost_events),
        (2, 2, 0)
    );
    assert!(board.faults.iter().all(|fault| *fault == Fault::Encoder));

    assert_eq!(
        board.tell(Event::Command(Command::Exposure(5e-3))),
        Answer::Told
    );
    board.trigger(0);
    let record = board.record(3);
    let frame = exposed(&record);
    assert_eq!(frame.closed.us_since(frame.opened), 5000);
}

#[test]
fn counter_that_wraps_between_trigger_and_round_changes_nothing_but_the_times() {
    let mut first = Board::prepared_at(0);
    first.arm();
    let flown_us = first.counter_us;
    first.trigger(300);
    let record = first.record(1);

    // The trigger is stamped 200 µs before the wrap, and the round that takes it comes 100 µs after
    // it.
    let start_us = 0_u32.wrapping_sub(flown_us).wrapping_sub(900);
    let mut second = Board::prepared_at(start_us);
    second.arm();
    second.trigger(300);
    let wrapped = second.record(1);
    assert_eq!(wrapped.trigger.us(), (1 << 32) - 200);
    assert!(exposed(&wrapped).opened.us() > 1 << 32);
    let shift = |time: Time| Time::from_us(time.us() - u64::from(start_us));
    let frame = exposed(&wrapped);
    let shifted = FrameRecord {
        trigger: shift(wrapped.trigger),
        outcome: Outcome::Exposed(ExposedFrame {
            opened: shift(frame.opened),
            closed: shift(frame.closed),
            centroid: shift(frame.centroid),
            ..*frame
        }),
        ..wrapped
    };
    assert_eq!(shifted, record);
}

#[test]
fn time_pulses_by_wire_and_their_utc_over_the_link_date_the_centroid() {
    let mut board = Board::prepared_at(0);
    board.arm();
    // A pulse comes 300 µs into every 1000th millisecond; its UTC is told up to 0.9 s later, the
    // last just before the next pulse.
    let unix_us = 1_700_000_000_000_000;
    let mut first_pulse = None;
    for second in 0..12_u32 {
        let pulse_us = board.counter_us + 300;
        let first_us = *first_pulse.get_or_insert(pulse_us);
        board.stamps.push((pulse_us, Event::TimePulse));
        let told_at = if second % 2 == 0 { 150 } else { 999 };
        for round in 0..1000 {
            if round == told_at {
                let utc = unix_us + u64::from(pulse_us - first_us);
                assert_eq!(board.tell(Event::GnssTime(utc)), Answer::Told);
            }
            if round % 400 == 0 {
                assert_eq!(board.tell(Event::Vh(VhSample::Direct(0.1))), Answer::Told);
            }
            board.round();
        }
    }
    board.trigger(300);
    let record = board.record(1);
    let frame = exposed(&record);
    let utc = frame
        .centroid_utc
        .expect("pulses and times have been consistent");
    let since_pulse_us = frame.centroid.us() - u64::from(first_pulse.unwrap());
    // The pulses are exact, so that only the clock's microsecond is left.
    let off_us = utc.unix_us.abs_diff(unix_us + since_pulse_us);
    assert!(off_us <= 1, "{off_us} µs");
}

#[test]
fn bouncing_trigger_costs_its_own_bounces_and_says_so() {
    let mut board = Board::prepared_at(0);
    board.arm();
    board.trigger(300);
    // The trigger comes in the millisecond of the shutter's opening.
    let stamp = board.counter_us.wrapping_add(500);
    board.stamps.push((stamp, Event::Trigger));
    board.run_until(State::Tracking);
    while !board
        .stamps
        .iter()
        .any(|(_, event)| *event == Event::Shutter(ShutterEdge::Opened))
    {
        board.round();
    }
    board.round();
    let stamp = board.counter_us.wrapping_add(1);
    for bounce in 0..40 {
        board
            .stamps
            .insert(0, (stamp.wrapping_add(bounce), Event::Trigger));
    }
    board.run_until(State::Exposing);
    board.run_until(State::Armed);
    let record = board.record(2);
    let frame = exposed(&record);
    assert_eq!(frame.closed.us_since(frame.opened), 3333);
    assert!(
        record.faults.contains(Fault::Overload),
        "{:?}",
        record.faults
    );
    assert!(board.faults.contains(&Fault::Overload));
    let counts = board.status().counts;
    // These are 2 triggers that were meant, and 4 of the 40 bounces that the queue had room for.
    assert_eq!((counts.triggers, counts.lost_events), (6, 36));
    assert_eq!((counts.exposed, counts.refused), (2, 4));
    assert_eq!((counts.late_ticks, counts.unexpected_edges), (0, 0));
}

#[test]
fn switches_and_supply_are_events_once_when_they_change_and_after_every_prepare() {
    let mut board = Board::prepared_at(0);
    board.levels.limit_low = true;
    for _ in 0..3 {
        board.round();
    }
    assert_eq!(board.faults, [Fault::LimitSwitch]);
    board.levels.limit_high = true;
    board.levels.supply_low = true;
    board.round();
    board.round();
    // The other switch is a separate event, a round later than the supply, for which one round
    // suffices.
    let expected = [Fault::LimitSwitch, Fault::BrownOut, Fault::LimitSwitch];
    assert_eq!(board.faults, expected);
    board.levels = InputLevels::GOOD;
    board.round();
    board.faults.clear();

    board.levels.supply_low = true;
    board.round();
    assert_eq!(board.faults, [Fault::BrownOut]);
    board.faults.clear();
    assert_eq!(board.prepare(), Answer::Prepared);
    board.round();
    assert_eq!(board.faults, [Fault::BrownOut]);
    board.command(Command::Arm);
    assert_eq!(board.status().state, State::Standby, "there is no supply");
    board.levels = InputLevels::GOOD;
    board.round();
    board.arm();
}

#[test]
fn spike_of_one_round_on_a_switch_is_no_closing_and_no_opening() {
    let mut board = Board::prepared_at(0);
    board.arm();
    for _ in 0..5 {
        for is_closed in [true, false] {
            board.levels.limit_high = is_closed;
            board.round();
        }
    }
    // Two switches closed for one round each are not one switch closed for two.
    board.levels.limit_low = true;
    board.round();
    board.levels = InputLevels {
        limit_high: true,
        ..InputLevels::GOOD
    };
    board.round();
    assert_eq!(board.status().state, State::Armed);
    assert_eq!(board.faults, []);
    board.round();
    assert_eq!(board.faults, [Fault::LimitSwitch]);
    // A switch that opens for one round counts as closed throughout.
    board.levels.limit_high = false;
    board.round();
    board.levels.limit_high = true;
    board.round();
    board.round();
    assert_eq!(board.faults, [Fault::LimitSwitch]);
}

#[test]
fn switch_that_is_still_closed_when_faults_are_cleared_keeps_the_stage_without_force() {
    let mut board = Board::prepared_at(0);
    board.arm();
    // A broken wire looks like a closed switch.
    board.levels.limit_high = true;
    board.round();
    board.round();
    assert_eq!(board.status().state, State::Fault(Fault::LimitSwitch));
    board.command(Command::ClearFault);
    board.round();
    assert_eq!(board.status().state, State::Standby);
    board.command(Command::Arm);
    assert_eq!(board.status().state, State::Degraded(Fault::LimitSwitch));
    assert!(!board.deck().drive_mut().powered());

    // With both commands in one round, the closed switch is found in the next round.
    board.tell(Event::Command(Command::ClearFault));
    board.command(Command::Arm);
    board.round();
    assert_eq!(board.status().state, State::Fault(Fault::LimitSwitch));
    assert!(!board.deck().drive_mut().powered());

    // Once the stage is off the switch, the next one that closes is seen.
    board.levels = InputLevels::GOOD;
    board.round();
    board.command(Command::ClearFault);
    board.command(Command::Arm);
    board.run_until(State::Armed);
    board.levels.limit_high = true;
    board.round();
    board.round();
    assert_eq!(board.status().state, State::Fault(Fault::LimitSwitch));
}

#[test]
fn after_the_watchdog_the_shutter_is_closed_and_somebody_must_look() {
    let mut board = Board::connected(ResetCause::Watchdog, 0);
    board.pc.load(&camera_parameters());
    assert_eq!(board.prepare(), Answer::Prepared);
    board.shutter.open(Time::from_us(500), 1.0);
    board.round();
    assert_eq!(board.status().state, State::Fault(Fault::Watchdog));
    assert!(!board.shutter.look(board.counter_us).is_high);
    // The fault remains after the camera is prepared again.
    assert_eq!(board.prepare(), Answer::Prepared);
    board.round();
    assert_eq!(board.status().state, State::Fault(Fault::Watchdog));
    board.command(Command::ClearFault);
    board.arm();
}

#[test]
fn stepper_is_flown_over_the_link_and_its_records_say_that_nothing_is_measured() {
    let mut settings = FlightSettings {
        // Steps of 0.31 µm are a part of the pixel of 3.76 µm.
        smear_budget_px: 1.0,
        ..FlightSettings::default()
    };
    settings.drive.kind = DriveKind::Stepper;
    settings.drive.stepper = StepSettings {
        pulse_rate_hz: 400_000.0,
        max_step_rate_hz: 200_000.0,
        following_sigma_um: 8.0,
        ..StepSettings::default()
    };
    let mut board = Board::driven(ResetCause::PowerOn, 0, None, settings.drive);
    let mut camera = camera_parameters();
    let Mechanism::Stage { max_speed_mm_s, .. } = &mut camera.mechanism else {
        panic!("no stage");
    };
    *max_speed_mm_s = Some(50.0);
    assert!(matches!(board.pc.load(&camera), Answer::Loaded(_)));
    // The board's timer has a rate of its own.
    let mut other = settings;
    other.drive.stepper.pulse_rate_hz = 500_000.0;
    let refused = |board: &mut Board, settings| match board.pc.ask(&Request::Prepare(settings)) {
        Answer::Refused(Refusal::Settings(error)) => error.to_string(),
        answer => panic!("{answer:?}"),
    };
    let told = refused(&mut board, other);
    assert_eq!(told, "pulse_rate_hz = 500000 is outside 400000 to 400000");
    // The camera is faster than its steps.
    other = settings;
    other.drive.stepper.max_step_rate_hz = 100_000.0;
    let told = refused(&mut board, other);
    assert_eq!(told, "max_speed_mm_s = 50 is outside 0.001 to 31.25");

    assert_eq!(board.pc.ask(&Request::Prepare(settings)), Answer::Prepared);
    board.round();
    assert!(board.status().is_place_lost);
    board.arm();
    board.trigger(300);
    let record = board.record(1);
    let flags: Vec<Flag> = record.flags.iter().collect();
    assert_eq!(flags, [Flag::Unreferenced, Flag::NotMeasured]);
    let frame = exposed(&record);
    assert!(frame.principal_point_sigma.common_mm > 0.008);
    let travel_mm = 51.3712 * 0.1 * 3.333e-3;
    let off_um = 1e3 * (frame.interior.motion.travel_mm - travel_mm);
    // Two readings, each to a step of 0.31 µm.
    assert!(off_um.abs() < 0.7, "{off_um} µm");
}
