//! The satellite receiver's wire.

use super::arrivals::Arrivals;
use super::counters::{ReceiverCounters, count};
use super::intake::Intake;
use crate::flight::event::Event;
use crate::flight::time::Time;
use crate::flight::vh::VhSample;
use crate::io::nmea::{NmeaError, NmeaPosition, NmeaReading, NmeaReceiver};

/// Silence after which another receiver, or another autopilot, may take the place of the one in
/// use, µs.
pub const ALIVE_US: u64 = 3_000_000;

/// Speed beyond which no aircraft of this camera moves, m/s.
const FASTEST_M_S: f32 = 400.0;

/// Difference of positions beyond that which noise and jitter of the arrival may cause, m.
const POSITION_TOLERANCE_M: f32 = 100.0;

/// Difference of times beyond that which the ways of two sentences may cause, µs.
const TIME_TOLERANCE_US: u64 = 2_000_000;

/// Metres on the ground of the unit of a position, a ten-thousandth of a minute of latitude.
const M_PER_UNIT: f32 = 0.1852;

/// Units in a turn.
const TURN: i32 = 360 * 600_000;

/// Radians in a unit.
const RAD_PER_UNIT: f32 = core::f32::consts::TAU / 216_000_000.0;

/// Time at which something came last.
#[derive(Debug, Clone, Copy, Default)]
struct Heard(Option<Time>);

impl Heard {
    fn is_alive(self, now: Time) -> bool {
        self.0.is_some_and(|heard| now.us_since(heard) < ALIVE_US)
    }
}

/// The wire with its decoder.
#[derive(Debug, Clone, Default)]
pub(super) struct ReceiverWire {
    pub(super) intake: Intake,
    decoder: NmeaReceiver,
    /// When the sentence under way began.
    began: Time,
    pub(super) counters: ReceiverCounters,
    /// The talkers in use, the last first, and when each spoke last: a receiver names itself by its
    /// constellations, and may change its name or use two.
    talkers: [Option<([u8; 2], Time)>; 2],
    place: Option<(NmeaPosition, Time)>,
    /// True if the last position was another receiver's.
    is_elsewhere: bool,
    speed: Heard,
    altitude: Heard,
    /// The last time, µs since 1970, and when it came.
    utc: Option<(u64, Time)>,
}

impl ReceiverWire {
    pub(super) const fn new() -> Self {
        Self {
            intake: Intake::new(),
            decoder: NmeaReceiver::new(),
            began: Time::START,
            counters: ReceiverCounters::NONE,
            talkers: [None; 2],
            place: None,
            is_elsewhere: false,
            speed: Heard(None),
            altitude: Heard(None),
            utc: None,
        }
    }

    /// Reads the bytes that this round may take.
    pub(super) fn round(&mut self, arrivals: &mut Arrivals) {
        self.intake.begin_round();
        while arrivals.has_room()
            && let Some(byte) = self.intake.take()
        {
            if byte == b'$' {
                self.began = arrivals.now();
            }
            match self.decoder.receive(byte) {
                Some(Ok(reading)) => self.take(&reading, arrivals),
                Some(Err(error)) => count(self.counter(error), 1),
                None => {}
            }
        }
        let unexplained = self.decoder.take_unexplained();
        count(&mut self.counters.unexplained_bytes, unexplained);
    }

    /// Returns true if the receiver gives ground speeds.
    pub(super) fn has_speed(&self, now: Time) -> bool {
        self.speed.is_alive(now)
    }

    /// Returns true if the receiver gives altitudes.
    pub(super) fn has_altitude(&self, now: Time) -> bool {
        self.altitude.is_alive(now)
    }

    /// Returns true if the receiver gives times.
    pub(super) fn has_utc(&self, now: Time) -> bool {
        self.utc
            .is_some_and(|(_, heard)| Heard(Some(heard)).is_alive(now))
    }

    fn take(&mut self, reading: &NmeaReading, arrivals: &mut Arrivals) {
        let now = arrivals.now();
        count(&mut self.counters.read, 1);
        if !self.is_listened_to(reading, now) {
            return;
        }
        if let Some(sample) = reading.sample {
            match sample {
                VhSample::Altitude(_) => self.altitude = Heard(Some(now)),
                _ => self.speed = Heard(Some(now)),
            }
            arrivals.push_begun(self.began, Event::Vh(sample));
        }
        if let Some(unix_us) = reading.unix_us {
            self.utc = Some((unix_us, now));
            arrivals.push(Event::GnssTime(unix_us));
        }
    }

    /// Returns true if a sentence comes from the receiver in use.
    fn is_listened_to(&mut self, reading: &NmeaReading, now: Time) -> bool {
        let talkers = self.talkers.iter().flatten();
        let mut alive = talkers.filter(|(_, heard)| Heard(Some(*heard)).is_alive(now));
        let is_other =
            alive.clone().next().is_some() && alive.all(|(talker, _)| *talker != reading.talker);
        if is_other && !self.agrees(reading, now) {
            count(&mut self.counters.other_talker, 1);
            return false;
        }
        if let Some(position) = reading.position {
            self.is_elsewhere = self.is_reached(position, now) == Some(false);
            if !self.is_elsewhere {
                self.place = Some((position, now));
            }
        }
        // A speed without position is that of the sentence before it.
        if self.is_elsewhere {
            count(&mut self.counters.other_position, 1);
            return false;
        }
        let [last, before] = &mut self.talkers;
        if last.is_some_and(|(talker, _)| talker != reading.talker) {
            core::mem::swap(last, before);
        }
        *last = Some((reading.talker, now));
        true
    }

    /// Returns true if a sentence of another talker has the position of the receiver in use, and
    /// its time, if it has one.
    fn agrees(&self, reading: &NmeaReading, now: Time) -> bool {
        let times = reading.unix_us.zip(self.utc);
        let is_same_time = times.is_none_or(|(unix_us, (before_us, heard))| {
            let expected_us = before_us.saturating_add(now.us_since(heard));
            unix_us.abs_diff(expected_us) <= TIME_TOLERANCE_US
        });
        is_same_time
            && reading
                .position
                .is_some_and(|position| self.is_reached(position, now) == Some(true))
    }

    /// Returns true if the receiver in use can have got to a position; `None` if it is not known
    /// where it was.
    fn is_reached(&self, position: NmeaPosition, now: Time) -> Option<bool> {
        let (place, heard) = self.place?;
        let is_alive = Heard(Some(heard)).is_alive(now);
        is_alive.then(|| !is_too_far(place, position, now.seconds_since(heard)))
    }

    const fn counter(&mut self, error: NmeaError) -> &mut u32 {
        match error {
            NmeaError::Truncated => &mut self.counters.truncated,
            NmeaError::Oversized => &mut self.counters.oversized,
            NmeaError::Checksum => &mut self.counters.checksum,
            NmeaError::Malformed => &mut self.counters.malformed,
            NmeaError::NoFix => &mut self.counters.no_fix,
            NmeaError::SimulatedFix => &mut self.counters.simulated_fix,
            NmeaError::InvalidDate | NmeaError::InvalidTime => &mut self.counters.invalid_time,
            NmeaError::BeforeYear2000 => &mut self.counters.before_year_2000,
            NmeaError::OutOfRange(_) => &mut self.counters.out_of_range,
        }
    }
}

/// Returns true if no aircraft gets from one place to the other in a time, s. The distance holds
/// for places near each other on a sphere; the length of a parallel is underestimated, so that no
/// sentence is refused for it.
#[expect(
    clippy::cast_precision_loss,
    reason = "thousandths of metres do not matter"
)]
fn is_too_far(from: NmeaPosition, to: NmeaPosition, elapsed_s: f32) -> bool {
    let north = to.latitude.saturating_sub(from.latitude) as f32;
    let around = to.longitude.saturating_sub(from.longitude);
    // The shorter way round.
    let around = around.saturating_abs();
    let around = around.min(TURN.saturating_sub(around)) as f32;
    let latitude_rad = RAD_PER_UNIT * to.latitude as f32;
    // Below the cosine everywhere.
    let cosine = (1.0 - 0.5 * latitude_rad * latitude_rad).max(0.0);
    let east = around * cosine;
    let distance_m = M_PER_UNIT * fmc_camera_kernel::sqrt(north * north + east * east);
    distance_m > POSITION_TOLERANCE_M + FASTEST_M_S * elapsed_s
}
