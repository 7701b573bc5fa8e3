//! The stage is driven after a fault.

use super::*;

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
