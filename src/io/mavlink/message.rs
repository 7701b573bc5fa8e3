//! Messages that are read, of the common dialect: `SYSTEM_TIME`, `ATTITUDE`, `GLOBAL_POSITION_INT`,
//! `DISTANCE_SENSOR` and `ALTITUDE`.

use core::f32::consts::PI;

use heapless::Vec;

use super::payload::Payload;
use super::reading::{MAX_SAMPLES, MavlinkError, MavlinkReading, MavlinkSender};
use crate::flight::event::AttitudeSample;
use crate::flight::vh::VhSample;
use crate::geometry::range::Quantity;

/// Number of `GLOBAL_POSITION_INT` after an `ALTITUDE` whose altitude is ignored: the two may
/// differ by tens of metres, and `ALTITUDE` has the terrain's height that goes with its own.
pub const ALTITUDE_PREFERRED: u8 = 50;

/// Age of the last track beyond which an `ATTITUDE` has no drift, and is ignored, ms.
pub const TRACK_WITHIN_MS: u32 = 1000;

/// Ground speed below which there is no track, m/s.
const LEAST_TRACK_SPEED_M_S: f32 = 5.0;

/// Quality by which a distance sensor marks a measurement as invalid.
const INVALID_SIGNAL: u8 = 1;

/// `MAV_SENSOR_ROTATION_PITCH_270`: the sensor looks down.
const DOWN: u8 = 25;

/// `MAV_DISTANCE_SENSOR`: the kinds of distance sensor are numbered from the laser up to the
/// unknown one.
const LASER: u8 = 0;
const UNKNOWN_KIND: u8 = 4;

/// Least height above the terrain that is a known one in `ALTITUDE`, m.
const LEAST_ABOVE_TERRAIN_M: f32 = -1000.0;

/// 2000-01-01 and 2200-01-01, µs since 1970: the time of an autopilot that knows it lies between
/// them.
const POSSIBLE_UNIX_US: [u64; 2] = [946_684_800_000_000, 7_258_118_400_000_000];

const DEG_PER_RAD: f32 = 180.0 / PI;

/// A message that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Message {
    SystemTime,
    Attitude,
    GlobalPosition,
    DistanceSensor,
    Altitude,
}

impl Message {
    /// The message of a number of the protocol.
    pub(super) const fn of(number: u32) -> Option<Self> {
        Some(match number {
            2 => Self::SystemTime,
            30 => Self::Attitude,
            33 => Self::GlobalPosition,
            132 => Self::DistanceSensor,
            141 => Self::Altitude,
            _ => return None,
        })
    }

    /// `CRC_EXTRA`: the byte that stands for the message's definition at the end of what is
    /// checked.
    pub(super) const fn extra_of_checksum(self) -> u8 {
        match self {
            Self::SystemTime => 137,
            Self::Attitude => 39,
            Self::GlobalPosition => 104,
            Self::DistanceSensor => 85,
            Self::Altitude => 47,
        }
    }
}

/// Direction of the ground speed.
#[derive(Debug, Clone, Copy)]
struct Track {
    /// Time since the autopilot started, ms.
    boot_ms: u32,
    /// From north to the east, rad.
    heading_rad: f32,
}

/// Content of earlier messages of a sender that its later ones need.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Memory {
    sender: Option<MavlinkSender>,
    /// Number of altitudes of `GLOBAL_POSITION_INT` still to be ignored.
    passed_over: u8,
    track: Option<Track>,
}

impl Memory {
    pub(super) const NONE: Self = Self {
        sender: None,
        passed_over: 0,
        track: None,
    };

    /// Forgets what another sender has sent.
    fn keep_of(&mut self, sender: MavlinkSender) {
        if self.sender != Some(sender) {
            *self = Self {
                sender: Some(sender),
                ..Self::NONE
            };
        }
    }
}

/// Reads a payload; `None` if it holds no speed, height, attitude or time.
pub(super) fn read(
    sender: MavlinkSender,
    message: Message,
    payload: &Payload,
    memory: &mut Memory,
) -> Result<Option<MavlinkReading>, MavlinkError> {
    memory.keep_of(sender);
    let mut reading = MavlinkReading {
        sender,
        samples: Vec::new(),
        unix_us: None,
        attitude: None,
    };
    match message {
        Message::SystemTime => reading.unix_us = Some(system_time(payload)?),
        Message::Attitude => reading.attitude = attitude(payload, memory.track),
        Message::GlobalPosition => global_position(payload, memory, &mut reading.samples)?,
        Message::DistanceSensor => distance(payload, &mut reading.samples)?,
        Message::Altitude => altitude(payload, memory, &mut reading.samples)?,
    }
    let says_something =
        !reading.samples.is_empty() || reading.unix_us.is_some() || reading.attitude.is_some();
    Ok(says_something.then_some(reading))
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

fn system_time(payload: &Payload) -> Result<u64, MavlinkError> {
    let unix_us = payload.u64(0);
    let [earliest, latest] = POSSIBLE_UNIX_US;
    if (earliest..=latest).contains(&unix_us) {
        Ok(unix_us)
    } else {
        Err(MavlinkError::NoFix)
    }
}

/// Reads an `ATTITUDE`: roll to the right, pitch up and yaw to the right are positive, and rates
/// are about the axes forward, right and down; the camera counts the rate about the axis upwards.
fn attitude(payload: &Payload, track: Option<Track>) -> Option<AttitudeSample> {
    let boot_ms = payload.u32(0);
    let track = track.filter(|track| boot_ms.abs_diff(track.boot_ms) <= TRACK_WITHIN_MS)?;
    let [roll, pitch, yaw, roll_rate, pitch_rate, yaw_rate] =
        [4, 8, 12, 16, 20, 24].map(|at| DEG_PER_RAD * payload.f32(at));
    let drift_deg = DEG_PER_RAD * track.heading_rad - yaw;
    Some(AttitudeSample {
        pitch_deg: pitch,
        roll_deg: roll,
        drift_deg: within_half_turn(drift_deg),
        rates_deg_s: [pitch_rate, roll_rate, -yaw_rate],
    })
}

/// Returns the same direction between -180 and 180°, for the difference of two such directions.
fn within_half_turn(angle_deg: f32) -> f32 {
    if angle_deg > 180.0 {
        angle_deg - 360.0
    } else if angle_deg < -180.0 {
        angle_deg + 360.0
    } else {
        angle_deg
    }
}

fn global_position(
    payload: &Payload,
    memory: &mut Memory,
    samples: &mut Samples,
) -> Result<(), MavlinkError> {
    let with_altitude = memory.passed_over == 0;
    memory.passed_over = memory.passed_over.saturating_sub(1);
    let (latitude, longitude) = (payload.i32(4), payload.i32(8));
    // Without a fix, autopilots send latitude and longitude 0.
    if latitude == 0 && longitude == 0 {
        memory.track = None;
        return Err(MavlinkError::NoFix);
    }
    let (north, east) = (f32::from(payload.i16(20)), f32::from(payload.i16(22)));
    let speed_m_s = 0.01 * fmc_camera_kernel::sqrt(north * north + east * east);
    memory.track = (speed_m_s >= LEAST_TRACK_SPEED_M_S).then(|| Track {
        boot_ms: payload.u32(0),
        heading_rad: libm::atan2f(east, north),
    });
    push(
        samples,
        Quantity::GroundSpeedMS,
        speed_m_s,
        VhSample::GroundSpeed,
    )?;
    if with_altitude {
        #[expect(clippy::cast_precision_loss, reason = "altitudes to 16 km are exact")]
        let altitude_m = 0.001 * payload.i32(12) as f32;
        push(samples, Quantity::AltitudeM, altitude_m, VhSample::Altitude)?;
    }
    Ok(())
}

fn distance(payload: &Payload, samples: &mut Samples) -> Result<(), MavlinkError> {
    let (least_cm, most_cm, current_cm) = (payload.u16(4), payload.u16(6), payload.u16(8));
    let (kind, orientation) = (payload.byte(10), payload.byte(12));
    if kind > UNKNOWN_KIND {
        return Err(MavlinkError::Malformed);
    }
    if orientation != DOWN {
        return Ok(());
    }
    // An extension; 0 where it is not sent.
    let has_signal = payload.byte(38) != INVALID_SIGNAL;
    if !has_signal || !(least_cm..=most_cm).contains(&current_cm) {
        return Err(MavlinkError::NoDistance);
    }
    let sample = match kind {
        LASER => VhSample::LaserHeight,
        _ => VhSample::HeightAboveGround,
    };
    let height_m = 0.01 * f32::from(current_cm);
    push(samples, Quantity::HeightAboveGroundM, height_m, sample)
}

/// Reads an `ALTITUDE`; a NaN is a height that the autopilot does not know.
///
/// With a clearance, autopilots compute the height above terrain from it, not always from the
/// altitude above the sea: PX4 subtracts it from the height above the place where it started. The
/// terrain's height is then left out.
fn altitude(
    payload: &Payload,
    memory: &mut Memory,
    samples: &mut Samples,
) -> Result<(), MavlinkError> {
    let (altitude_m, above_m, clearance_m) = (payload.f32(12), payload.f32(24), payload.f32(28));
    if !altitude_m.is_nan() {
        push(samples, Quantity::AltitudeM, altitude_m, VhSample::Altitude)?;
        let has_clearance = clearance_m >= 0.0;
        if above_m >= LEAST_ABOVE_TERRAIN_M && !has_clearance {
            let terrain_m = altitude_m - above_m;
            push(
                samples,
                Quantity::TerrainHeightM,
                terrain_m,
                VhSample::TerrainHeight,
            )?;
        }
    }
    if clearance_m >= 0.0 {
        let sample = VhSample::HeightAboveGround;
        push(samples, Quantity::HeightAboveGroundM, clearance_m, sample)?;
    }
    if !altitude_m.is_nan() {
        memory.passed_over = ALTITUDE_PREFERRED;
    }
    Ok(())
}
