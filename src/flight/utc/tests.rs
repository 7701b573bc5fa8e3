mod drift;
mod outages;

use super::*;
use proptest::prelude::*;

/// 2026-01-01T00:00:00 UTC.
const NEW_YEAR_S: u64 = 1_767_225_600;
const SIGMA_S: f32 = 1e-6;

/// Returns the pulse that begins the given second after the start, by a clock that is 20 ppm fast
/// and started 0.3 s before.
fn pulse_at(second: u64) -> Time {
    Time::from_us(300_000 + second * 1_000_020)
}

fn message_at(second: u64) -> Time {
    pulse_at(second).plus_s(0.15)
}

fn second(clock: &mut UtcClock, second: u64) -> [Option<UtcFinding>; 2] {
    [
        clock.pulse(pulse_at(second)),
        clock.receiver_time(message_at(second), (NEW_YEAR_S + second) * US_PER_S),
    ]
}

fn running(seconds: u64) -> UtcClock {
    let mut clock = UtcClock::new(SIGMA_S);
    for s in 0..seconds {
        assert_eq!(second(&mut clock, s), [None, None], "{s}");
    }
    clock
}

/// Returns the error of UTC a number of milliseconds after the pulse, µs.
fn error_us(clock: &UtcClock, after: u64, ms: i64) -> i64 {
    // 20 ppm of a millisecond are 0.02 µs.
    let elapsed_us = ms * 1000 + ms / 50;
    let camera = pulse_at(after).us().saturating_add_signed(elapsed_us);
    let found = clock.utc(Time::from_us(camera)).unwrap();
    let expected = ((NEW_YEAR_S + after) * US_PER_S).saturating_add_signed(ms * 1000);
    found.unix_us.cast_signed() - expected.cast_signed()
}

#[test]
fn utc_follows_the_pulse_and_the_measured_drift() {
    let clock = running(10);
    assert!(clock.drifts > 0 && (clock.drift_ppm - 20.0).abs() < 0.01);
    for ms in [-3000, 0, 250, 999, 30_000, 500_000] {
        let error = error_us(&clock, 9, ms);
        // Rounding of both clocks to 1 µs.
        assert!(error.abs() <= 2, "{ms} ms: {error} µs");
    }
}

#[test]
fn there_is_no_utc_before_three_times_agree_nor_beyond_the_holdover() {
    let clock = running(2);
    assert_eq!(clock.utc(pulse_at(2)), None);
    let clock = running(3);
    assert!(clock.utc(pulse_at(3)).is_some());
    assert_eq!(clock.utc(pulse_at(2).plus_s(HOLDOVER_S + 1.0)), None);
    assert_eq!(UtcClock::new(SIGMA_S).utc(Time::START), None);
}

#[test]
fn sigma_grows_with_the_age_of_the_pulse() {
    let clock = running(30);
    let sigma = |age| clock.utc(pulse_at(29).plus_s(age)).unwrap().sigma_s;
    // Pulse 1 µs and rounding 0.29 µs.
    assert!((sigma(0.0) - 1.041e-6).abs() < 1e-8);
    assert!(sigma(1.0) > sigma(0.0) && sigma(10.0) > 2.0 * sigma(1.0));
    // 0.24 ppm and 0.02 ppm/s · 100 s over 100 s.
    assert!((sigma(100.0) - 2.24e-4).abs() < 1e-5, "{}", sigma(100.0));
    let jitter_unknown = UtcClock::new(f32::NAN);
    assert!(jitter_unknown.pulse_sigma_s <= WORST_PULSE_SIGMA_S);
}

#[test]
fn missing_pulses_are_counted_and_utc_goes_on() {
    let mut clock = running(5);
    let found = second(&mut clock, 8);
    assert_eq!(found, [Some(UtcFinding::MissingPulses(3)), None]);
    assert!(error_us(&clock, 8, 500).abs() <= 2);
}

#[test]
fn extra_pulse_is_not_used() {
    let mut clock = running(5);
    for extra in [0.002, 0.3, 0.997] {
        let found = clock.pulse(pulse_at(4).plus_s(extra));
        assert_eq!(found, Some(UtcFinding::ExtraPulse));
    }
    assert_eq!(second(&mut clock, 5), [None, None]);
    assert!(error_us(&clock, 5, 500).abs() <= 2);
    let found = clock.pulse(pulse_at(4));
    assert_eq!(found, Some(UtcFinding::FromThePast));
}

#[test]
fn clock_that_began_with_a_false_pulse_comes_right() {
    let mut clock = UtcClock::new(SIGMA_S);
    clock.pulse(pulse_at(0).plus_s(-0.2));
    let found = [0, 1, 2].map(|s| clock.pulse(pulse_at(s)));
    let extra = Some(UtcFinding::ExtraPulse);
    assert_eq!(found, [extra, extra, Some(UtcFinding::PulsesMoved)]);
    for s in 3..7 {
        assert_eq!(second(&mut clock, s), [None, None]);
    }
    assert!(error_us(&clock, 6, 500).abs() <= 2);
}

#[test]
fn one_wrong_second_is_outvoted_and_in_sigma() {
    for wrong in [-1, 1, 3600, -86400] {
        let mut clock = running(5);
        clock.pulse(pulse_at(5));
        let time = (NEW_YEAR_S + 5).saturating_add_signed(wrong) * US_PER_S;
        for message in 0..10_u8 {
            let arrival = pulse_at(5).plus_s(0.1 + 0.01 * f32::from(message));
            let found = clock.receiver_time(arrival, time);
            assert_eq!(found, Some(UtcFinding::WrongSecond(wrong)));
        }
        assert!(error_us(&clock, 5, 500).abs() <= 2);
        let sigma_s = clock.utc(pulse_at(5)).unwrap().sigma_s;
        let covered = Time::START.plus_s(sigma_s).us() / US_PER_S;
        assert!(covered >= wrong.unsigned_abs());
        assert_eq!(second(&mut clock, 6), [None, None]);
        assert!(clock.utc(pulse_at(6)).unwrap().sigma_s < 1e-5);
    }
}

#[test]
fn leap_second_and_backward_jump_are_believed_at_the_third_pulse() {
    for step in [-1, -2, 5] {
        let mut clock = running(5);
        let found = [5, 6, 7].map(|s| {
            clock.pulse(pulse_at(s));
            let time = (NEW_YEAR_S + s).saturating_add_signed(step) * US_PER_S;
            clock.receiver_time(message_at(s), time).unwrap()
        });
        let wrong = UtcFinding::WrongSecond(step);
        assert_eq!(found, [wrong, wrong, UtcFinding::Stepped(step)]);
        let error = error_us(&clock, 7, 0) - step * 1_000_000;
        assert!(error.abs() <= 2);
    }
}

#[test]
fn sigma_covers_a_second_that_stepped_until_it_steps_back_or_is_cleared() {
    let mut clock = running(5);
    let named = |clock: &mut UtcClock, from: u64, wrong: i64| {
        for s in from..from + 3 {
            clock.pulse(pulse_at(s));
            let time = (NEW_YEAR_S + s).saturating_add_signed(wrong) * US_PER_S;
            clock.receiver_time(message_at(s), time);
        }
        clock.utc(pulse_at(from + 2)).unwrap().sigma_s
    };
    assert!(named(&mut clock, 5, 1) > 1.0);
    // However long the receiver goes on to say so.
    assert!(named(&mut clock, 8, 1) > 1.0);
    assert_eq!(clock.has_stepped(), [true, false]);
    assert!(named(&mut clock, 11, 0) < 1e-5);
    assert_eq!(clock.has_stepped(), [false; 2]);
    assert!(named(&mut clock, 14, -2) > 2.0);
    clock.clear_doubt();
    assert!(clock.utc(pulse_at(16)).unwrap().sigma_s < 1e-5);
}

#[test]
fn pulses_that_move_within_the_tolerance_of_any_crystal_are_not_believed_at_once() {
    for moved_s in [30e-6, -150e-6, 0.01, -0.3] {
        let mut clock = running(20);
        let found = [20, 21, 22].map(|s| clock.pulse(pulse_at(s).plus_s(moved_s)));
        let extra = Some(UtcFinding::ExtraPulse);
        assert_eq!(
            found,
            [extra, extra, Some(UtcFinding::PulsesMoved)],
            "{moved_s}"
        );
        for s in 22..26 {
            let time = pulse_at(s).plus_s(moved_s);
            if s > 22 {
                assert_eq!(clock.pulse(time), None);
            }
            clock.receiver_time(time.plus_s(0.15), (NEW_YEAR_S + s) * US_PER_S);
        }
        let utc = clock.utc(pulse_at(25)).unwrap();
        let error_s = 1e-6
            * (utc.unix_us.cast_signed() - ((NEW_YEAR_S + 25) * US_PER_S).cast_signed()) as f32;
        assert!(error_s.abs() <= 1.01 * utc.sigma_s, "{error_s}, {utc:?}");
        assert!(utc.sigma_s <= 1.1 * moved_s.abs() + 1e-5, "{utc:?}");
        assert_eq!(clock.has_stepped(), [false, true]);
        // Back again, the doubt is over.
        for s in 26..32 {
            second(&mut clock, s);
        }
        assert!(clock.utc(pulse_at(31)).unwrap().sigma_s < 1e-5, "{moved_s}");
    }
}

#[test]
fn pulses_that_move_before_the_drift_is_measured_are_in_sigma() {
    for (moved_s, after) in [(1e-4, 4), (-1e-4, 4), (1.7e-4, 7), (-3e-5, 5)] {
        let mut clock = running(after);
        for s in after..after + 3 {
            let time = pulse_at(s).plus_s(moved_s);
            let found = clock.pulse(time);
            let expected = (s == after).then_some(UtcFinding::PulsesMoved);
            assert_eq!(found, expected, "{moved_s} s at {s}");
            clock.receiver_time(time.plus_s(0.15), (NEW_YEAR_S + s) * US_PER_S);
            let utc = clock.utc(pulse_at(s)).unwrap();
            let expected_us = ((NEW_YEAR_S + s) * US_PER_S).cast_signed();
            let error_s = 1e-6 * (utc.unix_us.cast_signed() - expected_us) as f32;
            assert!(error_s.abs() <= 1.01 * utc.sigma_s, "{error_s}, {utc:?}");
            assert!(utc.sigma_s <= 1.5 * moved_s.abs() + 1e-5, "{utc:?}");
        }
        assert_eq!(clock.has_stepped(), [false, true]);
    }
}

#[test]
fn time_with_a_fraction_names_the_second_its_pulse_began() {
    let mut clock = running(5);
    clock.pulse(pulse_at(5));
    // Two messages: one made 50 ms before the pulse that comes 30 ms after it, and one made after
    // it.
    let made = (NEW_YEAR_S + 4) * US_PER_S + 950_000;
    assert_eq!(clock.receiver_time(pulse_at(5).plus_s(0.03), made), None);
    let made = (NEW_YEAR_S + 5) * US_PER_S + 300_000;
    assert_eq!(clock.receiver_time(pulse_at(5).plus_s(0.38), made), None);
    let late = clock.receiver_time(pulse_at(5).plus_s(1.5), made);
    assert_eq!(late, Some(UtcFinding::NoPulse));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    #[test]
    fn any_pulses_and_times_give_a_finite_sigma(
        inputs in prop::collection::vec((any::<bool>(), any::<u64>(), any::<u64>()), 0..40),
        sigma_s in any::<f32>(),
    ) {
        let mut clock = UtcClock::new(sigma_s);
        for s in 0..4 {
            second(&mut clock, s);
        }
        for (is_pulse, time, unix_us) in inputs {
            let time = Time::from_us(time);
            if is_pulse {
                clock.pulse(time);
            } else {
                clock.receiver_time(time, unix_us);
            }
            if let Some(found) = clock.utc(time) {
                prop_assert!(found.sigma_s.is_finite() && found.sigma_s >= 0.0);
            }
        }
    }
}

#[test]
fn time_that_came_before_the_last_pulse_is_from_the_past() {
    let mut clock = running(5);
    let before = pulse_at(4).plus_s(-0.001);
    let found = clock.receiver_time(before, (NEW_YEAR_S + 3) * US_PER_S);
    assert_eq!(found, Some(UtcFinding::FromThePast));
    // It has changed nothing.
    assert_eq!(second(&mut clock, 5), [None, None]);
    assert!(error_us(&clock, 5, 0).abs() <= 2);
}

#[test]
fn names_that_change_before_any_is_trusted_begin_anew() {
    let mut clock = UtcClock::new(SIGMA_S);
    assert_eq!(second(&mut clock, 0), [None, None]);
    // A second that is a leap off, once: nothing has been trusted that it contradicts.
    assert_eq!(clock.pulse(pulse_at(1)), None);
    let off = (NEW_YEAR_S + 1 - 18) * US_PER_S;
    assert_eq!(clock.receiver_time(message_at(1), off), None);
    for s in 2..4 {
        assert_eq!(second(&mut clock, s), [None, None]);
        assert_eq!(clock.utc(pulse_at(s)), None, "{s}");
    }
    assert_eq!(second(&mut clock, 4), [None, None]);
    assert!(error_us(&clock, 4, 0).abs() <= 2);
}

#[test]
fn seconds_that_contradict_the_count_differently_do_not_replace_it() {
    let mut clock = running(10);
    for (s, off_s) in (10..).zip([18, 17, 18, 17, 18, 17]) {
        assert_eq!(clock.pulse(pulse_at(s)), None);
        let wrong = (NEW_YEAR_S + s - off_s) * US_PER_S;
        let found = clock.receiver_time(message_at(s), wrong);
        assert_eq!(found, Some(UtcFinding::WrongSecond(-off_s.cast_signed())));
    }
    assert!(error_us(&clock, 15, 0).abs() <= 2);
}
