//! Faults of the shutter, and triggers that come too soon: the state, the code and the outcome.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Action, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Outcome, Reason};
use fmc_camera::flight::time::Time;

use crate::controller::bench::{Bench, acted, exposed, in_state, only};

#[test]
fn shutter_told_to_open_is_told_to_stay_closed_when_the_stage_fails() {
    let mut bench = in_state(State::Tracking);
    bench.send(Event::LimitSwitch);
    assert!(acted(&bench, Action::CloseShutter));
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
    assert_eq!(bench.camera.controller().state(), State::Armed);
    bench.actions.clear();
    bench.send(Event::Shutter(ShutterEdge::Opened));
    assert!(acted(&bench, Action::Fault(Fault::ShutterUnexpected)));
    assert!(acted(&bench, Action::CloseShutter));
    assert_eq!(bench.camera.controller().counts().unexpected_edges, 1);
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

/// A bounce of an opening edge that was missed is first light, later and shorter by as much than a
/// healthy exposure.
#[test]
fn exposure_that_is_as_late_as_it_is_short_has_what_may_be_missing_of_it_in_sigma() {
    let frame_um = |late_us: u16, shorter_us: u64| {
        let mut bench = Bench::armed();
        bench.shutter_late_s = 1e-6 * f32::from(late_us);
        bench.send(Event::Trigger);
        bench.run_until(100, |state| state == State::Exposing);
        for (time, _) in &mut bench.edges {
            *time = Time::from_us(time.us() - shorter_us);
        }
        bench.run(60);
        let record = only(&bench);
        assert!(record.faults.is_empty(), "{:?}", record.faults);
        1e3 * exposed(&record).principal_point_sigma.frame_mm
    };
    // By hand: a quarter of a millisecond at 10 mm/s, less 4 µs of the stamps.
    assert!(
        (frame_um(500, 500) - 2.48).abs() < 0.02,
        "{}",
        frame_um(500, 500)
    );
    for (late_us, shorter_us) in [(0, 0), (500, 0), (0, 500), (500, 3)] {
        let found_um = frame_um(late_us, shorter_us);
        assert!(found_um < 0.1, "{late_us}, {shorter_us}: {found_um}");
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
    assert!(frame.principal_point_sigma.total_mm() > 0.03);
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
