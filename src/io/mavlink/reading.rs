//! Content of a message, or the reason why it is not used.

use core::fmt;

use heapless::Vec;

use crate::flight::event::AttitudeSample;
use crate::flight::vh::VhSample;
use crate::geometry::range::OutOfRange;

/// Samples of one message.
pub const MAX_SAMPLES: usize = 2;

/// Sender of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MavlinkSender {
    /// Number of the system, such as an aircraft or a ground station.
    pub system: u8,
    /// Number of its component, such as the autopilot or a gimbal.
    pub component: u8,
}

/// Content of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct MavlinkReading {
    /// Component that sends it.
    pub sender: MavlinkSender,
    /// Speed and heights.
    pub samples: Vec<VhSample, MAX_SAMPLES>,
    /// The autopilot's time, µs since 1970-01-01T00:00:00 UTC.
    pub unix_us: Option<u64>,
    /// Attitude and its rates; its drift is the last track less the heading.
    pub attitude: Option<AttitudeSample>,
}

/// The reason why a message is not used.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MavlinkError {
    /// The checksum of a message that is read is wrong, or its beginning was a false one.
    Checksum,
    /// It comes from a sender that is not listened to.
    OtherSender,
    /// A field has a value that the protocol does not know.
    Malformed,
    /// The autopilot does not know position or time.
    NoFix,
    /// The distance is beyond the range of its sensor, or the sensor marks it as invalid.
    NoDistance,
    /// A number is outside its range.
    OutOfRange(OutOfRange),
}

impl fmt::Display for MavlinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Checksum => f.write_str("checksum of a message is wrong"),
            Self::OtherSender => f.write_str("sender of a message is not listened to"),
            Self::Malformed => f.write_str("field of a message has a value that does not exist"),
            Self::NoFix => f.write_str("autopilot does not know position or time"),
            Self::NoDistance => f.write_str("distance sensor has not measured"),
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for MavlinkError {}
