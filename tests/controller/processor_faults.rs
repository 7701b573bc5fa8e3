//! Faults of supply, processor, clock and V/H: the state, the code and the outcome.

use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Action, Command, Event, Supply};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;

use crate::controller::bench::{Bench, acted, camera, exposed, in_state, only};

#[test]
fn low_supply_releases_the_stage_until_it_is_good() {
    let mut bench = in_state(State::RunUp);
    bench.send(Event::Supply(Supply::Low));
    assert_eq!(
        bench.camera.controller().state(),
        State::Fault(Fault::BrownOut)
    );
    bench.run(200);
    assert_eq!(
        bench.camera.controller().state(),
        State::Fault(Fault::BrownOut)
    );
    bench.send(Event::Supply(Supply::Good));
    bench.run_until(500, |state| state == State::Armed);
}

#[test]
fn encoder_that_does_not_survive_low_supply_is_referenced_before_the_stage_moves() {
    let mut bench = Bench::new(FlightSettings {
        encoder_survives_brown_out: false,
        ..FlightSettings::default()
    });
    bench.arm();
    bench.send(Event::Supply(Supply::Low));
    bench.send(Event::Supply(Supply::Good));
    bench.run(500);
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Encoder)
    );
    assert_eq!(bench.camera.controller().setpoint(bench.now), None, "force");
    bench.send(Event::Trigger);
    bench.run(100);
    assert!(only(&bench).flags.contains(Flag::StaticCorrection));
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Referenced));
    bench.arm();
}

#[test]
fn watchdog_begins_in_its_fault_and_is_in_the_next_record() {
    let mut bench = Bench::with(&camera(), FlightSettings::default(), Start::AfterWatchdog);
    assert_eq!(
        bench.camera.controller().state(),
        State::Fault(Fault::Watchdog)
    );
    bench.send(Event::Trigger);
    assert_eq!(
        only(&bench).outcome,
        Outcome::Refused(Reason::Fault(Fault::Watchdog))
    );
    // A trigger that is refused at once leaves the fault to the next frame.
    assert!(only(&bench).faults.is_empty());
    bench.run(1);
    // The last command to the shutter is not known.
    assert!(acted(&bench, Action::CloseShutter));
    // The encoder's count is lost, and without a reference there is no compensation.
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Arm));
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Encoder)
    );
    bench.send(Event::Command(Command::Disarm));
    bench.send(Event::Command(Command::Referenced));
    bench.arm();
    bench.send(Event::Trigger);
    bench.run(100);
    assert!(bench.records()[1].faults.contains(Fault::Watchdog));
}

#[test]
fn lost_vh_leads_to_frames_without_compensation_and_recovers() {
    let mut bench = Bench::armed();
    bench.vh_per_s = None;
    bench.run_until(20_000, |state| state == State::Degraded(Fault::VhLost));
    bench.send(Event::Trigger);
    bench.run(100);
    let record = only(&bench);
    assert!(record.flags.contains(Flag::NoCompensation) && record.faults.contains(Fault::VhLost));
    let frame = exposed(&record);
    assert_eq!(frame.vh, None);
    // The smear is bounded by the largest V/H at which the camera may fly, 30 mm/s for 1/300 s, and
    // 2.6 µm for the relief and the attitude, which are not known.
    assert!((frame.smear_um - 102.6).abs() < 2.0, "{}", frame.smear_um);
    bench.vh_per_s = Some(0.1);
    bench.run_until(50, |state| state == State::Armed);
}

#[test]
fn silent_source_is_bridged_with_the_last_good_vh() {
    let mut bench = Bench::armed();
    bench.vh_per_s = None;
    bench.run(2000);
    bench.send(Event::Trigger);
    bench.run(100);
    let record = only(&bench);
    assert!(record.flags.contains(Flag::LastGoodVh));
    let vh = exposed(&record).vh.unwrap();
    // 2 s since its arrival, 0.1 s of latency, 0.019 s from trigger to centroid.
    assert!((vh.age_s - 2.119).abs() < 0.01 && vh.sigma_per_s > 0.001);
}

#[test]
fn late_rounds_are_counted_and_too_many_lead_to_no_compensation() {
    let mut bench = Bench::armed();
    bench.now = bench.now.plus_s(0.004);
    bench.run(10);
    assert_eq!(bench.camera.controller().counts().late_ticks, 1);
    assert_eq!(bench.camera.controller().state(), State::Armed);
    for _ in 0..3 {
        bench.now = bench.now.plus_s(0.004);
        bench.round();
    }
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Overload)
    );
    bench.send(Event::Trigger);
    bench.run(100);
    let record = only(&bench);
    assert!(record.flags.contains(Flag::NoCompensation));
    assert!(record.faults.contains(Fault::Overload));
    bench.run_until(2000, |state| state == State::Armed);
}

#[test]
fn late_rounds_of_standby_are_counted_and_nothing_follows_from_them() {
    let mut bench = Bench::new(FlightSettings::default());
    bench.run(2);
    for _ in 0..5 {
        bench.now = bench.now.plus_s(0.004);
        bench.round();
    }
    bench.send(Event::Command(Command::Arm));
    bench.run_until(2000, |state| state == State::Armed);
    assert_eq!(bench.camera.controller().counts().late_ticks, 5);
    assert!(!acted(&bench, Action::Fault(Fault::Overload)));
    bench.send(Event::Trigger);
    bench.run(100);
    let record = only(&bench);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    assert!(!record.flags.contains(Flag::NoCompensation));
    // Once the camera is armed, late rounds count again.
    bench.run_until(2000, |state| state == State::Armed);
    for _ in 0..3 {
        bench.now = bench.now.plus_s(0.004);
        bench.round();
    }
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Overload)
    );
}

#[test]
fn clock_that_jumps_ends_the_frame_and_is_a_fault() {
    for state in [State::RunUp, State::Exposing] {
        for now in [Time::from_us(10), Time::from_us(3_600_000_000)] {
            let mut bench = in_state(state);
            bench.edges.clear();
            bench.now = now;
            bench.run(5);
            assert_eq!(
                bench.camera.controller().state(),
                State::Fault(Fault::Clock)
            );
            let record = only(&bench);
            match state {
                State::Exposing => assert!(record.flags.contains(Flag::StaticCorrection)),
                _ => assert_eq!(
                    record.outcome,
                    Outcome::Refused(Reason::Fault(Fault::Clock))
                ),
            }
        }
    }
}

#[test]
fn instruments_are_forgotten_when_the_clock_jumps() {
    // V/H from before counted as fresh for 100 s, all samples after as from the past, and UTC was
    // 100 s off with the σ of a pulse.
    let mut bench = Bench::new(FlightSettings::default());
    bench.now = Time::from_us(200_000_000);
    bench.arm();
    for second in 0..4 {
        bench.send(Event::TimePulse);
        bench.run(100);
        bench.send(Event::GnssTime(1_800_000_000_000_000 + 1_000_000 * second));
        bench.run(900);
    }
    let trigger = |bench: &mut Bench| {
        bench.send(Event::Trigger);
        bench.run(100);
        *bench.records().last().unwrap()
    };
    assert!(exposed(&trigger(&mut bench)).centroid_utc.is_some());
    bench.now = bench.now.plus_s(-100.0);
    bench.vh_per_s = None;
    bench.run(5);
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Arm));
    bench.run_until(2000, |state| state == State::Degraded(Fault::VhLost));
    bench.vh_per_s = Some(0.12);
    bench.run_until(5, |state| state == State::Armed);
    let record = trigger(&mut bench);
    // There is no index mark.
    assert!(record.flags.iter().eq([Flag::Unreferenced]));
    let frame = exposed(&record);
    assert!((frame.vh.unwrap().vh_per_s - 0.12).abs() < 1e-6);
    assert_eq!(frame.centroid_utc, None);
}

#[test]
fn supply_that_comes_back_does_not_move_a_stage_that_has_failed() {
    let mut bench = in_state(State::RunUp);
    bench.send(Event::Drive(Fault::Drive));
    bench.run_until(100, |state| state == State::Degraded(Fault::Drive));
    bench.send(Event::Supply(Supply::Low));
    assert_eq!(
        bench.camera.controller().state(),
        State::Fault(Fault::BrownOut)
    );
    bench.send(Event::Supply(Supply::Good));
    bench.run(500);
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Drive)
    );
    assert_eq!(bench.camera.controller().setpoint(bench.now), None, "force");
}

#[test]
fn overload_during_a_frame_does_not_hide_a_stage_that_has_failed() {
    let mut bench = in_state(State::RunUp);
    bench.send(Event::Drive(Fault::Drive));
    bench.run_until(100, |state| state == State::Degraded(Fault::Drive));
    for _ in 0..3 {
        bench.send(Event::Trigger);
        bench.now = bench.now.plus_s(0.004);
        bench.round();
    }
    assert_eq!(bench.camera.controller().counts().late_ticks, 3);
    bench.run(100);
    bench.send(Event::Trigger);
    bench.run(3000);
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Drive)
    );
}
