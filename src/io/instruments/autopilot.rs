//! The autopilot's wire.

use super::arrivals::Arrivals;
use super::counters::{AutopilotCounters, count};
use super::intake::Intake;
use super::receiver::{ALIVE_US, ReceiverWire};
use crate::flight::event::Event;
use crate::flight::time::Time;
use crate::flight::vh::VhSample;
use crate::io::mavlink::{MavlinkError, MavlinkReading, MavlinkReceiver};

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
    heard: Option<Time>,
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
            heard: None,
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
            && let Some(answer) = self.decoder.buffered()
        {
            self.answer(answer, receiver, arrivals);
        }
        while arrivals.has_room()
            && let Some(byte) = self.intake.take()
        {
            if !self.decoder.is_under_way() {
                self.began = arrivals.now();
            }
            if let Some(answer) = self.decoder.receive(byte) {
                self.answer(answer, receiver, arrivals);
            }
        }
        let unexplained = self.decoder.take_unexplained();
        count(&mut self.counters.unexplained_bytes, unexplained);
    }

    fn answer(
        &mut self,
        answer: Result<MavlinkReading, MavlinkError>,
        receiver: &ReceiverWire,
        arrivals: &mut Arrivals,
    ) {
        match answer {
            Ok(reading) => self.take(&reading, receiver, arrivals),
            Err(error) => count(self.counter(error), 1),
        }
    }

    fn take(&mut self, reading: &MavlinkReading, receiver: &ReceiverWire, arrivals: &mut Arrivals) {
        let now = arrivals.now();
        count(&mut self.counters.read, 1);
        if !self.is_listened_to(reading.system, now) {
            count(&mut self.counters.other_system, 1);
            return;
        }
        for sample in &reading.samples {
            let sample = match *sample {
                // As ground speed it would mix with the receiver's; so the two are compared.
                VhSample::GroundSpeed(speed_m_s) if receiver.has_speed(now) => {
                    VhSample::InertialSpeed(speed_m_s)
                }
                VhSample::Altitude(_) if receiver.has_altitude(now) => continue,
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
            arrivals.push(Event::GnssTime(unix_us));
        }
    }

    fn is_listened_to(&mut self, system: u8, now: Time) -> bool {
        let is_alive = self
            .heard
            .is_some_and(|heard| now.us_since(heard) < ALIVE_US);
        let expected = self
            .wanted
            .or(self.counters.system.filter(|_| is_alive))
            .unwrap_or(system);
        if system == expected {
            self.counters.system = Some(system);
            self.heard = Some(now);
        }
        system == expected
    }

    const fn counter(&mut self, error: MavlinkError) -> &mut u32 {
        match error {
            MavlinkError::Checksum => &mut self.counters.checksum,
            MavlinkError::Malformed => &mut self.counters.malformed,
            MavlinkError::NoFix => &mut self.counters.no_fix,
            MavlinkError::NoDistance => &mut self.counters.no_distance,
            MavlinkError::OutOfRange(_) => &mut self.counters.out_of_range,
        }
    }
}
