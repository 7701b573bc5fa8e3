//! Sentences of a satellite receiver (NMEA 0183): speed, altitude and time, byte by byte.
//!
//! The receiver reads GGA, RMC and VTG of any talker, and ignores every other sentence. A sentence
//! is handed to the crate `nmea` only when it is printable ASCII, no longer than
//! [`LONGEST_SENTENCE`] and its checksum is right, so that the crate gets only sentences as they
//! were sent. The crate accepts "nan" and "inf" for numbers and any number of satellites; values
//! are checked here again.
//!
//! The crate reads numbers with the core library's parser. Neither was written to be free of panics
//! in the sense of the link check of `tests/no-panic`, which therefore leaves this module out, and
//! the flight images leave the feature off; the fuzz target `nmea` found none.

use core::fmt;

use heapless::Vec;
use nmea::sentences::{FaaMode, GgaData, RmcData, VtgData, rmc::RmcStatusOfFix};
use nmea::{NmeaSentence, SentenceType, parse_nmea_sentence};

use crate::flight::vh::VhSample;
use crate::geometry::range::{OutOfRange, Quantity};

/// Longest sentence from `$` to the checksum, bytes: 80 by the standard, and the known excess of
/// receivers.
pub const LONGEST_SENTENCE: usize = 100;

/// Metres per second in a knot: 1852 m per hour.
pub const M_PER_S_PER_KNOT: f32 = 1852.0 / 3600.0;

/// Content of a sentence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NmeaReading {
    /// Ground speed (RMC, VTG) or altitude above sea level (GGA).
    pub sample: Option<VhSample>,
    /// Date and time of the fix (RMC), µs since 1970-01-01T00:00:00 UTC.
    pub unix_us: Option<u64>,
}

/// The reason why a sentence is not used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NmeaError {
    /// Another sentence begins, or a byte that is not text comes, before its end.
    Truncated,
    /// It is longer than [`LONGEST_SENTENCE`].
    Oversized,
    /// It has no checksum, or a wrong one.
    Checksum,
    /// Its fields are not those of its name.
    Malformed,
    /// The receiver itself reports that it has no fix, or a simulated one.
    NoFix,
    /// A number is outside its range.
    OutOfRange(OutOfRange),
}

impl fmt::Display for NmeaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated => f.write_str("sentence has no end"),
            Self::Oversized => write!(f, "sentence is longer than {LONGEST_SENTENCE} bytes"),
            Self::Checksum => f.write_str("checksum of a sentence is wrong or missing"),
            Self::Malformed => f.write_str("fields of a sentence are not those of its name"),
            Self::NoFix => f.write_str("receiver has no fix"),
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for NmeaError {}

/// Cuts a receiver's bytes into sentences and reads them.
#[derive(Debug, Clone, Default)]
pub struct NmeaReceiver {
    /// Bytes from `$` on; empty between sentences.
    sentence: Vec<u8, LONGEST_SENTENCE>,
}

impl NmeaReceiver {
    /// Returns a receiver before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            sentence: Vec::new(),
        }
    }

    /// Takes one byte. If it ends a sentence, returns a reading, or the reason why there is none.
    ///
    /// # Errors
    /// [`NmeaError`]; the next `$` begins a sentence after any bytes before it.
    pub fn receive(&mut self, byte: u8) -> Option<Result<NmeaReading, NmeaError>> {
        let under_way = !self.sentence.is_empty();
        match byte {
            b'$' => {
                self.sentence.clear();
                // There is room in an empty buffer.
                let _ = self.sentence.push(byte);
                under_way.then_some(Err(NmeaError::Truncated))
            }
            _ if !under_way => None,
            b'\r' | b'\n' => {
                let reading = read(&self.sentence).transpose();
                self.sentence.clear();
                reading
            }
            b' '..=b'~' => {
                let full = self.sentence.push(byte).is_err();
                if full {
                    self.sentence.clear();
                }
                full.then_some(Err(NmeaError::Oversized))
            }
            _ => {
                self.sentence.clear();
                Some(Err(NmeaError::Truncated))
            }
        }
    }
}

/// Reads a sentence from `$` to its checksum; `None` if it is not one of those that are read.
fn read(sentence: &[u8]) -> Result<Option<NmeaReading>, NmeaError> {
    let checksum_is_right =
        sentence
            .split_last_chunk::<3>()
            .and_then(|(text, [star, high, low])| {
                let (_, checked) = text.split_first()?;
                let given = 16 * hexadecimal(*high)? + hexadecimal(*low)?;
                let right = checked.iter().fold(0, |sum, byte| sum ^ byte);
                Some(*star == b'*' && given == right)
            });
    if checksum_is_right != Some(true) {
        return Err(NmeaError::Checksum);
    }
    let text = core::str::from_utf8(sentence).map_err(|_| NmeaError::Malformed)?;
    // `$`, two letters of the talker, three of the sentence.
    let name = sentence.get(3..6);
    if ![b"GGA", b"RMC", b"VTG"]
        .iter()
        .any(|read| name == Some(read.as_slice()))
    {
        return Ok(None);
    }
    let sentence = parse_nmea_sentence(text).map_err(|_| NmeaError::Malformed)?;
    fields(sentence).map(Some)
}

fn fields(sentence: NmeaSentence<'_>) -> Result<NmeaReading, NmeaError> {
    let malformed = |_| NmeaError::Malformed;
    match sentence.message_id {
        SentenceType::GGA => of_gga(&nmea::sentences::parse_gga(sentence).map_err(malformed)?),
        SentenceType::RMC => of_rmc(&nmea::sentences::parse_rmc(sentence).map_err(malformed)?),
        SentenceType::VTG => of_vtg(&nmea::sentences::parse_vtg(sentence).map_err(malformed)?),
        _ => Err(NmeaError::Malformed),
    }
}

fn of_gga(gga: &GgaData) -> Result<NmeaReading, NmeaError> {
    if !gga.fix_type.is_some_and(nmea::sentences::FixType::is_valid) {
        return Err(NmeaError::NoFix);
    }
    let altitude_m = gga.altitude.ok_or(NmeaError::NoFix)?;
    let altitude_m = Quantity::AltitudeM
        .check(altitude_m)
        .map_err(NmeaError::OutOfRange)?;
    Ok(NmeaReading {
        sample: Some(VhSample::Altitude(altitude_m)),
        unix_us: None,
    })
}

fn of_rmc(rmc: &RmcData) -> Result<NmeaReading, NmeaError> {
    let measured = matches!(
        rmc.faa_mode,
        None | Some(
            FaaMode::Autonomous
                | FaaMode::Differential
                | FaaMode::Precise
                | FaaMode::FixedRtk
                | FaaMode::FloatRtk
        )
    );
    if rmc.status_of_fix == RmcStatusOfFix::Invalid || !measured {
        return Err(NmeaError::NoFix);
    }
    let time = rmc.fix_date.zip(rmc.fix_time).and_then(|(date, time)| {
        let unix_us = date.and_time(time).and_utc().timestamp_micros();
        u64::try_from(unix_us).ok()
    });
    Ok(NmeaReading {
        sample: rmc.speed_over_ground.map(speed).transpose()?,
        unix_us: time,
    })
}

fn of_vtg(vtg: &VtgData) -> Result<NmeaReading, NmeaError> {
    let knots = vtg.speed_over_ground.ok_or(NmeaError::NoFix)?;
    Ok(NmeaReading {
        sample: Some(speed(knots)?),
        unix_us: None,
    })
}

fn speed(knots: f32) -> Result<VhSample, NmeaError> {
    Quantity::GroundSpeedMS
        .check(knots * M_PER_S_PER_KNOT)
        .map(VhSample::GroundSpeed)
        .map_err(NmeaError::OutOfRange)
}

fn hexadecimal(digit: u8) -> Option<u8> {
    match digit {
        b'0'..=b'9' => Some(digit - b'0'),
        b'A'..=b'F' => Some(digit - b'A' + 10),
        b'a'..=b'f' => Some(digit - b'a' + 10),
        _ => None,
    }
}
