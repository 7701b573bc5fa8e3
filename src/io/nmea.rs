//! Sentences of a satellite receiver (NMEA 0183): speed, altitude, position and time, byte by byte.
//!
//! The receiver reads GGA, RMC and VTG of any talker, and ignores every other sentence. A sentence
//! is read only if it is printable ASCII, no longer than [`LONGEST_SENTENCE`], and its checksum is
//! right. Only the fields that the camera uses are read. A number is digits with at most one point,
//! so that "nan" and "1e3" are not numbers. A sentence is refused if one of those fields does not
//! follow the standard.
//!
//! The link check of `tests/no-panic` covers this module, and the flight images contain it. A test
//! compares it with the crate `nmea`.

mod fields;
mod number;
mod reading;

use heapless::Vec;

pub use self::reading::{LONGEST_SENTENCE, M_PER_S_PER_KNOT, NmeaError, NmeaPosition, NmeaReading};

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
    // A comma follows the name, and the fields follow the comma.
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
