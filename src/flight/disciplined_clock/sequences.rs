//! All short sequences of readings and of time pulses, against slow clocks.

use super::*;

/// Steps of the counter from its newest reading, µs: the half of its turn at most, and stamps from
/// before.
const STEPS_US: [i64; 7] = [0, 1, 999_983, (1 << 31) - 1, -1, -1_000_003, 1 - (1 << 31)];

/// Number of readings in a sequence.
const READINGS: usize = 6;

/// Rate of the counter in the second half of the readings, ppm.
const RATE_PPM: i64 = 4000;

/// Intervals between time pulses, µs.
const INTERVALS_US: [u32; 7] = [
    1_000_000, 1_000_040, 1_000_060, 1_000_200, 995_000, 1_020_000, 2_000_000,
];

/// Number of intervals in a sequence.
const INTERVALS: usize = 7;

/// The counter at a time of it, µs.
fn reading(counted_us: i64) -> u32 {
    let [b0, b1, b2, b3, ..] = counted_us.to_le_bytes();
    u32::from_le_bytes([b0, b1, b2, b3])
}

/// Tries every sequence of so many readings; returns how many there are. `newest_us` is the newest
/// of the counter's times, `from` the counter's and the camera's time from which the rate holds.
fn try_readings(
    clock: &DisciplinedClock,
    newest_us: i64,
    from: Option<[i64; 2]>,
    left: usize,
) -> u32 {
    if left == 0 {
        return 1;
    }
    let sequences = STEPS_US.into_iter().map(|step_us| {
        let mut clock = *clock;
        let counted_us = newest_us + step_us;
        let found_us = clock.extend(reading(counted_us)).us().cast_signed();
        match from {
            // Before its start a counter has no time.
            None => assert_eq!(found_us, counted_us.max(0)),
            Some([counter_us, camera_us]) if counted_us >= counter_us => {
                let elapsed_us = counted_us - counter_us;
                // The rate is known to a few parts in 10⁸ of itself.
                let expected_us = camera_us + elapsed_us * 1_000_000 / (1_000_000 + RATE_PPM);
                let off_us = found_us - expected_us;
                assert!(off_us.abs() <= 2 + elapsed_us / 1_000_000_000, "{off_us}");
            }
            Some(_) => {}
        }
        try_readings(&clock, newest_us.max(counted_us), from, left - 1)
    });
    sequences.sum()
}

#[test]
fn every_short_sequence_of_readings_is_extended_as_by_a_counter_that_never_wraps() {
    let begun = try_readings(&DisciplinedClock::new(), 0, None, READINGS);
    let mut clock = DisciplinedClock::new();
    let (mut counted_us, mut camera_us) = (0, 0);
    for _ in 0..4 {
        clock.pulse(reading(counted_us));
        camera_us = clock.extend(reading(counted_us)).us().cast_signed();
        counted_us += 1_000_000 + RATE_PPM;
    }
    let newest_us = counted_us - 1_000_000 - RATE_PPM;
    let from = Some([newest_us, camera_us]);
    let disciplined = try_readings(&clock, newest_us, from, READINGS);
    // docs/models.md has this number.
    assert_eq!(begun + disciplined, 235_298);
}

/// A clock that keeps the intervals that agree, and nothing else.
#[derive(Debug, Clone, Default)]
struct Slow {
    /// Errors of the last intervals in a row that agree, ppm.
    agreeing: std::vec::Vec<f64>,
    rate_ppm: f64,
}

impl Slow {
    fn interval(&mut self, interval_us: u32) {
        let error_ppm = f64::from(interval_us) - 1e6;
        let mean_ppm = |errors: &[f64]| {
            let count = u32::try_from(errors.len()).unwrap();
            errors.iter().sum::<f64>() / f64::from(count)
        };
        if error_ppm.abs() > 10_000.0 {
            self.agreeing.clear();
            return;
        }
        if !self.agreeing.is_empty() && (error_ppm - mean_ppm(&self.agreeing)).abs() > 50.0 {
            self.agreeing.clear();
        }
        self.agreeing.push(error_ppm);
        if self.agreeing.len() < 3 {
            return;
        }
        let off_ppm = mean_ppm(&self.agreeing) - self.rate_ppm;
        self.agreeing.clear();
        if off_ppm.abs() > 100.0 {
            self.rate_ppm += off_ppm;
        } else if off_ppm.abs() > 50.0 {
            self.rate_ppm += 3.0 * off_ppm.signum();
        }
    }
}

/// Tries every sequence of so many intervals; returns how many there are.
fn try_pulses(clock: &DisciplinedClock, slow: &Slow, counter_us: u32, left: usize) -> u32 {
    let off_ppm = f64::from(clock.rate_ppm()) - slow.rate_ppm;
    assert!(off_ppm.abs() < 0.001, "{clock:?} {slow:?}");
    if left == 0 {
        return 1;
    }
    let sequences = INTERVALS_US.into_iter().map(|interval_us| {
        let (mut clock, mut slow) = (*clock, slow.clone());
        let counter_us = counter_us.wrapping_add(interval_us);
        let before = clock.extend(counter_us);
        clock.pulse(counter_us);
        slow.interval(interval_us);
        // The rate changes, the time does not jump.
        assert_eq!(clock.extend(counter_us), before);
        try_pulses(&clock, &slow, counter_us, left - 1)
    });
    sequences.sum()
}

#[test]
fn every_short_sequence_of_time_pulses_gives_the_rate_of_a_slow_clock_and_no_jump() {
    let mut clock = DisciplinedClock::new();
    clock.pulse(0);
    let sequences = try_pulses(&clock, &Slow::default(), 0, INTERVALS);
    // docs/models.md has this number.
    assert_eq!(sequences, 823_543);
}

#[test]
fn clock_without_pulses_counts_as_its_counter_does() {
    let mut clock = DisciplinedClock::default();
    assert_eq!(clock, DisciplinedClock::new());
    assert_eq!(clock.extend(7_000_000), Time::from_us(7_000_000));
    assert!((clock.counted_s(0.01) - 0.01).abs() <= 0.0);
    for second in 0..4 {
        clock.pulse(8_000_000 + second * 1_004_000);
    }
    // 10 ms of a counter that is 4000 ppm fast.
    assert!((clock.counted_s(0.01) - 0.010_04).abs() < 1e-8);
}
