//! Sequences that left the shutter open, or a fault in the wrong record.

use super::*;

#[test]
fn second_shutter_that_does_not_close_is_told_to() {
    // The fault was noted for the next frame, too, whose own long exposure then counted as
    // reported.
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
    // One round of 0.2 s: the frame was given up at once, but the shutter was not told to close,
    // and `ShutterLong` was not in the frame's own record.
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
