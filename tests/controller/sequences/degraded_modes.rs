//! Sequences in which a degraded mode was not entered, or left too early.

use super::*;

#[test]
fn dead_encoder_leaves_static_correction() {
    // A drive whose `position` fails reports so in every round; each report led from degraded to
    // fault again.
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
    let counts = bench.camera.controller().counts();
    assert!(counts.exposed > 5, "{counts:?}");
}

#[test]
fn late_round_with_a_trigger_is_no_lost_place() {
    // The profile began 1 ms after the trigger's stamp, in the past: the set point made a step,
    // which the stage (2 m/s²) could not follow. The encoder was blamed and the place was lost.
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
    assert_ne!(
        bench.camera.controller().state(),
        State::Fault(Fault::Encoder)
    );
}

#[test]
fn tdi_camera_disarmed_in_a_brown_out_is_disarmed() {
    // Without a stage `resume` armed the camera at once and did not reset `is_disarming`.
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
    assert_eq!(bench.camera.controller().state(), State::Standby);
    assert!(bench.camera.controller().setpoint(bench.now).is_none());
}

#[test]
fn tdi_camera_overloaded_in_its_run_up_is_degraded() {
    // `call_off` chose the next state before `degraded` was set.
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
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Overload)
    );
}

#[test]
fn three_late_rounds_in_two_seconds_are_no_overload() {
    // The window began anew with every late round instead of ending after [`OVERLOAD_WINDOW_S`].
    let mut bench = Bench::armed();
    for _ in 0..3 {
        late_round(&mut bench);
        bench.run(900);
    }
    bench.run(1);
    assert_eq!(bench.camera.controller().state(), State::Armed);
}
