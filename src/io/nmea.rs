//! Sentences of a satellite receiver (NMEA 0183): speed, altitude, position and time, byte by byte.
//!
//! Read are GGA, RMC and VTG of any talker; every other sentence is passed over. A sentence is read only when it is
//! printable ASCII, no longer than [`LONGEST_SENTENCE`] and its checksum is right. Of its fields those are read that
//! the camera uses; numbers are digits with one point, so that "nan" and "1e3" are none. A field that is read and is
//! not what the standard says refuses the whole sentence.
//!
//! The link check of `tests/no-panic` has this module, and the flight images use it. A test compares what it reads with
//! the crate `nmea`.

mod fields;
mod number;

use core::fmt;

use heapless::Vec;

use crate::flight::vh::VhSample;
use crate::geometry::range::OutOfRange;

/// Longest sentence from `$` to the checksum, bytes: 80 by the standard, and what receivers are known to exceed it by.
pub const LONGEST_SENTENCE: usize = 100;

/// Metres per second in a knot: 1852 m per hour.
pub const M_PER_S_PER_KNOT: f32 = 1852.0 / 3600.0;

/// Where the receiver's antenna is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NmeaPosition {
    /// Latitude, ten-thousandths of a minute of arc (0.19 m), positive north.
    pub latitude: i32,
    /// Longitude, ten-thousandths of a minute of arc, positive east.
    pub longitude: i32,
}

/// What a sentence says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NmeaReading {
    /// Two letters that say who speaks: `GP`, `GN` and others.
    pub talker: [u8; 2],
    /// Ground speed (RMC, VTG) or altitude above sea level (GGA).
    pub sample: Option<VhSample>,
    /// Date and time of the fix (RMC), µs since 1970-01-01T00:00:00 UTC; a year of 2000 to 2079.
    pub unix_us: Option<u64>,
    /// Position (GGA, RMC).
    pub position: Option<NmeaPosition>,
}

/// Why a sentence is not used.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NmeaError {
    /// Another sentence begins, or a byte that is no text comes, before its end.
    Truncated,
    /// It is longer than [`LONGEST_SENTENCE`].
    Oversized,
    /// It has no checksum, or a wrong one.
    Checksum,
    /// Its fields are not those of its name.
    Malformed,
    /// The receiver says itself that it has no fix, or an estimated one.
    NoFix,
    /// The receiver says itself that its fix is simulated, or was entered by hand.
    SimulatedFix,
    /// Its date does not exist, as the 30th of February.
    InvalidDate,
    /// Its time of day does not exist; leap seconds are none.
    InvalidTime,
    /// Its year is before 2000: the receiver's count of weeks has begun again, or it has not found the time yet.
    BeforeYear2000,
    /// A number outside its range.
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
            Self::SimulatedFix => f.write_str("fix of the receiver is simulated"),
            Self::InvalidDate => f.write_str("date of a sentence does not exist"),
            Self::InvalidTime => f.write_str("time of a sentence does not exist"),
            Self::BeforeYear2000 => f.write_str("year of a sentence is before 2000"),
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
    unexplained: u32,
}

impl NmeaReceiver {
    /// Returns a receiver before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            sentence: Vec::new(),
            unexplained: 0,
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
                self.give_up();
                // There is room in an empty buffer.
                let _ = self.sentence.push(byte);
                under_way.then_some(Err(NmeaError::Truncated))
            }
            b'\r' | b'\n' if !under_way => None,
            _ if !under_way => {
                self.unexplained = self.unexplained.saturating_add(1);
                None
            }
            b'\r' | b'\n' => {
                let reading = read(&self.sentence).transpose();
                self.sentence.clear();
                reading
            }
            b' '..=b'~' => {
                let full = self.sentence.push(byte).is_err();
                if full {
                    self.give_up();
                }
                full.then_some(Err(NmeaError::Oversized))
            }
            _ => {
                self.give_up();
                Some(Err(NmeaError::Truncated))
            }
        }
    }

    /// Returns true if a sentence has begun and not ended.
    #[must_use]
    pub fn is_under_way(&self) -> bool {
        !self.sentence.is_empty()
    }

    /// Returns the number of bytes that belong to no whole sentence since the last call. Many of
    /// them indicate a wrong baud rate.
    pub const fn take_unexplained(&mut self) -> u32 {
        core::mem::replace(&mut self.unexplained, 0)
    }

    fn give_up(&mut self) {
        let bytes = u32::try_from(self.sentence.len()).unwrap_or(u32::MAX);
        self.unexplained = self.unexplained.saturating_add(bytes);
        self.sentence.clear();
    }
}

/// Reads a sentence from `$` to its checksum; `None` if it is not one of those that are read.
fn read(sentence: &[u8]) -> Result<Option<NmeaReading>, NmeaError> {
    let checked = checked(sentence).ok_or(NmeaError::Checksum)?;
    let Some((talker, rest)) = checked.split_first_chunk::<2>() else {
        return Ok(None);
    };
    let Some((name, fields)) = rest.split_first_chunk::<3>() else {
        return Ok(None);
    };
    // What follows the name begins with a comma, behind which are the fields.
    let fields = match fields.split_first() {
        Some((b',', fields)) => fields,
        _ => &[],
    };
    fields::read(name, *talker, fields)
}

/// Returns the part of a sentence that the checksum covers, if the checksum is right.
fn checked(sentence: &[u8]) -> Option<&[u8]> {
    let (text, [star, high, low]) = sentence.split_last_chunk::<3>()?;
    let (_, checked) = text.split_first()?;
    let given = 16 * hexadecimal(*high)? + hexadecimal(*low)?;
    let right = checked.iter().fold(0, |sum, byte| sum ^ byte);
    (*star == b'*' && given == right).then_some(checked)
}

fn hexadecimal(digit: u8) -> Option<u8> {
    match digit {
        b'0'..=b'9' => Some(digit - b'0'),
        b'A'..=b'F' => Some(digit - b'A' + 10),
        b'a'..=b'f' => Some(digit - b'a' + 10),
        _ => None,
    }
}
