//! Sequences in which the shutter opened although the stage was not at speed.

use super::*;

/// Returns the time at which the shutter's command leaves in the frame of [`Bench::armed`]
/// triggered at once.
fn command() -> Time {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Tracking);
    let opens = bench.actions.iter().find_map(|(_, action)| match action {
        Action::OpenShutter { at, .. } => Some(*at),
        _ => None,
    });
    opens.unwrap()
}

/// Runs rounds with their times relative to the command, s, of a stage that falls back by 7 % of
/// its speed from 8 ms before.
fn slow_stage(ends_s: &[f32]) -> Bench {
    const SLOW_MM_S: f32 = -0.7;
    let command = command();
    let slow_from = command.plus_s(-0.008);
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    let go = |bench: &mut Bench, to: Time| {
        let off_mm = SLOW_MM_S * to.seconds_since(slow_from).max(0.0);
        let round_s = to.seconds_since(bench.now);
        round(bench, round_s, Some(off_mm.max(-0.0095)));
    };
    while bench.now.plus_s(0.001) < command.plus_s(ends_s[0]) {
        let to = bench.now.plus_s(0.001);
        go(&mut bench, to);
    }
    for end_s in ends_s {
        go(&mut bench, command.plus_s(*end_s));
    }
    for _ in 0..60 {
        let to = bench.now.plus_s(0.001);
        go(&mut bench, to);
    }
    bench
}

#[test]
fn stage_not_at_speed_is_seen_with_rounds_of_1_4_ms() {
    // As a control, punctual rounds refuse the frame.
    let punctual = slow_stage(&[-0.0015, -0.0005, 0.0005, 0.0015]);
    assert_eq!(
        punctual.records()[0].outcome,
        Outcome::Refused(Reason::NotAtSpeed)
    );
    // No round falls into the last millisecond before the command (1.4 ms do not even count as
    // late): the speed was not checked.
    let bench = slow_stage(&[-0.001_05, 0.000_35, 0.0015]);
    assert_eq!(bench.camera.controller().counts().late_ticks, 0);
    assert_eq!(
        bench.records()[0].outcome,
        Outcome::Refused(Reason::NotAtSpeed)
    );
}

#[test]
fn command_taken_back_is_not_repeated_without_a_look_at_the_speed() {
    // The command is withdrawn 0.9 ms before it leaves; the next round, 0.1 ms before, sent it
    // again, because `now < planned` was not checked.
    let bench = slow_stage(&[-0.0009, -0.0001, 0.0009]);
    assert_eq!(
        bench.records()[0].outcome,
        Outcome::Refused(Reason::NotAtSpeed)
    );
}

#[test]
fn shutter_is_not_told_to_open_while_the_last_reading_is_in_doubt() {
    // The reading that shows a kick was held as a possible glitch, and the slope before it was that
    // of a stage at speed.
    const KICK_MM: f32 = 0.008;
    let told = |bench: &Bench| {
        let opens = bench.actions.iter().find_map(|(at, action)| match action {
            Action::OpenShutter { .. } => Some(*at),
            _ => None,
        });
        opens.map(|at| at.seconds_since(bench.now))
    };
    let before_the_round_of_the_command = || {
        let last_round = {
            let mut bench = Bench::armed();
            bench.send(Event::Trigger);
            while told(&bench).is_none() {
                round(&mut bench, 0.001, Some(0.0));
            }
            bench.now
        };
        let mut bench = Bench::armed();
        bench.send(Event::Trigger);
        while bench.now.plus_s(0.0005) < last_round.plus_s(-0.001) {
            round(&mut bench, 0.001, Some(0.0));
        }
        bench
    };
    // As a control, without a kick the next round tells it.
    let mut bench = before_the_round_of_the_command();
    assert_eq!(told(&bench), None);
    round(&mut bench, 0.001, Some(0.0));
    assert_eq!(told(&bench), Some(0.0));

    let mut bench = before_the_round_of_the_command();
    round(&mut bench, 0.001, Some(KICK_MM));
    assert_eq!(told(&bench), None);
    // A glitch: it opens a round later.
    round(&mut bench, 0.001, Some(0.0));
    assert_eq!(told(&bench), Some(0.0));

    // A stage that goes on so does not open.
    let mut bench = before_the_round_of_the_command();
    for kicks in [1.0, 2.0, 3.0] {
        round(&mut bench, 0.001, Some(kicks * KICK_MM));
    }
    bench.run(60);
    assert_eq!(told(&bench), None);
    assert!(matches!(bench.records()[0].outcome, Outcome::Refused(_)));
}

#[test]
fn shutter_does_not_open_on_readings_that_have_ceased() {
    // The slope of old readings never expired, and an encoder without readings caused no fault.
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run(5);
    bench.is_read = false;
    bench.run(100);
    let opens = |it: &(Time, Action)| matches!(it.1, Action::OpenShutter { .. });
    assert!(
        !bench.actions.iter().any(opens),
        "{:?}",
        bench.records()[0].outcome
    );
}
