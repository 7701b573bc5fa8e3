//! Pulses that were trusted, moved or stayed away, and came again.

use super::*;

/// Sends six pulses from a second on, all off by a time, each named by a time that is wrong by some
/// seconds. Returns the findings of the names.
fn come_again(
    clock: &mut UtcClock,
    from: u64,
    off_s: f32,
    wrong_s: i64,
) -> [Option<UtcFinding>; 6] {
    core::array::from_fn(|index| {
        let s = from + index as u64;
        let time = pulse_at(s).plus_s(off_s);
        clock.pulse(time);
        let named = (NEW_YEAR_S + s).saturating_add_signed(wrong_s) * US_PER_S;
        clock.receiver_time(time.plus_s(0.15), named)
    })
}

fn sigma_s(clock: &UtcClock, second: u64) -> f32 {
    clock.utc(pulse_at(second)).unwrap().sigma_s
}

#[test]
fn receiver_that_names_other_seconds_after_an_outage_has_stepped() {
    // Pulses that move without an outage, and outages on both sides of the holdover.
    for (from, off_s) in [(30, 0.3), (30, -0.01), (530, 0.3), (730, 0.0), (1030, 0.2)] {
        for wrong_s in [-1, 1, 18] {
            let mut clock = running(30);
            let found = come_again(&mut clock, from, off_s, wrong_s);
            let stepped = Some(UtcFinding::Stepped(wrong_s));
            assert!(found.contains(&stepped), "{from}, {off_s}: {found:?}");
            assert_eq!(clock.has_stepped(), [true, off_s != 0.0]);
            let unsigned_s = Time::from_us(wrong_s.unsigned_abs() * US_PER_S);
            let wrong_s = unsigned_s.seconds_since(Time::START);
            assert!(sigma_s(&clock, from + 5) >= wrong_s, "{from}, {off_s}");
        }
        let mut clock = running(30);
        come_again(&mut clock, from, off_s, 0);
        assert!(sigma_s(&clock, from + 5) < 1e-5 + 1.01 * off_s.abs());
        assert_eq!(clock.has_stepped(), [false, off_s != 0.0]);
    }
}

#[test]
fn outage_in_which_the_drift_wanders_is_no_move() {
    // 700 s at 0.5 ppm, and an hour, in which the clock may lose its second.
    for (from, off_s) in [(730, 0.35e-3), (730, -0.35e-3), (3630, 0.1)] {
        let mut clock = running(30);
        clock.pulse(pulse_at(from).plus_s(off_s));
        clock.pulse(pulse_at(from + 1).plus_s(off_s));
        let found = clock.pulse(pulse_at(from + 2).plus_s(off_s));
        let missing = u32::try_from(from - 30).unwrap();
        assert_eq!(found, Some(UtcFinding::MissingPulses(missing)));
        assert_eq!(clock.utc(pulse_at(from + 2)), None, "not named yet");
        come_again(&mut clock, from + 3, off_s, 0);
        assert_eq!(clock.has_stepped(), [false; 2], "{from}, {off_s}");
        assert!(sigma_s(&clock, from + 8) < 1e-5 + 2.0 * off_s.abs());
    }
}

#[test]
fn pulses_that_move_again_before_they_are_named_have_moved_by_both() {
    let mut clock = running(30);
    for (from, off_s) in [(30, 0.1), (33, 0.25)] {
        let found = [0, 1, 2].map(|s| clock.pulse(pulse_at(from + s).plus_s(off_s)));
        assert_eq!(found[2], Some(UtcFinding::PulsesMoved), "{found:?}");
    }
    come_again(&mut clock, 36, 0.25, 0);
    let sigma_s = sigma_s(&clock, 41);
    assert!((sigma_s - 0.25).abs() < 1e-4, "{sigma_s}");
}

#[test]
fn times_of_one_pulse_name_it_once() {
    let mut clock = UtcClock::new(SIGMA_S);
    for s in 0..3 {
        assert_eq!(clock.utc(pulse_at(s)), None, "{s} pulses have been named");
        clock.pulse(pulse_at(s));
        for message in 1..=5_u8 {
            let arrival = pulse_at(s).plus_s(0.1 * f32::from(message));
            let found = clock.receiver_time(arrival, (NEW_YEAR_S + s) * US_PER_S);
            assert_eq!(found, None);
        }
    }
    assert!(clock.utc(pulse_at(3)).is_some());
}

#[test]
fn contradiction_is_forgotten_when_the_doubt_is_cleared() {
    let mut clock = running(5);
    clock.pulse(pulse_at(5));
    clock.receiver_time(message_at(5), (NEW_YEAR_S + 6) * US_PER_S);
    assert!(sigma_s(&clock, 5) > 1.0);
    clock.clear_doubt();
    assert!(sigma_s(&clock, 5) < 1e-5);
}

#[test]
fn pulses_from_before_a_jump_of_the_clock_are_not_counted_on() {
    let mut clock = running(20);
    clock.forget_pulses();
    assert_eq!(clock.utc(pulse_at(20)), None);
    // Another place in the second, and another second, of a clock that begins anew.
    for s in 0..3 {
        let time = pulse_at(s).plus_s(0.4);
        assert_eq!(clock.pulse(time), None);
        let named = (NEW_YEAR_S + 500 + s) * US_PER_S;
        assert_eq!(clock.receiver_time(time.plus_s(0.15), named), None);
    }
    assert!(sigma_s(&clock, 3) < 1e-4);
    assert_eq!(clock.has_stepped(), [false; 2]);
}
