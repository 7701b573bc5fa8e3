//! The camera's time by a counter of microseconds that runs fast or slow, at the rate that time
//! pulses give.

use super::clock_drift::ClockDrift;
use super::time::{Clock, Time};

/// Largest error of the counter's rate that time pulses correct, ppm: that of an RC oscillator.
pub const WORST_RATE_PPM: f32 = 10_000.0;

/// Largest error of the counter's rate that is [told](DisciplinedClock::drift), ppm: an interval
/// that is farther from a second is none between two time pulses.
pub const WORST_TOLD_PPM: f32 = 50_000.0;

/// Number of intervals in a row, each of a second, that must agree before they give a rate.
pub const CONSISTENT_INTERVALS: u8 = 3;

/// Largest difference between two intervals that agree, ppm.
pub const AGREEMENT_PPM: f32 = 50.0;

/// Error of the rate beyond which it is replaced at once, ppm. `UtcClock` measures smaller ones.
pub const REPLACED_PPM: f32 = 100.0;

/// Error of the rate beyond which it is corrected slowly, ppm.
pub const TRACKED_PPM: f32 = 50.0;

/// Largest slow correction, ppm per second: `UtcClock` takes it for the drift of a clock.
const TRACKING_PPM: f32 = 1.0;

const US_PER_S: u64 = 1_000_000;

/// Elapsed time of the counter beyond which the correction is summed up, µs: its product with the
/// largest rate fits 64 bits.
const LONGEST_US: i64 = 1 << 31;

/// Parts of a microsecond in which the correction is kept, as a power of two.
const FRACTION_BITS: u32 = 32;

/// Parts of a microsecond.
const PARTS: f32 = 65_536.0 * 65_536.0;

/// Clock whose rate follows the time pulses.
///
/// # Model
/// With d the error of the counter's rate, positive if it is fast, camera time goes on by
/// Δ/(1 + d) while the counter goes on by Δ. Exposures and speeds of the stage that are planned in
/// camera time are then those of true seconds. d is 0 until [`CONSISTENT_INTERVALS`] pulses in a
/// row come a second apart by a rate of up to [`WORST_RATE_PPM`], each within [`AGREEMENT_PPM`] of
/// the mean of those before; the mean of these replaces a d that is off by more than
/// [`REPLACED_PPM`]. Beyond [`TRACKED_PPM`] d follows by 1 ppm per pulse. What is left is for
/// [`UtcClock`](super::utc::UtcClock), which measures it. Camera time never jumps; after a change
/// of d, stamps from before it are converted by the new one, which differs by 10 µs for a stamp 1
/// ms old at most.
///
/// # Examples
/// ```
/// use fmc_camera::flight::disciplined_clock::DisciplinedClock;
///
/// // A counter that runs 0.4 % fast.
/// let mut clock = DisciplinedClock::new();
/// for second in 0..4 {
///     clock.pulse(second * 1_004_000);
/// }
/// assert!((clock.rate_ppm() - 4000.0).abs() < 0.01);
/// let before = clock.extend(5_000_000);
/// let after = clock.extend(5_000_000 + 1_004_000);
/// assert!(after.us_since(before).abs_diff(1_000_000) <= 1);
/// // An exposure of 10 ms lasts 10,040 counts.
/// assert!((clock.counted_s(0.010) - 0.010_040).abs() < 1e-8);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisciplinedClock {
    counter: Clock,
    /// Error of the counter's rate, ppm.
    rate_ppm: f32,
    /// Correction per microsecond of the counter, in parts of [`FRACTION_BITS`].
    slope: i64,
    /// Time of the counter up to which the correction is summed up: whole microseconds, and parts.
    anchor: Time,
    corrected_us: i64,
    corrected_parts: i64,
    pulse: Option<Pulses>,
    /// Error of the counter's rate by the last interval of about a second, ppm.
    told_ppm: Option<f32>,
}

/// Pulses in a row that agree.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pulses {
    first: Time,
    last: Time,
    intervals: u8,
}

impl Default for DisciplinedClock {
    fn default() -> Self {
        Self::new()
    }
}

impl DisciplinedClock {
    /// Returns a clock whose counter started at 0, and whose rate is taken to be right.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            counter: Clock::new(),
            rate_ppm: 0.0,
            slope: 0,
            anchor: Time::START,
            corrected_us: 0,
            corrected_parts: 0,
            pulse: None,
            told_ppm: None,
        }
    }

    /// Returns the time of a reading of the counter, as [`Clock::extend`].
    pub fn extend(&mut self, counter_us: u32) -> Time {
        let counted = self.counter.extend(counter_us);
        if self.since_anchor_us(counted) > LONGEST_US {
            self.sum_up(counted);
        }
        moved(counted, self.correction_us(counted))
    }

    /// Returns the error of the counter's rate that is corrected, ppm; positive if it is fast.
    #[must_use]
    pub const fn rate_ppm(&self) -> f32 {
        self.rate_ppm
    }

    /// Returns the drift of the counter by the last interval between two time pulses, also one that
    /// is beyond [`WORST_RATE_PPM`] and not corrected; `None` before the first, or if none was
    /// within [`WORST_TOLD_PPM`] of a second.
    #[must_use]
    pub const fn drift(&self) -> Option<ClockDrift> {
        match self.told_ppm {
            Some(drift_ppm) => Some(ClockDrift {
                drift_ppm,
                corrected_ppm: self.rate_ppm,
            }),
            None => None,
        }
    }

    /// Returns the time at which the counter shows a camera time, within half an hour of the last
    /// reading, counted by the counter from its start.
    #[must_use]
    pub fn counted(&self, time: Time) -> Time {
        // Each step leaves a hundredth of the error of the one before.
        (0..4).fold(time, |counted, _| {
            moved(time, self.correction_us(counted).saturating_neg())
        })
    }

    /// Returns the counter's measure of a duration, s.
    #[must_use]
    pub fn counted_s(&self, duration_s: f32) -> f32 {
        duration_s + duration_s * (1e-6 * self.rate_ppm)
    }

    /// Takes the stamp of a time pulse.
    pub fn pulse(&mut self, counter_us: u32) {
        let time = self.counter.extend(counter_us);
        let told_ppm = self
            .pulse
            .map(|pulses| rate_ppm(pulses.last, time, 1))
            .filter(|ppm| libm::fabsf(*ppm) <= WORST_TOLD_PPM);
        self.told_ppm = told_ppm.or(self.told_ppm);
        let agreeing = self.pulse.and_then(|pulses| pulses.with(time));
        let pulses = agreeing.unwrap_or(match self.pulse {
            // The last interval may be the first of others that agree.
            Some(pulses) if interval_ppm(pulses.last, time, 1).is_some() => Pulses {
                first: pulses.last,
                last: time,
                intervals: 1,
            },
            _ => Pulses {
                first: time,
                last: time,
                intervals: 0,
            },
        });
        self.pulse = Some(pulses);
        if pulses.intervals < CONSISTENT_INTERVALS {
            return;
        }
        let Some(mean_ppm) = interval_ppm(pulses.first, time, pulses.intervals) else {
            return;
        };
        // The mean follows a drift: it begins anew from here.
        self.pulse = Some(Pulses {
            first: time,
            last: time,
            intervals: 0,
        });
        let error_ppm = mean_ppm - self.rate_ppm;
        if libm::fabsf(error_ppm) > REPLACED_PPM {
            self.set_rate(time, mean_ppm);
        } else if libm::fabsf(error_ppm) > TRACKED_PPM {
            let step_ppm = TRACKING_PPM * f32::from(pulses.intervals);
            self.set_rate(time, self.rate_ppm + step_ppm.copysign(error_ppm));
        }
    }

    /// Changes the rate from a time of the counter on.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a hundredth of 2³² at most"
    )]
    fn set_rate(&mut self, from: Time, rate_ppm: f32) {
        self.sum_up(from);
        self.rate_ppm = rate_ppm;
        let rate = 1e-6 * rate_ppm;
        // Rounded to a thousandth of 1 ppm.
        self.slope = (-rate / (1.0 + rate) * PARTS) as i64;
    }

    /// Sums the correction up to a time of the counter.
    fn sum_up(&mut self, counted: Time) {
        let parts = self.parts(counted);
        self.corrected_us = self.corrected_us.saturating_add(parts >> FRACTION_BITS);
        self.corrected_parts = parts & ((1 << FRACTION_BITS) - 1);
        self.anchor = counted;
    }

    fn correction_us(&self, counted: Time) -> i64 {
        let parts = self.parts(counted);
        self.corrected_us.saturating_add(parts >> FRACTION_BITS)
    }

    /// Returns the correction since the anchor, in parts of a microsecond.
    fn parts(&self, counted: Time) -> i64 {
        let elapsed_us = self.since_anchor_us(counted);
        self.corrected_parts
            .saturating_add(elapsed_us.saturating_mul(self.slope))
    }

    /// Returns the counter's time since the anchor, µs; negative before it.
    fn since_anchor_us(&self, counted: Time) -> i64 {
        let ahead_us = counted.us_since(self.anchor);
        let behind_us = self.anchor.us_since(counted);
        ahead_us
            .cast_signed()
            .saturating_sub(behind_us.cast_signed())
    }
}

impl Pulses {
    /// Returns the pulses with another, if it agrees with them.
    fn with(self, time: Time) -> Option<Self> {
        let last_ppm = interval_ppm(self.last, time, 1)?;
        if self.intervals > 0 {
            let mean_ppm = interval_ppm(self.first, self.last, self.intervals)?;
            if libm::fabsf(last_ppm - mean_ppm) > AGREEMENT_PPM {
                return None;
            }
        }
        Some(Self {
            last: time,
            intervals: self.intervals.saturating_add(1),
            ..self
        })
    }
}

/// Returns the error of the rate by an interval of so many seconds, ppm; `None` if it is beyond
/// [`WORST_RATE_PPM`].
fn interval_ppm(from: Time, to: Time, seconds: u8) -> Option<f32> {
    let ppm = rate_ppm(from, to, seconds);
    (libm::fabsf(ppm) <= WORST_RATE_PPM).then_some(ppm)
}

/// Returns the error of the rate by an interval of so many seconds, ppm.
fn rate_ppm(from: Time, to: Time, seconds: u8) -> f32 {
    let elapsed = Time::from_us(to.us_since(from));
    let whole = Time::from_us(u64::from(seconds) * US_PER_S);
    1e6 * elapsed.seconds_since(whole) / f32::from(seconds)
}

/// Returns a time moved by a number of microseconds.
const fn moved(time: Time, by_us: i64) -> Time {
    Time::from_us(time.us().saturating_add_signed(by_us))
}

#[cfg(test)]
mod sequences;
#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the counter at a true time, µs, of a clock that is off by a rate.
    fn counter(true_us: u64, ppm: i64) -> u32 {
        let counted = true_us.cast_signed() + true_us.cast_signed() * ppm / 1_000_000;
        let [b0, b1, b2, b3, ..] = counted.to_le_bytes();
        u32::from_le_bytes([b0, b1, b2, b3])
    }

    fn after(seconds: u64, ppm: i64) -> DisciplinedClock {
        let mut clock = DisciplinedClock::new();
        for second in 0..seconds {
            clock.pulse(counter(300_000 + second * US_PER_S, ppm));
            clock.extend(counter(800_000 + second * US_PER_S, ppm));
        }
        clock
    }

    #[test]
    fn any_rate_up_to_one_percent_is_corrected_after_three_intervals() {
        for ppm in [-9990, -5000, -4600, -101, 101, 3900, 4600, 5000, 9990] {
            let mut clock = after(4, ppm);
            let start = clock.extend(counter(10 * US_PER_S, ppm));
            for ms in [1, 10, 999, 60_000, 600_000] {
                let time = clock.extend(counter(10 * US_PER_S + ms * 1000, ppm));
                let error_us = time.us_since(start).cast_signed() - (1000 * ms).cast_signed();
                // Stamps are whole microseconds, over the three seconds of the mean.
                let allowed_us = 2 + ms.cast_signed() * 1000 / 1_000_000;
                assert!(
                    error_us.abs() <= allowed_us,
                    "{ppm} ppm, {ms} ms: {error_us}"
                );
            }
            assert_eq!(
                after(3, ppm).rate_ppm().to_bits(),
                0,
                "{ppm} after two intervals"
            );
        }
    }

    #[test]
    fn drift_is_told_up_to_five_percent_and_corrected_up_to_one() {
        let mut none = DisciplinedClock::new();
        none.pulse(0);
        assert_eq!(none.drift(), None, "one pulse");
        for ppm in [-49_990, -12_000, -4600, 0, 4600, 9990, 12_000, 49_990] {
            let told = after(5, ppm).drift().unwrap();
            let drift_ppm = 10.0 * f32::from(i16::try_from(ppm / 10).unwrap());
            assert!((told.drift_ppm - drift_ppm).abs() < 2.0, "{told:?}");
            let corrected_ppm = if (101..=9990).contains(&ppm.abs()) {
                told.drift_ppm
            } else {
                0.0
            };
            assert!((told.corrected_ppm - corrected_ppm).abs() < 2.0, "{told:?}");
        }
        assert_eq!(after(5, 51_000).drift(), None);
        // A pulse that is missing, or one that belongs to no second, leaves the last drift.
        let mut clock = after(5, 4600);
        let before = clock.drift();
        clock.pulse(counter(7_300_000, 4600));
        clock.pulse(counter(7_900_000, 4600));
        assert_eq!(clock.drift(), before);
    }

    #[test]
    fn clock_of_a_crystal_is_left_alone() {
        for ppm in [-45, -20, 0, 20, 45] {
            assert_eq!(after(60, ppm).rate_ppm().to_bits(), 0, "{ppm}");
        }
    }

    #[test]
    fn time_never_jumps_nor_goes_back_when_the_rate_changes() {
        let mut clock = DisciplinedClock::new();
        let mut before = clock.extend(0);
        for step in 1..120_000_u64 {
            let true_us = step * 100;
            let ppm = if true_us < 6 * US_PER_S { 4600 } else { -9000 };
            let count = counter(true_us.min(6 * US_PER_S), 4600)
                .wrapping_add(counter(true_us.saturating_sub(6 * US_PER_S), ppm));
            if true_us % US_PER_S == 0 {
                clock.pulse(count);
            }
            let now = clock.extend(count);
            let elapsed_us = now.us_since(before);
            assert!(
                (97..=103).contains(&elapsed_us),
                "{elapsed_us} at {true_us}"
            );
            before = now;
        }
        assert!((clock.rate_ppm() + 9000.0).abs() < 1.0);
    }

    #[test]
    fn slow_drift_of_an_oscillator_is_followed_without_steps() {
        let mut clock = DisciplinedClock::new();
        let (mut count, mut rates) = (0_u64, std::vec::Vec::new());
        for second in 0..1200_u64 {
            let [b0, b1, b2, b3, ..] = count.to_le_bytes();
            clock.pulse(u32::from_le_bytes([b0, b1, b2, b3]));
            rates.push(clock.rate_ppm());
            // From 4200 ppm by 0.5 ppm per second.
            count += US_PER_S + 4200 + second / 2;
        }
        let settled = rates.get(4..).unwrap();
        assert!(settled.windows(2).all(|pair| match pair {
            [before, after] => (after - before).abs() <= 3.01,
            _ => false,
        }));
        assert!((clock.rate_ppm() - 4800.0).abs() < REPLACED_PPM);
    }

    #[test]
    fn false_pulses_and_pulses_beyond_one_percent_change_nothing() {
        for counts in [
            [0, 1_000_000, 1_300_000, 2_000_000, 2_700_000, 3_000_000],
            [0, 1_020_000, 2_040_000, 3_060_000, 4_080_000, 5_100_000],
            [0, 980_000, 1_960_000, 2_940_000, 3_920_000, 4_900_000],
            [0, 1_004_000, 2_000_000, 3_004_000, 4_000_000, 5_004_000],
            [5, 5, 5, 5, 5, 5],
        ] {
            let mut clock = DisciplinedClock::new();
            for count in counts {
                clock.pulse(count);
            }
            assert_eq!(clock.rate_ppm().to_bits(), 0, "{counts:?}");
        }
    }

    #[test]
    fn counted_time_is_the_inverse_of_extended_time_also_across_a_wrap() {
        for ppm in [-9990, 0, 4600, 9990] {
            let mut clock = after(4, ppm);
            for second in 1..5000_u64 {
                let count = counter(second * 2 * US_PER_S, ppm);
                let time = clock.extend(count);
                for ahead_us in [0, 500, 1000, 40_000_000] {
                    let counted = clock.counted(moved(time, ahead_us));
                    let [b0, b1, b2, b3, ..] = counted.us().to_le_bytes();
                    let found = u32::from_le_bytes([b0, b1, b2, b3]);
                    let expected = counter(second * 2 * US_PER_S + ahead_us.cast_unsigned(), ppm);
                    let off = found.wrapping_sub(expected).cast_signed();
                    assert!(off.abs() <= 42, "{ppm} ppm at {second}, {ahead_us}: {off}");
                    if ahead_us <= 1000 {
                        assert!(off.abs() <= 2, "{ppm} ppm at {second}, {ahead_us}: {off}");
                    }
                }
            }
        }
    }
}
