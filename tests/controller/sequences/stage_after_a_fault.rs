//! Sequences in which the stage was driven after a fault.

use super::*;

#[test]
fn stall_outlives_a_brown_out() {
    // `resume` lost `degraded`: a low supply that recovered drove a stalled stage whose fault had
    // not been cleared.
    let mut bench = stalled();
    bench.send(Event::Supply(Supply::Low));
    bench.run(5);
    bench.send(Event::Supply(Supply::Good));
    for _ in 0..20 {
        bench.round();
        assert!(
            bench.camera.controller().setpoint(bench.now).is_none(),
            "driven in {}",
            bench.camera.controller().state()
        );
    }
}

#[test]
fn place_lost_in_standby_is_not_driven_blind() {
    // In standby the fault was noted and `is_place_lost` stayed set; arming then drove the stage
    // with its watch switched off.
    let mut bench = Bench::new(FlightSettings::default());
    bench.run(2);
    bench.send(Event::Drive(Fault::Encoder));
    bench.send(Event::Command(Command::Arm));
    bench.run(2);
    // The stage goes half a millimetre the wrong way, which was not noticed.
    for _ in 0..20 {
        round(&mut bench, 1e-3, Some(-0.5));
    }
    assert!(
        bench.camera.controller().setpoint(bench.now).is_none(),
        "still driven, {}",
        bench.camera.controller().state()
    );
}

#[test]
fn stall_outlives_an_overload() {
    // An overload replaced `degraded` during an exposure; a second later the camera was armed, its
    // stage without force, and the next trigger drove it from 0 mm, regardless of its place.
    let mut bench = stalled();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Exposing);
    for _ in 0..3 {
        late_round(&mut bench);
    }
    bench.run(1500);
    let state = bench.camera.controller().state();
    bench.send(Event::Trigger);
    let driven_to = bench.camera.controller().setpoint(bench.now);
    assert_eq!(
        (state, driven_to),
        (State::Degraded(Fault::Stall), None),
        "the stage is at {} mm",
        bench.stage.offset_mm
    );
}
