//! Messages of an autopilot (`MAVLink` 1 and 2): speed, heights and time, byte by byte.
//!
//! The receiver reads `GLOBAL_POSITION_INT`, `DISTANCE_SENSOR`, `ALTITUDE` and `SYSTEM_TIME` of the
//! common dialect, and ignores every other message. Frames are cut here: the reader of the crate
//! `mavlink` indexes into its buffer, and has to read a frame whole even if it cannot use it. After
//! a candidate whose checksum is wrong the search goes on from its second byte, so that no frame is
//! lost behind a false beginning. The crate supplies each message's part of the checksum and
//! decodes the payload, which it gets in an array of the message's full length, since its own
//! extension of a shortened payload indexes. Signatures are not verified.
//!
//! The link check of `tests/no-panic` with its feature `mavlink` finds no panic here.

use core::fmt;

use ::mavlink::dialects::common::{
    ALTITUDE_DATA, DISTANCE_SENSOR_DATA, GLOBAL_POSITION_INT_DATA, MavDistanceSensor, MavMessage,
    MavSensorOrientation, SYSTEM_TIME_DATA,
};
use ::mavlink::{MAV_STX, MAV_STX_V2, MavlinkVersion, Message, MessageData};
use crc::{CRC_16_MCRF4XX, Crc, Table};
use heapless::Vec;

use crate::flight::vh::VhSample;
use crate::geometry::range::{OutOfRange, Quantity};

/// Longest frame: version 2 with a full payload and a signature, bytes.
pub const LONGEST_PACKET: usize = 280;

/// Samples of one message.
pub(crate) const MAX_SAMPLES: usize = 3;

/// Number of `GLOBAL_POSITION_INT` after an `ALTITUDE` whose altitude is ignored: the two may
/// differ by tens of metres, and `ALTITUDE` has the terrain's height that goes with its own.
pub const ALTITUDE_PREFERRED: u8 = 50;

/// Place of the signal's quality in a `DISTANCE_SENSOR`: an extension, which the crate decodes only
/// with std.
const SIGNAL_QUALITY_AT: usize = 38;

/// Quality by which a distance sensor marks a measurement as invalid.
const INVALID_SIGNAL: u8 = 1;

/// Least height above the terrain that is a known one in `ALTITUDE`, m.
const LEAST_ABOVE_TERRAIN_M: f32 = -1000.0;

/// 2000-01-01 and 2200-01-01, µs since 1970: the time of an autopilot that knows it lies between
/// them.
const POSSIBLE_UNIX_US: [u64; 2] = [946_684_800_000_000, 7_258_118_400_000_000];

/// CRC of a frame; that of the crate can panic.
const CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_MCRF4XX);

/// Flag of version 2: the frame ends with a signature.
const SIGNED: u8 = 1;

const SIGNATURE_BYTES: usize = 13;

const CHECKSUM_BYTES: usize = 2;

/// Content of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct MavlinkReading {
    /// Speed and heights.
    pub samples: Vec<VhSample, MAX_SAMPLES>,
    /// The autopilot's time, µs since 1970-01-01T00:00:00 UTC.
    pub unix_us: Option<u64>,
}

/// The reason why a message is not used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MavlinkError {
    /// The checksum of a message that is read is wrong, or its beginning was a false one.
    Checksum,
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
            Self::Malformed => f.write_str("field of a message has a value that does not exist"),
            Self::NoFix => f.write_str("autopilot does not know position or time"),
            Self::NoDistance => f.write_str("distance sensor has not measured"),
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for MavlinkError {}

/// Layout of a frame.
#[derive(Debug, Clone, Copy)]
struct Layout {
    message: u32,
    payload_at: usize,
    payload_bytes: usize,
    bytes: usize,
}

/// The beginning of the bytes received.
#[derive(Debug, Clone, Copy)]
enum Beginning {
    Frame(Layout),
    Incomplete,
    /// The bytes begin no frame that can be read.
    None,
}

/// Cuts an autopilot's bytes into messages and reads them.
#[derive(Debug, Clone, Default)]
pub struct MavlinkReceiver {
    received: Vec<u8, LONGEST_PACKET>,
    /// Number of altitudes of `GLOBAL_POSITION_INT` still to be ignored.
    passed_over: u8,
}

impl MavlinkReceiver {
    /// Returns a receiver before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            received: Vec::new(),
            passed_over: 0,
        }
    }

    /// Takes one byte. If it ends a message, returns a reading, or the reason why there is none.
    ///
    /// Behind a false beginning several messages may end with one byte: [`Self::buffered`] returns
    /// the others, or each of the next bytes returns one of them.
    ///
    /// # Errors
    /// [`MavlinkError`]; a whole frame that follows is read after any bytes before it, at most
    /// [`LONGEST_PACKET`] bytes late.
    pub fn receive(&mut self, byte: u8) -> Option<Result<MavlinkReading, MavlinkError>> {
        if self.received.push(byte).is_err() {
            // A full buffer would have been a whole frame, and was cut.
            self.received.clear();
        }
        self.buffered()
    }

    /// Returns the next message among the bytes that have come.
    ///
    /// # Errors
    /// As [`Self::receive`].
    pub fn buffered(&mut self) -> Option<Result<MavlinkReading, MavlinkError>> {
        loop {
            let layout = match beginning(&self.received) {
                Beginning::Incomplete => return None,
                Beginning::None => {
                    self.give_up_beginning();
                    continue;
                }
                Beginning::Frame(layout) => layout,
            };
            if self.received.len() < layout.bytes {
                return None;
            }
            let is_read = READ.contains(&layout.message);
            let Some(payload) = checked_payload(&self.received, layout) else {
                self.give_up_beginning();
                if is_read {
                    return Some(Err(MavlinkError::Checksum));
                }
                continue;
            };
            let reading = read(layout.message, payload, &mut self.passed_over);
            self.drop_first(layout.bytes);
            if let Some(reading) = reading.transpose() {
                return Some(reading);
            }
        }
    }

    /// Drops bytes up to the next that may begin a frame.
    fn give_up_beginning(&mut self) {
        let begins = |byte: &u8| [MAV_STX, MAV_STX_V2].contains(byte);
        let next = self.received.iter().skip(1).position(begins);
        self.drop_first(next.map_or(self.received.len(), |next| next + 1));
    }

    fn drop_first(&mut self, count: usize) {
        let left = self.received.len().saturating_sub(count);
        for index in 0..left {
            let byte = self.received.get(index + count).copied();
            if let (Some(to), Some(byte)) = (self.received.get_mut(index), byte) {
                *to = byte;
            }
        }
        self.received.truncate(left);
    }
}

/// The messages that are read.
const READ: [u32; 4] = [
    GLOBAL_POSITION_INT_DATA::ID,
    DISTANCE_SENSOR_DATA::ID,
    ALTITUDE_DATA::ID,
    SYSTEM_TIME_DATA::ID,
];

/// Header of a frame: version 1 has 6 bytes, version 2 has 10.
fn beginning(bytes: &[u8]) -> Beginning {
    let (message, payload_at, payload_bytes, signature_bytes) = match *bytes {
        [] | [MAV_STX | MAV_STX_V2] => return Beginning::Incomplete,
        [MAV_STX, length, _, _, _, id, ..] => (u32::from(id), 6, length, 0),
        [MAV_STX_V2, _, flags, ..] if flags & !SIGNED != 0 => return Beginning::None,
        [MAV_STX_V2, length, flags, _, _, _, _, low, middle, high, ..] => {
            let id = u32::from_le_bytes([low, middle, high, 0]);
            let signature_bytes = if flags == SIGNED { SIGNATURE_BYTES } else { 0 };
            (id, 10, length, signature_bytes)
        }
        [MAV_STX | MAV_STX_V2, ..] => return Beginning::Incomplete,
        _ => return Beginning::None,
    };
    let payload_bytes = usize::from(payload_bytes);
    Beginning::Frame(Layout {
        message,
        payload_at,
        payload_bytes,
        bytes: payload_at + payload_bytes + CHECKSUM_BYTES + signature_bytes,
    })
}

/// Returns the payload, if the checksum is right.
fn checked_payload(bytes: &[u8], layout: Layout) -> Option<&[u8]> {
    let (frame, rest) = bytes.split_at_checked(layout.payload_at + layout.payload_bytes)?;
    let (checksum, _) = rest.split_first_chunk::<CHECKSUM_BYTES>()?;
    let (_, checked) = frame.split_first()?;
    let mut right = CRC.digest();
    right.update(checked);
    right.update(&[MavMessage::extra_crc(layout.message)]);
    if u16::from_le_bytes(*checksum) != right.finalize() {
        return None;
    }
    frame.get(layout.payload_at..)
}

/// Reads a payload; `None` if it holds no speed, height or time.
fn read(
    message: u32,
    payload: &[u8],
    passed_over: &mut u8,
) -> Result<Option<MavlinkReading>, MavlinkError> {
    const POSITION: usize = GLOBAL_POSITION_INT_DATA::ENCODED_LEN;
    const DISTANCE: usize = DISTANCE_SENSOR_DATA::ENCODED_LEN;
    const ALTITUDE: usize = ALTITUDE_DATA::ENCODED_LEN;
    const TIME: usize = SYSTEM_TIME_DATA::ENCODED_LEN;
    let mut samples = Vec::new();
    let mut unix_us = None;
    match message {
        GLOBAL_POSITION_INT_DATA::ID => {
            let position = decoded::<GLOBAL_POSITION_INT_DATA, POSITION>(payload)?;
            let with_altitude = *passed_over == 0;
            *passed_over = passed_over.saturating_sub(1);
            of_position(&position, with_altitude, &mut samples)?;
        }
        DISTANCE_SENSOR_DATA::ID => {
            let distance = decoded::<DISTANCE_SENSOR_DATA, DISTANCE>(payload)?;
            let has_signal = payload.get(SIGNAL_QUALITY_AT) != Some(&INVALID_SIGNAL);
            of_distance(&distance, has_signal, &mut samples)?;
        }
        ALTITUDE_DATA::ID => {
            let altitude = decoded::<ALTITUDE_DATA, ALTITUDE>(payload)?;
            of_altitude(&altitude, &mut samples)?;
            if !altitude.altitude_amsl.is_nan() {
                *passed_over = ALTITUDE_PREFERRED;
            }
        }
        SYSTEM_TIME_DATA::ID => {
            let time = decoded::<SYSTEM_TIME_DATA, TIME>(payload)?;
            let [earliest, latest] = POSSIBLE_UNIX_US;
            if !(earliest..=latest).contains(&time.time_unix_usec) {
                return Err(MavlinkError::NoFix);
            }
            unix_us = Some(time.time_unix_usec);
        }
        _ => {}
    }
    let says_something = !samples.is_empty() || unix_us.is_some();
    Ok(says_something.then_some(MavlinkReading { samples, unix_us }))
}

/// Decodes a payload by the crate; version 2 leaves out zeros at the end, and newer senders may add
/// fields.
fn decoded<M: MessageData, const N: usize>(payload: &[u8]) -> Result<M, MavlinkError> {
    let mut whole = [0; N];
    for (to, byte) in whole.iter_mut().zip(payload) {
        *to = *byte;
    }
    M::deser(MavlinkVersion::V2, &whole).map_err(|_| MavlinkError::Malformed)
}

type Samples = Vec<VhSample, MAX_SAMPLES>;

fn push(
    samples: &mut Samples,
    quantity: Quantity,
    value: f32,
    sample: fn(f32) -> VhSample,
) -> Result<(), MavlinkError> {
    let value = quantity.check(value).map_err(MavlinkError::OutOfRange)?;
    // No message has more samples than fit.
    let _ = samples.push(sample(value));
    Ok(())
}

fn of_position(
    position: &GLOBAL_POSITION_INT_DATA,
    with_altitude: bool,
    samples: &mut Samples,
) -> Result<(), MavlinkError> {
    // Without a fix, autopilots send latitude and longitude 0.
    if position.lat == 0 && position.lon == 0 {
        return Err(MavlinkError::NoFix);
    }
    let (north, east) = (f32::from(position.vx), f32::from(position.vy));
    let speed_m_s = 0.01 * libm::sqrtf(north * north + east * east);
    push(
        samples,
        Quantity::GroundSpeedMS,
        speed_m_s,
        VhSample::GroundSpeed,
    )?;
    if with_altitude {
        #[expect(clippy::cast_precision_loss, reason = "altitudes to 16 km are exact")]
        let altitude_m = 0.001 * position.alt as f32;
        push(samples, Quantity::AltitudeM, altitude_m, VhSample::Altitude)?;
    }
    Ok(())
}

fn of_distance(
    distance: &DISTANCE_SENSOR_DATA,
    has_signal: bool,
    samples: &mut Samples,
) -> Result<(), MavlinkError> {
    if distance.orientation != MavSensorOrientation::MAV_SENSOR_ROTATION_PITCH_270 {
        return Ok(());
    }
    let range_cm = distance.min_distance..=distance.max_distance;
    if !has_signal || !range_cm.contains(&distance.current_distance) {
        return Err(MavlinkError::NoDistance);
    }
    let sample = match distance.mavtype {
        MavDistanceSensor::MAV_DISTANCE_SENSOR_LASER => VhSample::LaserHeight,
        _ => VhSample::HeightAboveGround,
    };
    let height_m = 0.01 * f32::from(distance.current_distance);
    push(samples, Quantity::HeightAboveGroundM, height_m, sample)
}

/// Reads an `ALTITUDE`; a NaN is a height that the autopilot does not know.
fn of_altitude(altitude: &ALTITUDE_DATA, samples: &mut Samples) -> Result<(), MavlinkError> {
    let (altitude_m, above_m) = (altitude.altitude_amsl, altitude.altitude_terrain);
    if !altitude_m.is_nan() {
        push(samples, Quantity::AltitudeM, altitude_m, VhSample::Altitude)?;
        if above_m >= LEAST_ABOVE_TERRAIN_M {
            let terrain_m = altitude_m - above_m;
            push(
                samples,
                Quantity::TerrainHeightM,
                terrain_m,
                VhSample::TerrainHeight,
            )?;
        }
    }
    let clearance_m = altitude.bottom_clearance;
    if clearance_m >= 0.0 {
        let sample = VhSample::HeightAboveGround;
        push(samples, Quantity::HeightAboveGroundM, clearance_m, sample)?;
    }
    Ok(())
}
