//! The steps of the bring-up in `docs/integration.md`, section 4, and the times in its section 2.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Flags, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::vh::VhSample;

use crate::controller::bench::{Bench, settings};

#[test]
fn edges_by_hand_in_standby_are_counted_and_every_trigger_has_its_record() {
    let mut bench = Bench::new(FlightSettings::default());
    bench.run(2);
    for edge in [ShutterEdge::Opened, ShutterEdge::Closed] {
        bench.send(Event::Trigger);
        bench.send(Event::Shutter(edge));
        bench.run(10);
    }
    assert_eq!(bench.camera.controller().state(), State::Standby);
    assert_eq!(
        bench.camera.controller().setpoint(bench.now),
        None,
        "no force"
    );
    assert_eq!(bench.camera.controller().counts().unexpected_edges, 2);
    let outcomes: Vec<_> = bench.records().iter().map(|it| it.outcome).collect();
    assert_eq!(outcomes, [Outcome::Refused(Reason::NotArmed); 2]);
}

#[test]
fn first_exposure_needs_no_vh_and_the_next_is_compensated() {
    let mut bench = Bench::new(settings());
    bench.vh_per_s = None;
    bench.run(2);
    bench.send(Event::Command(Command::Arm));
    bench.run(5);
    bench.send(Event::Trigger);
    bench.run_until(2000, |it| it == State::Degraded(Fault::VhLost));
    assert!(
        bench.camera.controller().setpoint(bench.now).is_some(),
        "under force"
    );
    bench.send(Event::Trigger);
    // The stage has stood still: after the exposure it crosses its index mark.
    bench.run(200);
    bench.vh_per_s = Some(0.1);
    bench.run_until(10, |it| it == State::Armed);
    bench.send(Event::Trigger);
    bench.run(100);
    let [while_arming, standing, compensated] = bench.records()[..] else {
        panic!("{:?}", bench.records());
    };
    assert_eq!(while_arming.outcome, Outcome::Refused(Reason::NotArmed));
    assert!(standing.flags.contains(Flag::NoCompensation));
    assert!(matches!(standing.outcome, Outcome::Exposed(_)));
    assert_eq!(compensated.flags, Flags::NONE);
    assert!(matches!(compensated.outcome, Outcome::Exposed(_)));
}

#[test]
fn vh_is_stamped_on_arrival_and_not_when_it_was_measured() {
    for (age_s, state) in [
        (0.0, State::Armed),
        (0.009, State::Armed),
        (0.1, State::Fault(Fault::Clock)),
    ] {
        let mut bench = Bench::armed();
        let stamp = bench.now.plus_s(-age_s);
        bench.send_at(stamp, Event::Vh(VhSample::GroundSpeed(60.0)));
        assert_eq!(bench.camera.controller().state(), state, "{age_s}");
    }
}

#[test]
fn altimeter_that_repeats_itself_on_the_bench_is_lost() {
    for (step_m, state) in [(0.0, State::Degraded(Fault::VhLost)), (0.1, State::Armed)] {
        let mut bench = Bench::armed();
        bench.vh_per_s = None;
        let mut height_m = 600.0;
        // V/H given directly at arming is lost after 5 s, too.
        for sample in 0..120_u8 {
            height_m += if sample % 2 == 0 { step_m } else { -step_m };
            bench.send(Event::Vh(VhSample::GroundSpeed(60.0 + height_m / 1e4)));
            bench.send(Event::Vh(VhSample::HeightAboveGround(height_m)));
            bench.run(100);
        }
        assert_eq!(bench.camera.controller().state(), state, "{step_m}");
    }
}
