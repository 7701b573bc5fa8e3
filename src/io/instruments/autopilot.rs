//! The autopilot's wire.

use super::arrivals::Arrivals;
use super::counters::{AutopilotCounters, count};
use super::intake::Intake;
use super::receiver::{ALIVE_US, ReceiverWire};
use crate::flight::event::Event;
use crate::flight::time::Time;
use crate::flight::vh::VhSample;
use crate::io::mavlink::{MavlinkError, MavlinkReading, MavlinkReceiver, MavlinkSender};

/// `MAV_COMP_ID_AUTOPILOT1`: the autopilot among the components of a system.
const AUTOPILOT: u8 = 1;

/// Time by which the autopilot's clock may be ahead of the receiver's pulse, µs. A time that names
/// a pulse may come up to a second late, but not early, so that the autopilot's is made earlier.
const AHEAD_US: u64 = 250_000;

/// The wire with its decoder.
#[derive(Debug, Clone, Default)]
pub(super) struct AutopilotWire {
    pub(super) intake: Intake,
    decoder: MavlinkReceiver,
    /// When the message under way began.
    began: Time,
    pub(super) counters: AutopilotCounters,
    /// The only system to be used; without it the first that speaks.
    wanted: Option<u8>,
    /// The sender in use, and when it spoke last.
    in_use: Option<(MavlinkSender, Time)>,
}

impl AutopilotWire {
    pub(super) const fn new(wanted: Option<u8>) -> Self {
        Self {
            intake: Intake::new(),
            decoder: MavlinkReceiver::new(),
            began: Time::START,
            counters: AutopilotCounters {
                system: wanted,
                ..AutopilotCounters::NONE
            },
            wanted,
            in_use: None,
        }
    }

    pub(super) const fn wanted(&self) -> Option<u8> {
        self.wanted
    }

    /// Reads the bytes that this round may take. Values of the receiver itself take precedence over
    /// those that the autopilot derives from it.
    pub(super) fn round(&mut self, receiver: &ReceiverWire, arrivals: &mut Arrivals) {
        self.intake.begin_round();
        // A message behind a false beginning.
        if arrivals.has_room()
            && let Some(answer) = self.search(None, arrivals.now())
        {
            self.answer(answer, receiver, arrivals);
        }
        while arrivals.has_room()
            && let Some(byte) = self.intake.take()
        {
            if !self.decoder.is_under_way() {
                self.began = arrivals.now();
            }
            if let Some(answer) = self.search(Some(byte), arrivals.now()) {
                self.answer(answer, receiver, arrivals);
            }
        }
        let unexplained = self.decoder.take_unexplained();
        count(&mut self.counters.unexplained_bytes, unexplained);
    }

    /// Returns the next message of the sender in use among the bytes that have come.
    fn search(
        &mut self,
        byte: Option<u8>,
        now: Time,
    ) -> Option<Result<MavlinkReading, MavlinkError>> {
        let (wanted, in_use) = (self.wanted, self.in_use);
        let is_used = |sender| is_listened_to(wanted, in_use, sender, now);
        match byte {
            Some(byte) => self.decoder.receive_from(byte, is_used),
            None => self.decoder.buffered_from(is_used),
        }
    }

    fn answer(
        &mut self,
        answer: Result<MavlinkReading, MavlinkError>,
        receiver: &ReceiverWire,
        arrivals: &mut Arrivals,
    ) {
        match answer {
            Ok(reading) => self.take(&reading, receiver, arrivals),
            Err(error) => {
                if error == MavlinkError::OtherSender {
                    count(&mut self.counters.read, 1);
                }
                count(self.counter(error), 1);
            }
        }
    }

    fn take(&mut self, reading: &MavlinkReading, receiver: &ReceiverWire, arrivals: &mut Arrivals) {
        let now = arrivals.now();
        count(&mut self.counters.read, 1);
        self.counters.system = Some(reading.sender.system);
        self.in_use = Some((reading.sender, now));
        for sample in &reading.samples {
            let sample = match *sample {
                // As ground speed it would mix with the receiver's; so the two are compared.
                VhSample::GroundSpeed(speed_m_s) if receiver.has_speed(now) => {
                    VhSample::InertialSpeed(speed_m_s)
                }
                // The terrain's height goes with the autopilot's altitude, which may be above
                // another surface than the receiver's.
                VhSample::Altitude(_) | VhSample::TerrainHeight(_)
                    if receiver.has_altitude(now) =>
                {
                    continue;
                }
                sample => sample,
            };
            arrivals.push_begun(self.began, Event::Vh(sample));
        }
        if let Some(attitude) = reading.attitude {
            arrivals.push_begun(self.began, Event::Attitude(attitude));
        }
        if let Some(unix_us) = reading.unix_us
            && !receiver.has_utc(now)
        {
            arrivals.push(Event::GnssTime(unix_us.saturating_sub(AHEAD_US)));
        }
    }

    const fn counter(&mut self, error: MavlinkError) -> &mut u32 {
        match error {
            MavlinkError::Checksum => &mut self.counters.checksum,
            MavlinkError::OtherSender => &mut self.counters.other_system,
            MavlinkError::Malformed => &mut self.counters.malformed,
            MavlinkError::NoFix => &mut self.counters.no_fix,
            MavlinkError::NoDistance => &mut self.counters.no_distance,
            MavlinkError::OutOfRange(_) => &mut self.counters.out_of_range,
        }
    }
}

/// Returns true if a sender is used: one of the wanted system, and of the sender in use or of the
/// autopilot of its system until that sender has been silent.
fn is_listened_to(
    wanted: Option<u8>,
    in_use: Option<(MavlinkSender, Time)>,
    sender: MavlinkSender,
    now: Time,
) -> bool {
    let alive = in_use.filter(|(_, heard)| now.us_since(*heard) < ALIVE_US);
    let is_wanted = wanted.is_none_or(|wanted| wanted == sender.system);
    is_wanted
        && alive.is_none_or(|(used, _)| {
            sender == used || sender.system == used.system && sender.component == AUTOPILOT
        })
}
