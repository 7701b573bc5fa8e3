//! UTC by a clock whose rate is far off, corrected by the pulses themselves as a board does it.

use super::*;
use crate::flight::disciplined_clock::DisciplinedClock;

/// Time within which UTC must be there, s after the first pulse.
const WITHIN_S: u64 = 60;

/// Returns the counter at a true time, µs, of a clock that is off by a rate.
fn counter(true_us: u64, ppm: i64) -> u32 {
    let counted = true_us.cast_signed() + true_us.cast_signed() * ppm / 1_000_000;
    let [b0, b1, b2, b3, ..] = counted.to_le_bytes();
    u32::from_le_bytes([b0, b1, b2, b3])
}

#[test]
fn utc_is_there_within_a_minute_by_a_clock_that_is_half_a_percent_off() {
    for ppm in [-5000, 5000] {
        let (mut counts, mut utc) = (DisciplinedClock::new(), UtcClock::new(SIGMA_S));
        let mut since = None;
        for second in 0..2 * WITHIN_S {
            let pulse_us = 300_000 + second * US_PER_S;
            let stamp = counter(pulse_us, ppm);
            utc.pulse(counts.extend(stamp));
            counts.pulse(stamp);
            let message = counts.extend(counter(pulse_us + 150_000, ppm));
            utc.receiver_time(message, (NEW_YEAR_S + second) * US_PER_S);
            let time = counts.extend(counter(pulse_us + 700_000, ppm));
            let Some(found) = utc.utc(time) else {
                assert_eq!(since, None, "{ppm} ppm: UTC is gone after {second} s");
                continue;
            };
            since.get_or_insert(second);
            let expected_us = (NEW_YEAR_S + second) * US_PER_S + 700_000;
            let error_us = found.unix_us.cast_signed() - expected_us.cast_signed();
            // The rate is left 1 ppm, and both clocks have whole microseconds.
            assert!(error_us.abs() <= 3, "{ppm} ppm, {second} s: {error_us} µs");
        }
        assert!(
            since.is_some_and(|second| second <= WITHIN_S),
            "{ppm} ppm: {since:?}"
        );
    }
}
