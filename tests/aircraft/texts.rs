//! Texts of sentences and messages that are not used.

use fmc_camera::geometry::range::{OutOfRange, Quantity};
use fmc_camera::io::mavlink::MavlinkError;
use fmc_camera::io::nmea::NmeaError;

use crate::controller::texts::assert_texts;

const TOO_HIGH: OutOfRange = OutOfRange {
    quantity: Quantity::TemperatureC,
    value: 120.5,
    min: -100.0,
    max: 100.0,
};
const TOO_HIGH_TEXT: &str = "temperature_c = 120.5 is outside -100 to 100";

#[test]
fn sentence_that_is_not_used_says_why() {
    assert_texts(&[
        (NmeaError::Truncated, "sentence has no end"),
        (NmeaError::Oversized, "sentence is longer than 100 bytes"),
        (
            NmeaError::Checksum,
            "checksum of a sentence is wrong or missing",
        ),
        (
            NmeaError::Malformed,
            "fields of a sentence are not those of its name",
        ),
        (NmeaError::NoFix, "receiver has no fix"),
        (NmeaError::SimulatedFix, "fix of the receiver is simulated"),
        (NmeaError::InvalidDate, "date of a sentence does not exist"),
        (NmeaError::InvalidTime, "time of a sentence does not exist"),
        (
            NmeaError::BeforeYear2000,
            "year of a sentence is before 2000",
        ),
        (NmeaError::OutOfRange(TOO_HIGH), TOO_HIGH_TEXT),
    ]);
}

#[test]
fn message_that_is_not_used_says_why() {
    assert_texts(&[
        (MavlinkError::Checksum, "checksum of a message is wrong"),
        (
            MavlinkError::OtherSender,
            "sender of a message is not listened to",
        ),
        (
            MavlinkError::Malformed,
            "field of a message has a value that does not exist",
        ),
        (
            MavlinkError::NoFix,
            "autopilot does not know position or time",
        ),
        (MavlinkError::NoDistance, "distance sensor has not measured"),
        (MavlinkError::OutOfRange(TOO_HIGH), TOO_HIGH_TEXT),
    ]);
}
