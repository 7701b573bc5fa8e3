//! The two wires to the camera, with the devices at their far ends.

use fmc_camera::flight::control_loop::{Events, MAX_EVENTS};
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::instruments::{Instruments, Wire};

use super::aircraft::Aircraft;
use super::autopilot::{Autopilot, Track};
use super::clock::seconds;
use super::fault::Injection;
use super::fault::line::{SerialLine, Traffic};
use super::file::{AutopilotFormat, ReceiverFormat};
use super::receiver::{self, SentenceCounts};
use super::scenario::MissionScenario;
use super::wire::{WireFaults, WireSimulator, WireTraffic};

/// The wires of a scenario: both, one or none.
#[derive(Debug, Clone)]
pub(super) struct Wires {
    receiver: Option<WireSimulator>,
    autopilot: Option<WireSimulator>,
    messages: Autopilot,
    /// Source of V/H that the receiver belongs to.
    source: Option<Traffic>,
    sentences: u32,
    last_speed_m_s: Option<f32>,
    arrived: WireTraffic,
    /// The camera's decoders, for what the camera has been told.
    decoders: Instruments,
}

impl Wires {
    /// Creates the wires of a scenario, with their faults among the injections.
    pub(super) fn of(scenario: &MissionScenario, injections: &[Injection]) -> Self {
        let line = &scenario.written.line;
        let mut tables = scenario.written.vh.iter();
        let table = tables.find(|table| table.source.has_receiver());
        let wire = |baud: i64, faults| {
            WireSimulator::new(u64::try_from(baud).unwrap_or(0), faults, injections)
        };
        let has_receiver = line.receiver == ReceiverFormat::Nmea && table.is_some();
        let has_autopilot = line.autopilot == AutopilotFormat::Mavlink;
        Self {
            receiver: has_receiver.then(|| wire(line.baud, WireFaults::RECEIVER)),
            autopilot: has_autopilot.then(|| wire(line.autopilot_baud, WireFaults::AUTOPILOT)),
            messages: Autopilot::default(),
            source: table.map(|table| Traffic::Vh(table.source)),
            sentences: 0,
            last_speed_m_s: None,
            arrived: WireTraffic::default(),
            decoders: Instruments::new(),
        }
    }

    /// Sends a sample. Returns `false` for a sample that neither receiver nor autopilot reports.
    pub(super) fn send(&mut self, at_us: u64, sample: VhSample) -> bool {
        match (sample, &mut self.receiver, &mut self.autopilot) {
            (VhSample::GroundSpeed(speed_m_s), Some(wire), _) => {
                self.last_speed_m_s = Some(speed_m_s);
                wire.send(at_us, receiver::speed(speed_m_s).as_bytes());
                self.sentences += 1;
            }
            (VhSample::Altitude(altitude_m), Some(wire), _) => {
                wire.send(at_us, receiver::altitude(altitude_m).as_bytes());
                self.sentences += 1;
            }
            (VhSample::HeightAboveGround(height_m), _, Some(wire)) => {
                wire.send(at_us, &self.messages.height(at_us, height_m));
            }
            _ => return false,
        }
        true
    }

    /// Sends the time that names a pulse, s since 1970. Returns `false` without a receiver.
    pub(super) fn send_time(&mut self, at_us: u64, unix_s: u64) -> bool {
        let Some(wire) = &mut self.receiver else {
            return false;
        };
        wire.send(
            at_us,
            receiver::time(unix_s, self.last_speed_m_s).as_bytes(),
        );
        self.sentences += 1;
        true
    }

    /// Sends the attitude of an instant. Returns `false` without an autopilot.
    pub(super) fn send_attitude(&mut self, at_us: u64, aircraft: &Aircraft) -> bool {
        let Some(wire) = &mut self.autopilot else {
            return false;
        };
        let time_s = seconds(at_us);
        let [east_m_s, north_m_s, _] = aircraft.trajectory.velocity_at(time_s);
        let [_, _, altitude_m] = aircraft.trajectory.position_at(time_s);
        let track = Track {
            north_m_s,
            east_m_s,
            altitude_m,
        };
        let sample = aircraft.attitude_sample(time_s);
        wire.send(at_us, &self.messages.attitude(at_us, track, &sample));
        true
    }

    /// Moves the bytes that arrive by a time, µs, to the camera. A line that carries part of a
    /// wire's traffic carries the whole wire.
    pub(super) fn carry(&mut self, line: &SerialLine, to_us: u64) {
        let source = self.source;
        let loses_source = |at_us| source.is_some_and(|source| line.loses(source, at_us));
        if let Some(wire) = &mut self.receiver {
            let is_lost = |at_us| loses_source(at_us) || line.loses(Traffic::Time, at_us);
            let bytes = wire.arrived(to_us, is_lost);
            self.arrived.receiver.extend(bytes);
        }
        if let Some(wire) = &mut self.autopilot {
            let is_lost = |at_us| loses_source(at_us) || line.loses(Traffic::Attitude, at_us);
            let bytes = wire.arrived(to_us, is_lost);
            self.arrived.autopilot.extend(bytes);
        }
    }

    /// Returns the events that the camera makes of the bytes of this round.
    pub(super) fn read(&mut self, now_us: u64) -> Events {
        for byte in &self.arrived.receiver {
            self.decoders.push(Wire::Receiver, *byte);
        }
        for byte in &self.arrived.autopilot {
            self.decoders.push(Wire::Autopilot, *byte);
        }
        self.decoders.round(Time::from_us(now_us), MAX_EVENTS)
    }

    /// Removes and returns the bytes of this round; `None` without wires.
    pub(super) fn traffic(&mut self) -> Option<WireTraffic> {
        let has_wires = self.receiver.is_some() || self.autopilot.is_some();
        has_wires.then(|| std::mem::take(&mut self.arrived))
    }

    /// Returns the time of the next byte, µs.
    pub(super) fn due_us(&self) -> u64 {
        let wires = [&self.receiver, &self.autopilot];
        let due = wires.into_iter().flatten().map(WireSimulator::due_us);
        due.min().unwrap_or(u64::MAX)
    }

    /// Returns the counts of the receiver's sentences.
    pub(super) const fn sentence_counts(&self) -> SentenceCounts {
        let lost_bytes = match &self.receiver {
            Some(wire) => wire.lost_bytes(),
            None => 0,
        };
        SentenceCounts::of(
            self.sentences,
            lost_bytes,
            &self.decoders.counters().receiver,
        )
    }
}
