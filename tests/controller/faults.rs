//! Faults by name: the state to which each leads, its code, and the frame's outcome.

use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge, Supply};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;

use crate::controller::bench::{Bench, camera};

/// Returns a camera in a state after a trigger.
fn in_state(state: State) -> Bench {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == state);
    bench
}

fn only(bench: &Bench) -> FrameRecord {
    let [record] = bench.records()[..] else {
        panic!("{:?}", bench.records());
    };
    record
}

fn exposed(record: &FrameRecord) -> ExposedFrame {
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    frame
}

fn acted(bench: &Bench, action: Action) -> bool {
    bench.actions.iter().any(|(_, it)| *it == action)
}

#[test]
fn stall_before_the_shutter_refuses_the_frame_and_goes_on_without_compensation() {
    let mut bench = in_state(State::RunUp);
    bench.run(5);
    bench.stage_follows = false;
    bench.run_until(20, |state| state == State::Fault(Fault::Stall));
    assert!(acted(&bench, Action::ReleaseStage));
    assert_eq!(
        only(&bench).outcome,
        Outcome::Refused(Reason::Fault(Fault::Stall))
    );
    // The stage stands: the pilot gets images without compensation, and the state says so.
    bench.run_until(100, |state| state == State::Degraded(Fault::Stall));
    bench.send(Event::Trigger);
    bench.run(100);
    let record = bench.records()[1];
    assert!(record.flags.contains(Flag::NoCompensation) && record.faults.contains(Fault::Stall));
    let frame = exposed(&record);
    assert!(record.flags.contains(Flag::SmearOverBudget));
    assert!((frame.smear_um - 33.3).abs() < 1.0, "{}", frame.smear_um);
    assert!(frame.interior.motion.travel_mm.abs() < 1e-6);
    let place = frame.interior.motion.centroid_mm;
    assert!((place - bench.stage.offset_mm).abs() < 1e-6);
    // Once the fault is cleared and the camera armed, there is compensation again.
    bench.stage_follows = true;
    bench.send(Event::Command(Command::ClearFault));
    assert_eq!(bench.controller.state(), State::Standby);
    bench.arm();
}

#[test]
fn stall_while_the_shutter_is_open_is_measured() {
    let mut bench = in_state(State::Exposing);
    bench.stage_follows = false;
    bench.run(60);
    let record = only(&bench);
    let frame = exposed(&record);
    // The path is the one that the encoder measured: the record is right, and its smear is not
    // small.
    assert!(frame.interior.motion.travel_mm < 0.03);
    assert!(frame.smear_px > 0.5, "{}", frame.smear_px);
    assert!(record.flags.contains(Flag::SmearOverBudget));
}

#[test]
fn stalls_show_within_five_milliseconds_at_every_speed() {
    for vh_per_s in [0.05, 0.1, 0.17] {
        let mut bench = Bench::armed();
        bench.vh_per_s = Some(vh_per_s);
        bench.run(2000);
        bench.send(Event::Trigger);
        bench.run_until(100, |it| it == State::Tracking);
        bench.stage_follows = false;
        let rounds = bench.run_until(20, |state| state == State::Fault(Fault::Stall));
        assert!(rounds <= 5, "V/H {vh_per_s}: {rounds} ms");
    }
}

#[test]
fn limit_switch_and_drive_release_the_stage() {
    for (event, fault) in [
        (Event::LimitSwitch, Fault::LimitSwitch),
        (Event::Drive(Fault::Drive), Fault::Drive),
    ] {
        let mut bench = in_state(State::RunUp);
        bench.send(event);
        assert_eq!(bench.controller.state(), State::Fault(fault));
        assert!(acted(&bench, Action::ReleaseStage) && acted(&bench, Action::Fault(fault)));
        assert_eq!(only(&bench).outcome, Outcome::Refused(Reason::Fault(fault)));
        bench.send(Event::Trigger);
        assert_eq!(
            bench.records()[1].outcome,
            Outcome::Refused(Reason::Fault(fault))
        );
    }
}

#[test]
fn shutter_told_to_open_is_told_to_stay_closed_when_the_stage_fails() {
    let mut bench = in_state(State::Tracking);
    bench.send(Event::LimitSwitch);
    assert!(acted(&bench, Action::CloseShutter));
}

#[test]
fn lost_place_leads_to_static_correction_with_a_sigma_that_says_so() {
    let mut bench = in_state(State::Exposing);
    bench.send(Event::Drive(Fault::Encoder));
    bench.run(100);
    let record = only(&bench);
    assert!(record.flags.contains(Flag::PlannedMotion));
    assert!(record.flags.contains(Flag::StaticCorrection));
    assert!((exposed(&record).principal_point_sigma_mm - 2.0).abs() < 1e-6);
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Encoder));
}

#[test]
fn encoder_that_may_be_the_wrong_way_round_has_lost_the_place() {
    let mut bench = in_state(State::Exposing);
    bench.send(Event::Drive(Fault::WrongDirection));
    bench.run(100);
    let record = only(&bench);
    assert!(record.flags.contains(Flag::StaticCorrection));
    // A stage that had force on it may be anywhere: σ is half of the stroke, and the smear as
    // large.
    assert!((exposed(&record).principal_point_sigma_mm - 2.0).abs() < 1e-6);
    assert!(exposed(&record).smear_um > 2000.0);
    assert_eq!(
        bench.controller.state(),
        State::Degraded(Fault::WrongDirection)
    );
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Arm));
    bench.run(100);
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Encoder));
    bench.send(Event::Trigger);
    bench.run(100);
    let standing = *bench.records().last().unwrap();
    // A stage without force stands: its place is not known, but it does not smear.
    assert!((exposed(&standing).principal_point_sigma_mm - 2.0).abs() < 1e-6);
    assert!(exposed(&standing).smear_um < 100.0);
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Referenced));
    bench.arm();
}

#[test]
fn late_edge_is_exposed_and_says_so() {
    let mut bench = Bench::armed();
    bench.shutter_late_s = 0.0025;
    bench.send(Event::Trigger);
    bench.run(100);
    let record = only(&bench);
    assert!(record.faults.contains(Fault::ShutterLate));
    assert!(acted(&bench, Action::Fault(Fault::ShutterLate)));
    // 2.5 ms at 10 mm/s: the record has the principal point as measured, not as planned.
    assert!((exposed(&record).interior.motion.centroid_mm - 0.025).abs() < 2e-4);
}

#[test]
fn missing_edge_refuses_the_frame_and_one_that_comes_after_all_is_reported() {
    let mut bench = Bench::armed();
    bench.shutter_obeys = false;
    bench.send(Event::Trigger);
    bench.run(100);
    let record = only(&bench);
    assert_eq!(record.outcome, Outcome::Refused(Reason::ShutterMissing));
    assert!(record.faults.contains(Fault::ShutterMissing));
    assert_eq!(bench.controller.state(), State::Armed);
    bench.actions.clear();
    bench.send(Event::Shutter(ShutterEdge::Opened));
    assert!(acted(&bench, Action::Fault(Fault::ShutterUnexpected)));
    assert!(acted(&bench, Action::CloseShutter));
    assert_eq!(bench.controller.counts().unexpected_edges, 1);
    // The fault is in the next record.
    bench.shutter_obeys = true;
    bench.send(Event::Trigger);
    bench.run(100);
    assert!(bench.records()[1].faults.contains(Fault::ShutterUnexpected));
}

#[test]
fn double_edges_are_reported_and_the_first_pair_counts() {
    let mut bench = in_state(State::Exposing);
    let opened = bench.now;
    bench.send(Event::Shutter(ShutterEdge::Opened));
    bench.run(60);
    let record = only(&bench);
    assert!(record.faults.contains(Fault::ShutterUnexpected));
    assert!(exposed(&record).opened <= opened);
}

#[test]
fn short_and_long_exposures_are_as_long_as_they_were() {
    for (closed_us, fault) in [(1500, Fault::ShutterShort), (9000, Fault::ShutterLong)] {
        let mut bench = in_state(State::Exposing);
        let opened = bench.actions.iter().find_map(|(_, action)| match action {
            Action::OpenShutter { at, .. } => Some(at.plus_s(0.002)),
            _ => None,
        });
        let closed = Time::from_us(opened.unwrap().us() + closed_us);
        bench.edges = vec![(closed, ShutterEdge::Closed)];
        bench.run(60);
        let record = only(&bench);
        assert!(record.faults.contains(fault), "{record:?}");
        let exposure_s = exposed(&record).interior.exposure_s;
        #[expect(clippy::cast_precision_loss, reason = "small")]
        let expected_s = 1e-6 * closed_us as f32;
        assert!((exposure_s - expected_s).abs() < 1e-8);
    }
}

#[test]
fn shutter_that_does_not_close_is_given_up_with_a_record() {
    let mut bench = in_state(State::Exposing);
    bench.edges.clear();
    bench.run_until(100, |it| it == State::Fault(Fault::ShutterLong));
    assert!(acted(&bench, Action::CloseShutter));
    let record = only(&bench);
    assert!(record.faults.contains(Fault::ShutterLong));
    // The time for which it was open is not known: the frame says so, in its flag and in its σ.
    assert!(record.flags.contains(Flag::LastLightAssumed));
    let frame = exposed(&record);
    assert!((frame.interior.exposure_s - 1.0 / 300.0).abs() < 1e-6);
    assert!(frame.principal_point_sigma_mm > 0.03);
}

#[test]
fn triggers_during_a_frame_are_refused_each_with_its_record() {
    for state in [
        State::RunUp,
        State::Tracking,
        State::Exposing,
        State::FlyBack,
    ] {
        let mut bench = in_state(state);
        // Two edges between two ticks are two events.
        bench.send(Event::Trigger);
        bench.send(Event::Trigger);
        bench.run(100);
        let outcomes: Vec<_> = bench.records().iter().map(|it| it.outcome).collect();
        assert!(matches!(outcomes[0], Outcome::Exposed(_)));
        assert_eq!(outcomes[1..], [Outcome::Refused(Reason::Overlap); 2]);
    }
}

#[test]
fn low_supply_releases_the_stage_until_it_is_good() {
    let mut bench = in_state(State::RunUp);
    bench.send(Event::Supply(Supply::Low));
    assert_eq!(bench.controller.state(), State::Fault(Fault::BrownOut));
    bench.run(200);
    assert_eq!(bench.controller.state(), State::Fault(Fault::BrownOut));
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
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Encoder));
    assert_eq!(bench.controller.setpoint(bench.now), None, "force");
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
    assert_eq!(bench.controller.state(), State::Fault(Fault::Watchdog));
    bench.send(Event::Trigger);
    assert_eq!(
        only(&bench).outcome,
        Outcome::Refused(Reason::Fault(Fault::Watchdog))
    );
    bench.run(1);
    // The last command to the shutter is not known.
    assert!(acted(&bench, Action::CloseShutter));
    // The encoder's count is lost, and without a reference there is no compensation.
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Arm));
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Encoder));
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
    // The smear is bounded by the largest V/H at which the camera may fly: 17 mm/s for 1/300 s.
    assert!((frame.smear_um - 56.7).abs() < 1.0, "{}", frame.smear_um);
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
    assert!((vh.age_s - 2.0).abs() < 0.01 && vh.sigma_per_s > 0.001);
}

#[test]
fn late_rounds_are_counted_and_too_many_lead_to_no_compensation() {
    let mut bench = Bench::armed();
    bench.now = bench.now.plus_s(0.004);
    bench.run(10);
    assert_eq!(bench.controller.counts().late_ticks, 1);
    assert_eq!(bench.controller.state(), State::Armed);
    for _ in 0..3 {
        bench.now = bench.now.plus_s(0.004);
        bench.round();
    }
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Overload));
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
    assert_eq!(bench.controller.counts().late_ticks, 5);
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
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Overload));
}

#[test]
fn clock_that_jumps_ends_the_frame_and_is_a_fault() {
    for state in [State::RunUp, State::Exposing] {
        for now in [Time::from_us(10), Time::from_us(3_600_000_000)] {
            let mut bench = in_state(state);
            bench.edges.clear();
            bench.now = now;
            bench.run(5);
            assert_eq!(bench.controller.state(), State::Fault(Fault::Clock));
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
fn supply_that_comes_back_does_not_move_a_stage_that_has_failed() {
    let mut bench = in_state(State::RunUp);
    bench.send(Event::Drive(Fault::Drive));
    bench.run_until(100, |state| state == State::Degraded(Fault::Drive));
    bench.send(Event::Supply(Supply::Low));
    assert_eq!(bench.controller.state(), State::Fault(Fault::BrownOut));
    bench.send(Event::Supply(Supply::Good));
    bench.run(500);
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Drive));
    assert_eq!(bench.controller.setpoint(bench.now), None, "force");
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
    assert_eq!(bench.controller.counts().late_ticks, 3);
    bench.run(100);
    bench.send(Event::Trigger);
    bench.run(3000);
    assert_eq!(bench.controller.state(), State::Degraded(Fault::Drive));
}

#[test]
fn stage_that_fails_without_force_is_not_moved_until_it_is_cleared() {
    for fault in [Fault::Encoder, Fault::Drive, Fault::LimitSwitch] {
        let event = match fault {
            Fault::LimitSwitch => Event::LimitSwitch,
            fault => Event::Drive(fault),
        };
        // The encoder loses its count with the supply.
        let mut without_supply = Bench::armed();
        without_supply.send(Event::Supply(Supply::Low));
        without_supply.send(event);
        without_supply.send(Event::Supply(Supply::Good));
        let mut standby = Bench::new(FlightSettings::default());
        standby.run(2);
        standby.send(event);
        standby.send(event);
        assert_eq!(standby.controller.state(), State::Standby);
        standby.send(Event::Command(Command::Arm));
        let stays = |mut bench: Bench| {
            for _ in 0..500 {
                bench.round();
                assert_eq!(bench.controller.setpoint(bench.now), None, "force");
            }
            assert_eq!(bench.controller.state(), State::Degraded(fault));
            let announced = bench.actions.iter();
            let announced = announced.filter(|(_, it)| *it == Action::Fault(fault));
            assert_eq!(announced.count(), 1);
            bench.send(Event::Command(Command::ClearFault));
            if fault == Fault::Encoder {
                // The place of the stage is still lost.
                bench.send(Event::Command(Command::Arm));
                bench.run(500);
                assert_eq!(bench.controller.state(), State::Degraded(fault));
                assert_eq!(bench.controller.setpoint(bench.now), None, "force");
                bench.send(Event::Command(Command::Disarm));
                bench.send(Event::Command(Command::Referenced));
            }
            bench.arm();
        };
        stays(without_supply);
        stays(standby);
    }
}
