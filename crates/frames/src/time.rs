//! UTC, GPS time and international atomic time of an exposure.

use jiff::Timestamp;

/// Source of [`GPS_MINUS_UTC`].
pub const LEAP_SECONDS: &str =
    "leap seconds of IERS Bulletin C up to 70 (July 2025): GPS - UTC = 18 s since 2017-01-01";

/// Dates since which GPS - UTC has had a value: Unix seconds, and the difference in s. Source: IERS
/// Bulletin C, as in the file `leap-seconds.list` of the IERS, there as TAI - UTC = GPS - UTC + 19
/// s and counted from 1900.
pub const GPS_MINUS_UTC: [(u64, u64); 19] = [
    (GPS_EPOCH_UNIX_S, 0),
    (362_793_600, 1),
    (394_329_600, 2),
    (425_865_600, 3),
    (489_024_000, 4),
    (567_993_600, 5),
    (631_152_000, 6),
    (662_688_000, 7),
    (709_948_800, 8),
    (741_484_800, 9),
    (773_020_800, 10),
    (820_454_400, 11),
    (867_715_200, 12),
    (915_148_800, 13),
    (1_136_073_600, 14),
    (1_230_768_000, 15),
    (1_341_100_800, 16),
    (1_435_708_800, 17),
    (1_483_228_800, 18),
];

/// 1980-01-06T00:00:00 UTC, Unix seconds.
const GPS_EPOCH_UNIX_S: u64 = 315_964_800;

/// TAI - GPS time, s.
const TAI_MINUS_GPS_S: u64 = 19;

const WEEK_S: u64 = 7 * 24 * 3600;

const US_PER_S: u64 = 1_000_000;

/// GPS time, or another one that is counted in weeks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GpsTime {
    /// Weeks since 1980-01-06, counted on without a turn-over.
    pub week: u64,
    /// Microseconds of the week.
    pub us_of_week: u64,
}

impl GpsTime {
    /// Returns the seconds of the week.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        let [seconds, us] = [self.us_of_week / US_PER_S, self.us_of_week % US_PER_S];
        let exact = |part: u64| u32::try_from(part).map_or(f64::NAN, f64::from);
        exact(seconds) + exact(us) * 1e-6
    }

    /// Returns the seconds of the week with six decimals.
    #[must_use]
    pub fn seconds_of_week(&self) -> String {
        let [seconds, us] = [self.us_of_week / US_PER_S, self.us_of_week % US_PER_S];
        format!("{seconds}.{us:06}")
    }
}

/// Returns the GPS time of an instant of UTC in Unix microseconds; `None` before GPS time began.
#[must_use]
pub fn gps(unix_us: u64) -> Option<GpsTime> {
    let [seconds, us] = [unix_us / US_PER_S, unix_us % US_PER_S];
    let since_epoch = seconds.checked_sub(GPS_EPOCH_UNIX_S)? + gps_minus_utc_s(seconds)?;
    Some(week_of(since_epoch, us))
}

/// Returns an instant of UTC in weeks and their seconds without leap seconds, as navigation files
/// "in UTC" count them; `None` before GPS time began.
#[must_use]
pub fn utc_week(unix_us: u64) -> Option<GpsTime> {
    let [seconds, us] = [unix_us / US_PER_S, unix_us % US_PER_S];
    Some(week_of(seconds.checked_sub(GPS_EPOCH_UNIX_S)?, us))
}

const fn week_of(since_epoch_s: u64, us: u64) -> GpsTime {
    GpsTime {
        week: since_epoch_s / WEEK_S,
        us_of_week: since_epoch_s % WEEK_S * US_PER_S + us,
    }
}

/// Returns the seconds and microseconds of international atomic time since 1970-01-01T00:00:00 TAI,
/// the time of PTP; `None` before GPS time began.
#[must_use]
pub fn tai(unix_us: u64) -> Option<[u64; 2]> {
    let seconds = unix_us / US_PER_S;
    Some([
        seconds + gps_minus_utc_s(seconds)? + TAI_MINUS_GPS_S,
        unix_us % US_PER_S,
    ])
}

/// Returns the calendar date and time of an instant of UTC, as ISO 8601 has it, with six decimals
/// of a second; `None` for an instant that no calendar has.
#[must_use]
pub fn date(unix_us: u64) -> Option<String> {
    let instant = Timestamp::from_microsecond(i64::try_from(unix_us).ok()?).ok()?;
    Some(format!("{instant:.6}"))
}

fn gps_minus_utc_s(unix_s: u64) -> Option<u64> {
    GPS_MINUS_UTC
        .iter()
        .rev()
        .find(|(since, _)| *since <= unix_s)
        .map(|(_, difference)| *difference)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_change_is_at_midnight_of_a_first_of_january_or_july() {
        for ((since, difference), expected) in GPS_MINUS_UTC.into_iter().zip(0..) {
            assert_eq!(difference, expected);
            let date = date(since * US_PER_S).unwrap();
            let is_first = ["-01-01T00", "-07-01T00", "1980-01-06T00"];
            assert!(is_first.iter().any(|one| date.contains(one)), "{date}");
        }
    }

    #[test]
    fn times_of_known_instants() {
        // 2020-01-01T00:00:00 UTC, a Wednesday: week 2086, 3 days and 18 s.
        let new_year = 1_577_836_800_000_000;
        let expected = GpsTime {
            week: 2086,
            us_of_week: (3 * 86_400 + 18) * US_PER_S,
        };
        assert_eq!(gps(new_year), Some(expected));
        assert_eq!(tai(new_year + 7), Some([1_577_836_837, 7]));
        assert_eq!(
            date(new_year + 250_000).as_deref(),
            Some("2020-01-01T00:00:00.250000Z")
        );
        // The week turns 18 s before midnight of Saturday, UTC.
        let turn = 1_578_182_382_000_000;
        assert_eq!(date(turn).as_deref(), Some("2020-01-04T23:59:42.000000Z"));
        let before = gps(turn - 1).unwrap();
        assert_eq!((before.week, gps(turn).unwrap().week), (2086, 2087));
        assert_eq!(before.us_of_week, WEEK_S * US_PER_S - 1);
        assert_eq!(gps(turn).unwrap().us_of_week, 0);
        assert_eq!(utc_week(turn).unwrap().seconds_of_week(), "604782.000000");
        assert!((gps(turn - 1).unwrap().seconds() - 604_799.999_999).abs() < 1e-9);
        assert_eq!(gps(315_964_799_999_999), None);
        assert_eq!(tai(0), None);
        assert_eq!(date(u64::MAX), None);
    }
}
