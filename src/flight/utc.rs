//! Absolute time, from the receiver's time pulse and the times that name its pulses.
//!
//! The pulse marks exactly the beginning of a second, but does not name it; the receiver's messages
//! name it, but come late. The camera's clock carries the time from one pulse to the next.

mod pulse;
mod reading;

pub use self::pulse::CONSISTENT_TIMES;
use self::pulse::{Doubt, Pulse};
pub use self::reading::{UtcFinding, UtcTime};
use super::time::Time;

/// Largest distance of a pulse from a whole number of seconds after the last, per second, beyond
/// its jitter: more than any crystal drifts.
pub const CLOCK_TOLERANCE_PPM: f32 = 200.0;

/// σ of the clock's drift before it is measured, ppm.
pub const UNMEASURED_DRIFT_PPM: f32 = 50.0;

/// Largest change of the drift, ppm per second without a pulse: a crystal that warms up by 1 K per
/// minute.
pub const DRIFT_WANDER_PPM_PER_S: f32 = 0.02;

/// Age of the last pulse beyond which there is no absolute time, s.
pub const HOLDOVER_S: f32 = 600.0;

/// Largest σ of a pulse's time stamp, s.
pub const WORST_PULSE_SIGMA_S: f32 = 1e-3;

/// Number of pulses in a row, a second apart, that must contradict the earlier ones to replace
/// them.
pub const CONSISTENT_PULSES: u8 = 3;

/// Number of intervals from which on the clock's drift counts as measured: a pulse that comes far
/// from where the drift puts it is then not used.
pub const MEASURED_DRIFTS: u8 = 8;

/// Number of σ by which a pulse may miss its place by the measured drift.
const PULSE_SIGMAS: f32 = 6.0;

/// Time by which a message may seem to come before the time it names, s: jitter of its own stamp.
const EARLY_S: f32 = 0.02;

/// Part of a new measurement in the drift.
const DRIFT_GAIN: f32 = 0.125;

/// Standard deviation of a number rounded to whole microseconds, s.
const QUANTISATION_S: f32 = 0.289e-6;

const US_PER_S: u64 = 1_000_000;

/// Converts the camera's time to UTC.
///
/// # Model
/// With the last pulse at camera time T, the beginning of second N, and the clock's drift d
/// measured from pulse to pulse (exponential mean, gain 1/8), UTC at camera time t is
/// `N + (t - T)/(1 + d)`. With `age = |t - T|`: `σ² = σ_pulse² + ((σ_d + w·age)·age)² + σ_q²`,
/// where `σ_d` is 1.25 times the mean deviation of the measured drifts, w
/// [`DRIFT_WANDER_PPM_PER_S`] and `σ_q` the rounding to microseconds. While the receiver's times
/// contradict the count of pulses, the contradiction is added to σ. So is what seconds have stepped
/// and named pulses have moved since they were first trusted, as it is not known which of the two
/// is right, until they step and move back or [`Self::clear_doubt`] is called. Where pulses move,
/// or come again after [`HOLDOVER_S`], the count goes on by the clock, as long as its drift leaves
/// no doubt of the second: names that contradict it then are a step.
#[derive(Debug, Clone)]
pub struct UtcClock {
    pulse_sigma_s: f32,
    pulse: Option<Pulse>,
    /// The last of the pulses that do not fit the earlier ones, and the number of them that fit one
    /// another.
    stray: Option<(Time, u8)>,
    doubt: Option<Doubt>,
    /// Seconds by which trusted times have stepped, and time by which named pulses have moved, s.
    stepped_s: i64,
    moved_s: f32,
    drift_ppm: f32,
    drift_sigma_ppm: f32,
    drifts: u8,
}

impl UtcClock {
    /// Returns a clock without pulses. `pulse_sigma_s` is the jitter of a pulse's time stamp as σ,
    /// s; if it is not in range, [`WORST_PULSE_SIGMA_S`] replaces it.
    #[must_use]
    pub const fn new(pulse_sigma_s: f32) -> Self {
        let possible = pulse_sigma_s >= 0.0 && pulse_sigma_s <= WORST_PULSE_SIGMA_S;
        Self {
            pulse_sigma_s: if possible {
                pulse_sigma_s
            } else {
                WORST_PULSE_SIGMA_S
            },
            pulse: None,
            stray: None,
            doubt: None,
            stepped_s: 0,
            moved_s: 0.0,
            drift_ppm: 0.0,
            drift_sigma_ppm: UNMEASURED_DRIFT_PPM,
            drifts: 0,
        }
    }

    /// Takes the edge of a pulse.
    pub fn pulse(&mut self, time: Time) -> Option<UtcFinding> {
        let Some(last) = self.pulse else {
            self.start(time, None);
            return None;
        };
        if time <= last.time {
            return Some(UtcFinding::FromThePast);
        }
        let Some((seconds, drift_ppm)) = self
            .whole_seconds(last.time, time)
            .filter(|(seconds, drift_ppm)| self.is_in_place(*seconds, *drift_ppm))
        else {
            return Some(self.take_stray(last, time));
        };
        self.stray = None;
        let has_moved = self.doubt_unmeasured(last, seconds, drift_ppm);
        self.measure(drift_ppm);
        self.pulse = Some(last.later(time, seconds));
        if has_moved {
            return Some(UtcFinding::PulsesMoved);
        }
        (seconds > 1).then(|| UtcFinding::MissingPulses(seconds.saturating_sub(1)))
    }

    /// Takes a time of the receiver, µs since 1970, whose message came at a camera time: it names
    /// the last pulse.
    ///
    /// A message comes up to a second late. With the pulse's age a at its arrival and the fraction
    /// φ of its second, the pulse began that second if `a ≥ φ`, and the next if the message was
    /// made before the pulse.
    pub fn receiver_time(&mut self, time: Time, unix_us: u64) -> Option<UtcFinding> {
        let Some(pulse) = self.pulse else {
            return Some(UtcFinding::NoPulse);
        };
        if time < pulse.time {
            return Some(UtcFinding::FromThePast);
        }
        let age_s = time.seconds_since(pulse.time);
        if age_s >= 1.0 {
            return Some(UtcFinding::NoPulse);
        }
        let second = unix_us / US_PER_S;
        let fraction_s = Time::from_us(unix_us % US_PER_S).seconds_since(Time::START);
        let second = if age_s + EARLY_S >= fraction_s {
            second
        } else {
            second.saturating_add(1)
        };
        self.name(pulse, second)
    }

    /// Returns UTC of a camera time, up to [`HOLDOVER_S`] from the last pulse; `None` while no
    /// pulse is named.
    ///
    /// # Accuracy
    /// The error is within σ; the arithmetic rounds to the microsecond.
    #[must_use]
    pub fn utc(&self, time: Time) -> Option<UtcTime> {
        let pulse = self.pulse?;
        let second = pulse.second.filter(|_| pulse.is_trusted())?;
        let age_s = time.seconds_since(pulse.time);
        let distance_s = libm::fabsf(age_s);
        if distance_s > HOLDOVER_S {
            return None;
        }
        // The drift alone is in f32: a second of age is exact in microseconds.
        let pulse_us = second.saturating_mul(US_PER_S);
        let drift = 1e-6 * self.drift_ppm;
        let correction_s = -(age_s * drift / (1.0 + drift));
        let elapsed = |from: u64| {
            let later = from.saturating_add(time.us_since(pulse.time));
            later.saturating_sub(pulse.time.us_since(time))
        };
        let unix_us = Time::from_us(elapsed(pulse_us)).plus_s(correction_s).us();
        let drift_s =
            (self.drift_sigma_ppm + DRIFT_WANDER_PPM_PER_S * distance_s) * 1e-6 * distance_s;
        let variance = self.pulse_sigma_s * self.pulse_sigma_s
            + drift_s * drift_s
            + QUANTISATION_S * QUANTISATION_S;
        Some(UtcTime {
            unix_us,
            sigma_s: fmc_camera_kernel::sqrt(variance) + self.doubt_s(),
        })
    }

    /// Returns the drift of the clock by the pulses, ppm, positive if it runs fast; `None` before
    /// the second of two pulses that are whole seconds apart.
    #[must_use]
    pub const fn drift_ppm(&self) -> Option<f32> {
        if self.drifts == 0 {
            None
        } else {
            Some(self.drift_ppm)
        }
    }

    /// Returns `true` if seconds have stepped, and if pulses have moved, so that σ covers it.
    #[must_use]
    pub fn has_stepped(&self) -> [bool; 2] {
        [self.stepped_s != 0, self.moved_s != 0.0]
    }

    /// Trusts the present pulses and seconds, for the operator.
    pub const fn clear_doubt(&mut self) {
        self.doubt = None;
        self.stepped_s = 0;
        self.moved_s = 0.0;
    }

    /// Forgets the pulses after a jump of the clock: their times cannot be compared with those to
    /// come. The drift and what has stepped and moved stay.
    pub(crate) const fn forget_pulses(&mut self) {
        self.pulse = None;
        self.stray = None;
        self.doubt = None;
    }

    /// Returns the time by which the receiver contradicts the count, or has stepped or moved, s.
    fn doubt_s(&self) -> f32 {
        let difference_s = self
            .doubt
            .map_or(0, |doubt| doubt.difference_s.unsigned_abs())
            .saturating_add(self.stepped_s.unsigned_abs());
        let seconds = Time::from_us(difference_s.saturating_mul(US_PER_S));
        seconds.seconds_since(Time::START) + libm::fabsf(self.moved_s)
    }

    /// Begins anew with a pulse, and with its second if the count goes on.
    const fn start(&mut self, time: Time, second: Option<u64>) {
        self.pulse = Some(Pulse::new(time, second));
        self.stray = None;
        self.doubt = None;
    }

    /// Returns the number of seconds from one pulse to the other, and the drift that makes them
    /// whole, ppm.
    fn whole_seconds(&self, from: Time, to: Time) -> Option<(u32, f32)> {
        let elapsed_us = to.us_since(from);
        let seconds = u32::try_from(elapsed_us.saturating_add(US_PER_S / 2) / US_PER_S).ok()?;
        if seconds == 0 {
            return None;
        }
        let whole_us = u64::from(seconds) * US_PER_S;
        let excess_s = Time::from_us(elapsed_us).seconds_since(Time::from_us(whole_us));
        let elapsed_s = Time::from_us(whole_us).seconds_since(Time::START);
        let allowed_s = CLOCK_TOLERANCE_PPM * 1e-6 * elapsed_s + 6.0 * self.pulse_sigma_s;
        // Beyond half a second their number is ambiguous.
        (libm::fabsf(excess_s) <= allowed_s && elapsed_s <= HOLDOVER_S)
            .then(|| (seconds, excess_s / elapsed_s * 1e6))
    }

    /// Returns `true` if a pulse so many seconds after the last is where the measured drift puts
    /// it, or as long as the drift is not measured.
    fn is_in_place(&self, seconds: u32, drift_ppm: f32) -> bool {
        let [off_s, drifted_s] = self.off_and_drifted_s(seconds, drift_ppm);
        self.drifts < MEASURED_DRIFTS || libm::fabsf(off_s) <= drifted_s
    }

    /// Takes a pulse that comes far from where the intervals before put it, while the drift is not
    /// measured, for a move of trusted pulses. It is used, as the intervals before may be the wrong
    /// ones, and σ covers either. Returns `true` if it is such a pulse.
    fn doubt_unmeasured(&mut self, last: Pulse, seconds: u32, drift_ppm: f32) -> bool {
        let [off_s, drifted_s] = self.off_and_drifted_s(seconds, drift_ppm);
        let has_moved = self.drifts > 0 && last.is_trusted() && libm::fabsf(off_s) > drifted_s;
        if has_moved {
            self.move_by(off_s, drifted_s);
        }
        has_moved
    }

    /// Returns how far a pulse so many seconds after the last is from where the drift so far puts
    /// it, and how far it may be, s.
    fn off_and_drifted_s(&self, seconds: u32, drift_ppm: f32) -> [f32; 2] {
        #[expect(clippy::cast_precision_loss, reason = "at most 600")]
        let elapsed_s = seconds as f32;
        let off_s = 1e-6 * (drift_ppm - self.drift_ppm) * elapsed_s;
        [off_s, self.drifted_s(elapsed_s)]
    }

    /// Returns the time by which a pulse may miss its place by the drift, an interval after another
    /// pulse, s.
    fn drifted_s(&self, elapsed_s: f32) -> f32 {
        // Both pulses have their jitter.
        let of_pulses_s = 2.0 * (self.pulse_sigma_s + QUANTISATION_S);
        let of_drift_ppm = self.drift_sigma_ppm + DRIFT_WANDER_PPM_PER_S * elapsed_s;
        PULSE_SIGMAS * (of_pulses_s + 1e-6 * of_drift_ppm * elapsed_s)
    }

    fn take_stray(&mut self, last: Pulse, time: Time) -> UtcFinding {
        let before = self
            .stray
            .filter(|(before, _)| self.whole_seconds(*before, time).is_some())
            .map_or(0, |(_, pulses)| pulses);
        let pulses = before.saturating_add(1);
        if pulses < CONSISTENT_PULSES {
            self.stray = Some((time, pulses));
            return UtcFinding::ExtraPulse;
        }
        let elapsed_s = time.seconds_since(last.time);
        let elapsed = Time::from_us(time.us_since(last.time));
        let elapsed = elapsed.plus_s(-1e-6 * self.drift_ppm * elapsed_s);
        let seconds = elapsed.us().saturating_add(US_PER_S / 2) / US_PER_S;
        let off_s = elapsed.seconds_since(Time::from_us(seconds.saturating_mul(US_PER_S)));
        let drifted_s = self.drifted_s(elapsed_s);
        // A pulse that comes sooner has been compared with its place, by the drift of that time.
        let has_moved = elapsed_s <= HOLDOVER_S || libm::fabsf(off_s) > drifted_s;
        let second = last
            .second
            .filter(|_| last.is_counted_on && drifted_s < 0.5)
            .map(|second| second.saturating_add(seconds));
        if has_moved && second.is_some() {
            self.move_by(off_s, drifted_s);
        }
        self.start(time, second);
        if has_moved {
            UtcFinding::PulsesMoved
        } else {
            let missing = seconds.saturating_sub(u64::from(CONSISTENT_PULSES));
            UtcFinding::MissingPulses(u32::try_from(missing).unwrap_or(u32::MAX))
        }
    }

    /// Adds a move of the pulses to those before. After a move back, nothing is left of them but
    /// what the drift explains.
    fn move_by(&mut self, off_s: f32, drifted_s: f32) {
        let moved_s = self.moved_s + off_s;
        let is_back = self.moved_s != 0.0 && libm::fabsf(moved_s) <= drifted_s;
        self.moved_s = if is_back { 0.0 } else { moved_s };
    }

    fn measure(&mut self, drift_ppm: f32) {
        // Error of one second between two pulses, each with its jitter.
        let least_ppm = 1.5e6 * (self.pulse_sigma_s + QUANTISATION_S);
        if self.drifts == 0 {
            self.drift_ppm = drift_ppm;
            self.drift_sigma_ppm = least_ppm;
        } else {
            // σ of a normal distribution is 1.25 of its mean deviation.
            let deviation = drift_ppm - self.drift_ppm;
            let grown = 1.25 * libm::fabsf(deviation) - self.drift_sigma_ppm;
            self.drift_ppm += DRIFT_GAIN * deviation;
            self.drift_sigma_ppm =
                (self.drift_sigma_ppm + DRIFT_GAIN * grown).max(DRIFT_GAIN * least_ppm);
        }
        self.drifts = self.drifts.saturating_add(1);
    }

    /// Compares the second that a time gives to the last pulse with the count, or begins the count.
    fn name(&mut self, pulse: Pulse, second: u64) -> Option<UtcFinding> {
        if let Some(counted) = pulse.second
            && counted != second
            && pulse.is_counted_on
        {
            return Some(self.contradict(pulse, counted, second));
        }
        self.doubt = None;
        self.pulse = Some(pulse.named(second));
        None
    }

    fn contradict(&mut self, pulse: Pulse, counted: u64, second: u64) -> UtcFinding {
        let difference_s = signed(second).saturating_sub(signed(counted));
        let doubt = Doubt::after(self.doubt, difference_s, pulse.time);
        if doubt.times >= CONSISTENT_TIMES {
            self.doubt = None;
            self.stepped_s = self.stepped_s.saturating_add(difference_s);
            self.pulse = Some(pulse.replaced(second));
            return UtcFinding::Stepped(difference_s);
        }
        self.doubt = Some(doubt);
        self.pulse = Some(pulse.contradicted());
        UtcFinding::WrongSecond(difference_s)
    }
}

/// Converts seconds to a number that may be subtracted; no more occur in the life of the sun.
fn signed(seconds: u64) -> i64 {
    i64::try_from(seconds).unwrap_or(i64::MAX)
}

#[cfg(test)]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "times in f64, exact to 0.25 µs"
)]
mod tests;
