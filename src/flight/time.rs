//! The camera's own time: microseconds since it started.

use core::fmt;

/// An instant of the camera's clock, µs since it started; it never wraps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Time {
    us: u64,
}

impl Time {
    /// The start of the clock.
    pub const START: Self = Self { us: 0 };

    /// Returns the instant a number of microseconds after the start.
    #[must_use]
    pub const fn from_us(us: u64) -> Self {
        Self { us }
    }

    /// Microseconds since the start.
    #[must_use]
    pub const fn us(self) -> u64 {
        self.us
    }

    /// Returns the time from `earlier` to this instant, s; negative if `earlier` is later.
    ///
    /// # Accuracy
    /// The difference is exact in microseconds; its rounding is 6e-8 of it.
    #[must_use]
    pub const fn seconds_since(self, earlier: Self) -> f32 {
        if self.us >= earlier.us {
            rounded(self.us - earlier.us) * 1e-6
        } else {
            rounded(earlier.us - self.us) * -1e-6
        }
    }

    /// Returns the time from `earlier` to this instant, µs; 0 if `earlier` is later.
    #[must_use]
    pub const fn us_since(self, earlier: Self) -> u64 {
        self.us.saturating_sub(earlier.us)
    }

    /// Returns the instant a number of seconds later or earlier, to the nearest microsecond; it
    /// stays between the ends of the clock, and a NaN counts as 0.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the casts saturate"
    )]
    pub fn plus_s(self, seconds: f32) -> Self {
        let us = libm::roundf(libm::fabsf(seconds) * 1e6) as u64;
        Self {
            us: if seconds < 0.0 {
                self.us.saturating_sub(us)
            } else {
                self.us.saturating_add(us)
            },
        }
    }
}

/// Returns the nearest number of single precision. A core converts 32 bits by itself, more in
/// software.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "of 32 bits none is lost, and the rounding is stated"
)]
const fn rounded(us: u64) -> f32 {
    if us <= u32::MAX as u64 {
        us as u32 as f32
    } else {
        rounded_beyond_32_bits(us)
    }
}

/// Returns the nearest number of single precision; apart, so that it is called only if needed.
#[cold]
#[inline(never)]
#[expect(clippy::cast_precision_loss, reason = "the rounding is stated")]
const fn rounded_beyond_32_bits(us: u64) -> f32 {
    us as f32
}

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{:06} s", self.us / 1_000_000, self.us % 1_000_000)
    }
}

/// Extends a 32-bit counter of microseconds, which wraps every 71 minutes, to a time that never
/// wraps.
///
/// The counter must be read at least once per half period (35 minutes); readings taken in an
/// interrupt may be up to that much older than the last one extended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Clock {
    now: Time,
}

impl Clock {
    /// Returns a clock whose counter started at 0.
    #[must_use]
    pub const fn new() -> Self {
        Self { now: Time::START }
    }

    /// Returns the time of a reading: the one nearest to the last.
    pub fn extend(&mut self, counter_us: u32) -> Time {
        let [b0, b1, b2, b3, ..] = self.now.us.to_le_bytes();
        let ahead = counter_us
            .wrapping_sub(u32::from_le_bytes([b0, b1, b2, b3]))
            .cast_signed();
        let time = Time {
            us: self.now.us.saturating_add_signed(i64::from(ahead)),
        };
        // A stamp from before does not set the clock back.
        self.now = self.now.max(time);
        time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_exact_and_signed() {
        let (a, b) = (Time::from_us(4_300_000_000), Time::from_us(4_300_001_500));
        assert!((b.seconds_since(a) - 1.5e-3).abs() < 1e-9);
        assert!((a.seconds_since(b) + 1.5e-3).abs() < 1e-9);
        assert_eq!((b.us_since(a), a.us_since(b)), (1500, 0));
    }

    #[test]
    fn seconds_are_added_to_the_microsecond_and_saturate() {
        let start = Time::from_us(1000);
        assert_eq!(start.plus_s(2.5e-3).us(), 3500);
        assert_eq!(start.plus_s(-2.5e-3), Time::START);
        assert_eq!(start.plus_s(f32::NAN), start);
        assert_eq!(start.plus_s(f32::INFINITY).us(), u64::MAX);
        assert_eq!(std::format!("{}", Time::from_us(1_000_020)), "1.000020 s");
    }

    #[test]
    fn counter_that_wraps_goes_on_and_stamps_from_before_are_in_the_past() {
        let mut clock = Clock::new();
        assert_eq!(clock.extend(2_000_000_000).us(), 2_000_000_000);
        assert_eq!(clock.extend(3_500_000_000).us(), 3_500_000_000);
        assert_eq!(clock.extend(u32::MAX - 5).us(), u64::from(u32::MAX) - 5);
        let now = clock.extend(10);
        assert_eq!(now.us(), (1 << 32) + 10);
        // The stamp was captured before the wrap and handed over after it.
        assert_eq!(clock.extend(u32::MAX - 20).us(), (1 << 32) - 21);
        assert_eq!(clock.extend(11).us(), now.us() + 1);
    }
}
