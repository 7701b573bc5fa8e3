//! Fuzz targets for data of aircraft, and their properties. The tests of the crate run the same
//! functions.

use crc::{CRC_16_MCRF4XX, Crc};
use fmc_camera::flight::vh::{VhChannel, VhSample};
use fmc_camera::geometry::range::Quantity;
use fmc_camera::io::mavlink::{LONGEST_PACKET, MavlinkReading, MavlinkReceiver};
use fmc_camera::io::nmea::{LONGEST_SENTENCE, NmeaError, NmeaReading, NmeaReceiver};

/// Feeds any bytes to the receiver of satellite sentences: every reading was sent whole and is in
/// its range, and a sentence after them is read.
///
/// The input is sent as it is, then as fields of the sentences that are read, with a right
/// checksum.
pub(crate) fn nmea(bytes: &[u8]) {
    const { assert!(size_of::<NmeaReceiver>() <= LONGEST_SENTENCE + 24) };
    let mut receiver = NmeaReceiver::new();
    let answers = received(&mut receiver, bytes);
    let begun = bytes.split(|byte| *byte == b'$').count() - 1;
    assert!(
        answers.len() <= begun,
        "one answer to a sentence at the most"
    );
    assert!(answers.iter().flatten().all(believable_sentence));

    for name in ["GPRMC", "GNGGA", "GPVTG"] {
        let text: Vec<u8> = bytes
            .iter()
            .copied()
            .filter(|byte| (b' '..=b'~').contains(byte))
            .collect();
        for fields in text.split(|byte| *byte == b'$') {
            let answers = received(&mut receiver, &sentence(name, fields));
            assert!(answers.iter().flatten().all(believable_sentence));
        }
    }

    // 100 knots; 2026-11-19T22:54:46.
    let last = sentence(
        "GPRMC",
        b"225446.00,A,4916.45,N,12311.12,W,100.0,054.7,191126,020.3,E",
    );
    let reading = received(&mut receiver, &last).pop().unwrap().unwrap();
    assert_eq!(
        reading.sample,
        Some(VhSample::GroundSpeed(100.0 * (1852.0 / 3600.0)))
    );
    assert_eq!(reading.unix_us, Some(1_795_128_886_000_000));
}

/// Returns a sentence with its checksum.
pub(crate) fn sentence(name: &str, fields: &[u8]) -> Vec<u8> {
    let mut text = name.as_bytes().to_vec();
    text.push(b',');
    text.extend(fields);
    let sum = text.iter().fold(0, |sum, byte| sum ^ byte);
    let mut sentence = vec![b'$'];
    sentence.extend(text);
    sentence.extend(format!("*{sum:02X}\r\n").bytes());
    sentence
}

/// Returns the receiver's answers to these bytes.
pub(crate) fn received(
    receiver: &mut NmeaReceiver,
    bytes: &[u8],
) -> Vec<Result<NmeaReading, NmeaError>> {
    bytes
        .iter()
        .filter_map(|byte| receiver.receive(*byte))
        .collect()
}

fn believable_sentence(reading: &NmeaReading) -> bool {
    // Years of two digits mean 2000 to 2069.
    let possible = 946_684_800_000_000..3_155_760_000_000_000;
    reading.sample.iter().all(believable)
        && reading.unix_us.is_none_or(|time| possible.contains(&time))
}

fn believable(sample: &VhSample) -> bool {
    let (channel, value) = VhChannel::of(*sample);
    let quantity = match channel {
        VhChannel::Direct => Quantity::VhPerS,
        VhChannel::GroundSpeed | VhChannel::InertialSpeed => Quantity::GroundSpeedMS,
        VhChannel::HeightAboveGround | VhChannel::LaserHeight => Quantity::HeightAboveGroundM,
        VhChannel::Altitude => Quantity::AltitudeM,
        VhChannel::TerrainHeight => Quantity::TerrainHeightM,
    };
    quantity.check(value).is_ok()
}

/// Numbers of messages, with the byte that the common dialect adds to the checksum. These are read:
/// `SYSTEM_TIME`, `ATTITUDE`, `GLOBAL_POSITION_INT`, `DISTANCE_SENSOR`, `ALTITUDE`; this is not:
/// `HEARTBEAT`.
const MESSAGES: [(u32, u8); 6] = [(2, 137), (30, 39), (33, 104), (132, 85), (141, 47), (0, 50)];

/// Feeds any bytes to the receiver of autopilot messages: every reading is in its range, and a
/// message after them is read.
///
/// The input is sent as it is, then as the payload of every message that is read, with a right
/// checksum.
pub(crate) fn mavlink(bytes: &[u8]) {
    const { assert!(size_of::<MavlinkReceiver>() <= LONGEST_PACKET + 48) };
    let mut receiver = MavlinkReceiver::new();
    let mut readings = messages(&mut receiver, bytes);
    for piece in bytes.chunks(60) {
        for (message, extra) in MESSAGES {
            for kind in [Kind::One, Kind::Two, Kind::Signed] {
                readings.extend(messages(&mut receiver, &frame(kind, message, extra, piece)));
            }
        }
    }
    assert!(readings.iter().all(believable_message));

    // The message is repeated as often as the longest false beginning can hide it, and once more.
    let time_us = 1_767_225_600_000_000_u64;
    let last = frame(
        Kind::Two,
        2,
        137,
        &[&time_us.to_le_bytes()[..], &[1, 2, 3]].concat(),
    );
    let mut found = Vec::new();
    for _ in 0..LONGEST_PACKET / last.len() + 2 {
        found = messages(&mut receiver, &last);
    }
    assert_eq!(found.last().unwrap().unix_us, Some(time_us));
}

#[derive(Clone, Copy)]
pub(crate) enum Kind {
    One,
    Two,
    Signed,
}

/// Returns a frame with its checksum, made from the protocol's definition and not by the crate that
/// reads it.
pub(crate) fn frame(kind: Kind, message: u32, extra: u8, payload: &[u8]) -> Vec<u8> {
    let length = u8::try_from(payload.len()).unwrap();
    let [low, middle, high, _] = message.to_le_bytes();
    let mut frame = match kind {
        Kind::One => vec![0xfe, length, 7, 1, 1, low],
        Kind::Two => vec![0xfd, length, 0, 0, 7, 1, 1, low, middle, high],
        Kind::Signed => vec![0xfd, length, 1, 0, 7, 1, 1, low, middle, high],
    };
    frame.extend(payload);
    let crc = Crc::<u16>::new(&CRC_16_MCRF4XX);
    let mut digest = crc.digest();
    digest.update(&frame[1..]);
    digest.update(&[extra]);
    frame.extend(digest.finalize().to_le_bytes());
    if let Kind::Signed = kind {
        frame.extend([0xfe; 13]);
    }
    frame
}

/// Returns the readings of these bytes.
pub(crate) fn messages(receiver: &mut MavlinkReceiver, bytes: &[u8]) -> Vec<MavlinkReading> {
    let mut readings = Vec::new();
    for byte in bytes {
        let mut answer = receiver.receive(*byte);
        while let Some(one) = answer {
            readings.extend(one.ok());
            answer = receiver.buffered();
        }
    }
    readings
}

fn believable_message(reading: &MavlinkReading) -> bool {
    let possible = 946_684_800_000_000..=7_258_118_400_000_000;
    reading.samples.iter().all(believable)
        && reading.unix_us.is_none_or(|time| possible.contains(&time))
}
