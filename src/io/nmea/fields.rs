//! Fields of the sentences that are read.

use super::number::{fraction, single, whole};
use super::reading::{M_PER_S_PER_KNOT, NmeaError, NmeaPosition, NmeaReading};
use crate::flight::vh::VhSample;
use crate::geometry::range::Quantity;

/// Days from 1970-01-01 to 2000-01-01.
const DAYS_TO_2000: u32 = 10_957;

/// Two digits from here on mean a year of the last century: a clock that has not been set begins in
/// 1970 or 1980.
const FIRST_YEAR_OF_1900S: u32 = 70;

const US_PER_S: u64 = 1_000_000;

/// Ten-thousandths of a minute in a degree.
const UNITS_PER_DEGREE: i32 = 600_000;

/// Reads the fields of a sentence with a name of three letters; `None` for a sentence that is
/// ignored.
pub(super) fn read(
    name: &[u8],
    talker: [u8; 2],
    fields: &[u8],
) -> Result<Option<NmeaReading>, NmeaError> {
    let fields = Fields(fields);
    let reading = match name {
        b"GGA" => of_gga(talker, fields)?,
        b"RMC" => of_rmc(talker, fields)?,
        b"VTG" => of_vtg(talker, fields)?,
        _ => return Ok(None),
    };
    Ok(Some(reading))
}

/// The text behind the name, split at the commas.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    /// Returns the next field; empty behind the last, since receivers leave out fields at the end.
    fn next(&mut self) -> &'a [u8] {
        let comma = self.0.iter().position(|byte| *byte == b',');
        let (field, rest) = comma
            .and_then(|comma| self.0.split_at_checked(comma))
            .unwrap_or((self.0, &[]));
        self.0 = rest.split_first().map_or(&[], |(_, rest)| rest);
        field
    }

    fn skip(&mut self, count: usize) {
        for _ in 0..count {
            self.next();
        }
    }

    /// Reads latitude and longitude with their hemispheres; `None` if they are empty.
    fn position(&mut self) -> Result<Option<NmeaPosition>, NmeaError> {
        let (latitude, north, longitude, east) =
            (self.next(), self.next(), self.next(), self.next());
        if latitude.is_empty() && longitude.is_empty() {
            return Ok(None);
        }
        let position = || {
            Some(NmeaPosition {
                latitude: angle(latitude, 2, north, *b"NS")?,
                longitude: angle(longitude, 3, east, *b"EW")?,
            })
        };
        position().map(Some).ok_or(NmeaError::Malformed)
    }
}

/// `GGA`: time, position, quality, satellites, dilution, altitude, its unit.
fn of_gga(talker: [u8; 2], mut fields: Fields<'_>) -> Result<NmeaReading, NmeaError> {
    let time = fields.next();
    let position = fields.position()?;
    match fields.next() {
        b"1" | b"2" | b"3" | b"4" | b"5" => {}
        b"" | b"0" | b"6" => return Err(NmeaError::NoFix),
        b"7" | b"8" => return Err(NmeaError::SimulatedFix),
        _ => return Err(NmeaError::Malformed),
    }
    fields.skip(2);
    let (altitude, unit) = (fields.next(), fields.next());
    let altitude = present(altitude).ok_or(NmeaError::NoFix)?;
    let altitude_m = single(altitude).ok_or(NmeaError::Malformed)?;
    if unit != b"M" {
        return Err(NmeaError::Malformed);
    }
    present(time).map(time_of_day_us).transpose()?;
    let altitude_m = Quantity::AltitudeM
        .check(altitude_m)
        .map_err(NmeaError::OutOfRange)?;
    Ok(NmeaReading {
        talker,
        sample: Some(VhSample::Altitude(altitude_m)),
        unix_us: None,
        position,
    })
}

/// `RMC`: time, status, position, knots, course, date, variation and its sign, mode.
fn of_rmc(talker: [u8; 2], mut fields: Fields<'_>) -> Result<NmeaReading, NmeaError> {
    let (time, status) = (fields.next(), fields.next());
    let position = fields.position()?;
    let (knots, _course, date) = (fields.next(), fields.next(), fields.next());
    fields.skip(2);
    match status {
        b"A" | b"D" => check_mode(fields.next())?,
        b"V" => return Err(NmeaError::NoFix),
        _ => return Err(NmeaError::Malformed),
    }
    let day = present(date).map(unix_day).transpose()?;
    let time_us = present(time).map(time_of_day_us).transpose()?;
    let unix_us = day
        .zip(time_us)
        .map(|(day, time_us)| US_PER_S * 86_400 * u64::from(day) + time_us);
    let sample = present(knots).map(speed).transpose()?;
    Ok(NmeaReading {
        talker,
        sample,
        unix_us,
        position,
    })
}

/// `VTG`: course, T, magnetic course, M, knots, N, km/h, K, mode.
fn of_vtg(talker: [u8; 2], mut fields: Fields<'_>) -> Result<NmeaReading, NmeaError> {
    fields.skip(4);
    let (knots, unit) = (fields.next(), fields.next());
    fields.skip(2);
    check_mode(fields.next())?;
    let knots = present(knots).ok_or(NmeaError::NoFix)?;
    if unit != b"N" {
        return Err(NmeaError::Malformed);
    }
    Ok(NmeaReading {
        talker,
        sample: Some(speed(knots)?),
        unix_us: None,
        position: None,
    })
}

/// Returns a field that is not empty.
fn present(field: &[u8]) -> Option<&[u8]> {
    (!field.is_empty()).then_some(field)
}

/// Checks the mode in which the receiver computed its numbers (since version 2.3 of the standard).
fn check_mode(mode: &[u8]) -> Result<(), NmeaError> {
    match mode {
        b"" | b"A" | b"D" | b"P" | b"R" | b"F" => Ok(()),
        b"E" | b"N" => Err(NmeaError::NoFix),
        b"M" | b"S" => Err(NmeaError::SimulatedFix),
        _ => Err(NmeaError::Malformed),
    }
}

fn speed(knots: &[u8]) -> Result<VhSample, NmeaError> {
    let knots = single(knots).ok_or(NmeaError::Malformed)?;
    Quantity::GroundSpeedMS
        .check(knots * M_PER_S_PER_KNOT)
        .map(VhSample::GroundSpeed)
        .map_err(NmeaError::OutOfRange)
}

/// Microseconds since midnight of `hhmmss.sss`; digits behind the microseconds are left out.
fn time_of_day_us(field: &[u8]) -> Result<u64, NmeaError> {
    let read = || {
        let (digits, behind) = field.split_at_checked(6)?;
        let digits = whole(digits)?;
        let (hour, minute, second) = (digits / 10_000, digits / 100 % 100, digits % 100);
        let microseconds = fraction(behind, 6)?;
        Some((hour, minute, second, microseconds))
    };
    let (hour, minute, second, microseconds) = read().ok_or(NmeaError::Malformed)?;
    // Unix time has no place for a leap second.
    if hour > 23 || minute > 59 || second > 59 {
        return Err(NmeaError::InvalidTime);
    }
    let second = 3600 * hour + 60 * minute + second;
    Ok(US_PER_S * u64::from(second) + u64::from(microseconds))
}

/// Days since 1970-01-01 of `ddmmyy`, a date from 2000 to 2069.
fn unix_day(field: &[u8]) -> Result<u32, NmeaError> {
    let digits = (field.len() == 6).then(|| whole(field)).flatten();
    let digits = digits.ok_or(NmeaError::Malformed)?;
    let (day, month, year) = (digits / 10_000, digits / 100 % 100, digits % 100);
    // Every fourth year from 2000 to 2069 is a leap year, 2000 included.
    let is_leap = year.is_multiple_of(4);
    let (before, days) = match month {
        1 => (0, 31),
        2 => (31, if is_leap { 29 } else { 28 }),
        3 => (59, 31),
        4 => (90, 30),
        5 => (120, 31),
        6 => (151, 30),
        7 => (181, 31),
        8 => (212, 31),
        9 => (243, 30),
        10 => (273, 31),
        11 => (304, 30),
        12 => (334, 31),
        _ => return Err(NmeaError::InvalidDate),
    };
    if day == 0 || day > days {
        return Err(NmeaError::InvalidDate);
    }
    if year >= FIRST_YEAR_OF_1900S {
        return Err(NmeaError::BeforeYear2000);
    }
    let leap_days = year.div_ceil(4) + u32::from(is_leap && month > 2);
    Ok(DAYS_TO_2000 + 365 * year + leap_days + before + day - 1)
}

/// Ten-thousandths of a minute of `ddmm.mmmm` or `dddmm.mmmm`; positive in the first hemisphere of
/// the two.
fn angle(
    field: &[u8],
    degree_digits: usize,
    hemisphere: &[u8],
    [positive, negative]: [u8; 2],
) -> Option<i32> {
    let (degrees, minutes) = field.split_at_checked(degree_digits)?;
    let (minutes, behind) = minutes.split_at_checked(2)?;
    let (degrees, minutes) = (whole(degrees)?, whole(minutes)?);
    let units = 10_000 * minutes + fraction(behind, 4)?;
    let most = if degree_digits == 2 { 90 } else { 180 };
    let angle = UNITS_PER_DEGREE * i32::try_from(degrees).ok()? + i32::try_from(units).ok()?;
    if angle > UNITS_PER_DEGREE * most || minutes > 59 {
        return None;
    }
    match hemisphere {
        [side] if *side == positive => Some(angle),
        [side] if *side == negative => Some(-angle),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::format;

    use super::unix_day;
    use crate::io::nmea::reading::NmeaError;

    #[test]
    fn days_are_counted_without_gap_from_2000_to_2069() {
        let mut expected = 10_957;
        for year in 0..70 {
            for month in 1..=12 {
                let days = (1..=31).filter_map(|day| {
                    let field = format!("{day:02}{month:02}{year:02}");
                    unix_day(field.as_bytes()).ok()
                });
                for day in days {
                    assert_eq!(day, expected, "20{year:02}-{month:02}");
                    expected += 1;
                }
            }
        }
        // date -u -d 2070-01-01 +%s, in days.
        assert_eq!(expected, 36_525);
    }

    #[test]
    fn date_that_does_not_exist_and_year_before_2000_are_told_apart() {
        for field in [
            "300226", "290226", "310426", "001226", "321226", "011326", "010026",
        ] {
            assert_eq!(unix_day(field.as_bytes()), Err(NmeaError::InvalidDate));
        }
        for field in ["010170", "311279", "060180", "191194", "311299"] {
            assert_eq!(unix_day(field.as_bytes()), Err(NmeaError::BeforeYear2000));
        }
        for field in ["", "1111", "11112026", "1a1126"] {
            assert_eq!(unix_day(field.as_bytes()), Err(NmeaError::Malformed));
        }
    }
}
