//! Faults of the stage and its encoder: the state to which each leads, its code, and the frame's
//! outcome.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::{Action, Command, Event, Supply};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;

use crate::controller::bench::{Bench, acted, exposed, in_state, only};

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
    // 33.3 µm, and 1.8 µm for V/H, relief and attitude, which are uncertain.
    assert!((frame.smear_um - 35.1).abs() < 1.0, "{}", frame.smear_um);
    assert!(frame.interior.motion.travel_mm.abs() < 1e-6);
    let place = frame.interior.motion.centroid_mm;
    // The released stage is on one of the flanks of its play.
    let half_play_mm = 0.5e-3 * DriveSettings::default().play_um;
    assert!((place - bench.stage.offset_mm - half_play_mm).abs() < 1e-6);
    let sigma = frame.principal_point_sigma;
    // A released stage may have lost a step of 13.5 µm either way since the index mark was crossed.
    let expected_mm = libm::hypotf(half_play_mm, 0.0135 / libm::sqrtf(3.0));
    assert!(
        (1.0..1.03).contains(&(sigma.common_mm / expected_mm)),
        "{sigma:?}"
    );
    // Once the fault is cleared and the camera armed, there is compensation again.
    bench.stage_follows = true;
    bench.send(Event::Command(Command::ClearFault));
    assert_eq!(bench.camera.controller().state(), State::Standby);
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
        assert_eq!(bench.camera.controller().state(), State::Fault(fault));
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
fn lost_place_leads_to_static_correction_with_a_sigma_that_says_so() {
    let mut bench = in_state(State::Exposing);
    bench.send(Event::Drive(Fault::Encoder));
    bench.run(100);
    let record = only(&bench);
    assert!(record.flags.contains(Flag::PlannedMotion));
    assert!(record.flags.contains(Flag::StaticCorrection));
    // Half of the stroke, which is wrong by the same in all frames until the place is found again.
    let sigma = exposed(&record).principal_point_sigma;
    assert_eq!((sigma.frame_mm, sigma.common_mm), (0.0, 2.0));
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Encoder)
    );
}

#[test]
fn readings_that_are_missing_concern_their_own_frame() {
    let mut bench = in_state(State::Exposing);
    bench.edges.clear();
    bench.now = Time::from_us(3_600_000_000);
    bench.run(5);
    let record = only(&bench);
    assert!(record.flags.contains(Flag::PlannedMotion));
    let sigma = exposed(&record).principal_point_sigma;
    assert_eq!((sigma.frame_mm, sigma.common_mm), (2.0, 0.0));
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
    assert!((exposed(&record).principal_point_sigma.total_mm() - 2.0).abs() < 1e-6);
    assert!(exposed(&record).smear_um > 2000.0);
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::WrongDirection)
    );
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Arm));
    bench.run(100);
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Encoder)
    );
    bench.send(Event::Trigger);
    bench.run(100);
    let standing = *bench.records().last().unwrap();
    // A stage without force stands: its place is not known, but it does not smear.
    assert!((exposed(&standing).principal_point_sigma.total_mm() - 2.0).abs() < 1e-6);
    assert!(exposed(&standing).smear_um < 100.0);
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Referenced));
    bench.arm();
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
        assert_eq!(standby.camera.controller().state(), State::Standby);
        standby.send(Event::Command(Command::Arm));
        let stays = |mut bench: Bench| {
            for _ in 0..500 {
                bench.round();
                assert_eq!(bench.camera.controller().setpoint(bench.now), None, "force");
            }
            assert_eq!(bench.camera.controller().state(), State::Degraded(fault));
            let announced = bench.actions.iter();
            let announced = announced.filter(|(_, it)| *it == Action::Fault(fault));
            assert_eq!(announced.count(), 1);
            bench.send(Event::Command(Command::ClearFault));
            if fault == Fault::Encoder {
                // The place of the stage is still lost.
                bench.send(Event::Command(Command::Arm));
                bench.run(500);
                assert_eq!(bench.camera.controller().state(), State::Degraded(fault));
                assert_eq!(bench.camera.controller().setpoint(bench.now), None, "force");
                bench.send(Event::Command(Command::Disarm));
                bench.send(Event::Command(Command::Referenced));
            }
            bench.arm();
        };
        stays(without_supply);
        stays(standby);
    }
}
