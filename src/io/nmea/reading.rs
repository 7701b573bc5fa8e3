//! Content of a sentence, or the reason why it is not used.

use core::fmt;

use crate::flight::vh::VhSample;
use crate::geometry::range::OutOfRange;

/// Longest sentence from `$` to the checksum, bytes: 80 by the standard, and the known excess of
/// receivers.
pub const LONGEST_SENTENCE: usize = 100;

/// Metres per second in a knot: 1852 m per hour.
pub const M_PER_S_PER_KNOT: f32 = 1852.0 / 3600.0;

/// Position of the receiver's antenna.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NmeaPosition {
    /// Latitude, ten-thousandths of a minute of arc (0.19 m), positive north.
    pub latitude: i32,
    /// Longitude, ten-thousandths of a minute of arc, positive east.
    pub longitude: i32,
}

/// Content of a sentence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NmeaReading {
    /// Two letters that name the talker: `GP`, `GN` and others.
    pub talker: [u8; 2],
    /// Ground speed (RMC, VTG) or altitude above sea level (GGA).
    pub sample: Option<VhSample>,
    /// Date and time of the fix (RMC), µs since 1970-01-01T00:00:00 UTC; a year of 2000 to 2069.
    pub unix_us: Option<u64>,
    /// Position (GGA, RMC).
    pub position: Option<NmeaPosition>,
}

/// The reason why a sentence is not used.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NmeaError {
    /// Another sentence begins, or a byte that is not text comes, before its end.
    Truncated,
    /// It is longer than [`LONGEST_SENTENCE`].
    Oversized,
    /// It has no checksum, or a wrong one.
    Checksum,
    /// Its fields are not those of its name.
    Malformed,
    /// The receiver itself reports that it has no fix, or an estimated one.
    NoFix,
    /// The receiver itself reports that its fix is simulated, or was entered by hand.
    SimulatedFix,
    /// Its date does not exist, such as the 30th of February.
    InvalidDate,
    /// Its time of day does not exist; a leap second is refused, too.
    InvalidTime,
    /// Its year is before 2000: the receiver's count of weeks has begun again, or it has not found
    /// the time yet.
    BeforeYear2000,
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
            Self::SimulatedFix => f.write_str("fix of the receiver is simulated"),
            Self::InvalidDate => f.write_str("date of a sentence does not exist"),
            Self::InvalidTime => f.write_str("time of a sentence does not exist"),
            Self::BeforeYear2000 => f.write_str("year of a sentence is before 2000"),
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for NmeaError {}
