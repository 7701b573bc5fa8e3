//! Satellite receiver: speed, altitude and time in sentences (NMEA 0183).

use fmc_camera::io::instruments::counters::ReceiverCounters;
use fmc_camera::io::nmea::M_PER_S_PER_KNOT;

/// Seconds of a day.
const DAY_S: u64 = 86_400;

/// Counts of the receiver's sentences.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SentenceCounts {
    /// Sentences that the receiver sent.
    pub sent: u32,
    /// Sentences that the camera's decoder read.
    pub read: u32,
    /// Sentences that the decoder refused: truncated, with a wrong checksum or without a fix.
    pub refused: u32,
    /// Bytes that the line lost.
    pub lost_bytes: u32,
}

impl SentenceCounts {
    /// Combines the counts of both ends of the wire.
    pub(super) const fn of(sent: u32, lost_bytes: u32, camera: &ReceiverCounters) -> Self {
        Self {
            sent,
            read: camera.read,
            refused: camera.truncated
                + camera.oversized
                + camera.checksum
                + camera.malformed
                + camera.no_fix
                + camera.simulated_fix
                + camera.invalid_time
                + camera.before_year_2000
                + camera.out_of_range,
            lost_bytes,
        }
    }
}

/// Formats ground speed as the sentence VTG; without a number, the field is empty.
pub(super) fn speed(speed_m_s: f32) -> String {
    sentence(&format!(
        "GPVTG,0.0,T,,M,{},N,{},K,A",
        number(speed_m_s / M_PER_S_PER_KNOT, 3),
        number(3.6 * speed_m_s, 3)
    ))
}

/// Formats altitude as the sentence GGA; position and time of day are left empty.
pub(super) fn altitude(altitude_m: f32) -> String {
    sentence(&format!(
        "GPGGA,,,,,,4,12,0.8,{},M,0.0,M,1.0,0000",
        number(altitude_m, 2)
    ))
}

/// Formats a time, s since 1970, as the sentence RMC; without a speed, its field is empty.
pub(super) fn time(unix_s: u64, speed_m_s: Option<f32>) -> String {
    let (day, second) = (unix_s / DAY_S, unix_s % DAY_S);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    let knots = speed_m_s.map_or(String::new(), |speed| number(speed / M_PER_S_PER_KNOT, 3));
    sentence(&format!(
        "GPRMC,{hour:02}{minute:02}{second:02}.00,A,,,,,{knots},0.0,{},,,A",
        date(day)
    ))
}

/// Formats the date of a day since 1970 as `ddmmyy`.
fn date(day: u64) -> String {
    // Hinnant, chrono-compatible low-level date algorithms: years begin on the first of March.
    let day = day + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = 400 * era + year + u64::from(month <= 2);
    format!("{day:02}{month:02}{:02}", year % 100)
}

fn number(value: f32, places: usize) -> String {
    if value.is_finite() {
        format!("{value:.places$}")
    } else {
        String::new()
    }
}

fn sentence(fields: &str) -> String {
    let checksum = fields.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${fields}*{checksum:02X}\r\n")
}

#[cfg(test)]
mod tests {
    use fmc_camera::flight::vh::VhSample;
    use fmc_camera::io::nmea::{NmeaError, NmeaReading, NmeaReceiver};

    use super::*;

    fn read(sentence: &str) -> Result<NmeaReading, NmeaError> {
        let mut receiver = NmeaReceiver::new();
        let mut answers = sentence.bytes().filter_map(|byte| receiver.receive(byte));
        answers.next().unwrap()
    }

    #[test]
    fn speed_and_altitude_come_through_to_half_of_their_last_digit() {
        let Some(VhSample::GroundSpeed(speed_m_s)) = read(&speed(96.123)).unwrap().sample else {
            panic!()
        };
        assert!((speed_m_s - 96.123).abs() < 3e-4, "{speed_m_s}");
        let sample = read(&altitude(901.25)).unwrap().sample;
        assert_eq!(sample, Some(VhSample::Altitude(901.25)));
        assert_eq!(read(&speed(f32::NAN)), Err(NmeaError::NoFix));
    }

    #[test]
    fn time_of_every_month_is_that_of_the_second() {
        for month in 0..1000 {
            // 24 days and some hours, from 2000-01-01 to 2066.
            let unix_s = 946_684_800 + 2_100_007 * month;
            let reading = read(&time(unix_s, None)).unwrap();
            assert_eq!(reading.unix_us, Some(1_000_000 * unix_s));
            assert_eq!(reading.sample, None);
        }
        assert!(
            read(&time(1_790_000_000, Some(96.0)))
                .unwrap()
                .sample
                .is_some()
        );
    }
}
