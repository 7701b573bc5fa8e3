//! The two wires to the camera, with the devices at their far ends.

use fmc_camera::flight::control_loop::{Events, MAX_EVENTS};
use fmc_camera::flight::event::AttitudeSample;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::instruments::{Instruments, Wire};

use super::aircraft::Aircraft;
use super::autopilot::{Autopilot, Track};
use super::clock::seconds;
use super::fault::Injection;
use super::fault::line::{SerialLine, Traffic};
use super::file::{AutopilotFormat, ReceiverFormat, VhSourceName, VhTable};
use super::receiver::{self, SentenceCounts};
use super::scenario::MissionScenario;
use super::wire::{WireFaults, WireSimulator, WireTraffic};
use super::wire_load::receiver_table;
use crate::noise::Noise;

/// Navigation of the autopilot, which has a receiver of its own, as noisy and as late as the
/// camera's. No fault of a source of V/H acts on it: those are faults of the camera's receiver.
#[derive(Debug, Clone)]
struct Navigation {
    latency_s: f64,
    /// σ of speed and of height above ground, relative to them.
    sigma: f64,
    noise: Noise,
}

impl Navigation {
    /// Stream of the noise.
    const STREAM: u64 = 103;

    fn of(table: Option<&VhTable>, seed: u64) -> Self {
        Self {
            latency_s: table.map_or(0.0, |table| table.latency_ms / 1000.0),
            // Speed and height share the variance.
            sigma: table.map_or(0.0, |table| table.sigma_percent / 100.0 / 2.0_f64.sqrt()),
            noise: Noise::new(seed, Self::STREAM),
        }
    }

    /// Returns the motion that the autopilot knows at a time, s. Its noise is along the track.
    fn track(&mut self, aircraft: &Aircraft, time_s: f64) -> Track {
        let then_s = (time_s - self.latency_s).max(0.0);
        let [east_m_s, north_m_s, _] = aircraft.trajectory.velocity_at(then_s);
        let truth = aircraft.speed_and_height(then_s);
        let [of_speed, of_height] = self.noise.next([self.sigma, self.sigma]);
        Track {
            north_m_s: north_m_s * (1.0 + of_speed),
            east_m_s: east_m_s * (1.0 + of_speed),
            altitude_m: truth.altitude_m + truth.height_above_ground_m() * of_height,
        }
    }
}

/// The wires of a scenario: both, one or none.
#[derive(Debug, Clone)]
pub(super) struct Wires {
    receiver: Option<WireSimulator>,
    autopilot: Option<WireSimulator>,
    messages: Autopilot,
    /// Speed and altitude that the autopilot sends.
    navigation: Navigation,
    /// Sources of V/H and times on the receiver's wire.
    of_receiver: Vec<Traffic>,
    /// Sources of V/H and attitudes on the autopilot's.
    of_autopilot: Vec<Traffic>,
    sentences: u32,
    arrived: WireTraffic,
    /// The camera's decoders, for what the camera has been told.
    decoders: Instruments,
}

impl Wires {
    /// Creates the wires of a scenario, with their faults among the injections.
    pub(super) fn of(scenario: &MissionScenario, injections: &[Injection], seed: u64) -> Self {
        let written = &scenario.written;
        let line = &written.line;
        let table = receiver_table(written);
        let mut of_receiver = vec![Traffic::Time];
        let mut of_autopilot = vec![Traffic::Attitude];
        for source in written.vh.iter().map(|table| table.source) {
            if table.is_some_and(|table| table.source == source) || source == VhSourceName::Terrain
            {
                of_receiver.push(Traffic::Vh(source));
            }
            if source == VhSourceName::Altimeter {
                of_autopilot.push(Traffic::Vh(source));
            }
        }
        let wire = |baud: i64, faults| {
            WireSimulator::new(u64::try_from(baud).unwrap_or(0), faults, injections)
        };
        let has_receiver = line.receiver == ReceiverFormat::Nmea && table.is_some();
        let has_autopilot = line.autopilot == AutopilotFormat::Mavlink;
        Self {
            receiver: has_receiver.then(|| wire(line.baud, WireFaults::RECEIVER)),
            autopilot: has_autopilot.then(|| wire(line.autopilot_baud, WireFaults::AUTOPILOT)),
            messages: Autopilot::default(),
            navigation: Navigation::of(table.or(written.vh.first()), seed),
            of_receiver,
            of_autopilot,
            sentences: 0,
            arrived: WireTraffic::default(),
            decoders: Instruments::new(),
        }
    }

    /// Adds a fault to the wire that it is of.
    pub(super) fn inject(&mut self, injection: Injection) {
        for wire in [&mut self.receiver, &mut self.autopilot]
            .into_iter()
            .flatten()
        {
            wire.inject(injection);
        }
    }

    /// Sends a sample. Returns `false` for a sample that neither receiver nor autopilot reports.
    pub(super) fn send(&mut self, at_us: u64, sample: VhSample) -> bool {
        match (sample, &mut self.receiver, &mut self.autopilot) {
            (VhSample::GroundSpeed(speed_m_s), Some(wire), _) => {
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

    /// Returns true if there is a receiver's wire.
    pub(super) const fn has_receiver(&self) -> bool {
        self.receiver.is_some()
    }

    /// Sends the time that names a pulse, s since 1970, with the speed that the receiver has then.
    pub(super) fn send_time(&mut self, at_us: u64, unix_s: u64, speed_m_s: Option<f32>) {
        if let Some(wire) = &mut self.receiver {
            wire.send(at_us, receiver::time(unix_s, speed_m_s).as_bytes());
            self.sentences += 1;
        }
    }

    /// Sends the attitude of an instant. Returns `false` without an autopilot.
    pub(super) fn send_attitude(
        &mut self,
        at_us: u64,
        aircraft: &Aircraft,
        sample: &AttitudeSample,
    ) -> bool {
        let Some(wire) = &mut self.autopilot else {
            return false;
        };
        let time_s = seconds(at_us);
        let track = self.navigation.track(aircraft, time_s);
        wire.send(at_us, &self.messages.attitude(at_us, track, sample));
        true
    }

    /// Moves the bytes that arrive by a time, µs, to the camera. A line that carries part of a
    /// wire's traffic carries the whole wire.
    pub(super) fn carry(&mut self, line: &SerialLine, to_us: u64) {
        let loses = |traffic: &[Traffic], at_us| traffic.iter().any(|one| line.loses(*one, at_us));
        if let Some(wire) = &mut self.receiver {
            let bytes = wire.arrived(to_us, |at_us| loses(&self.of_receiver, at_us));
            self.arrived.receiver.extend(bytes);
        }
        if let Some(wire) = &mut self.autopilot {
            let bytes = wire.arrived(to_us, |at_us| loses(&self.of_autopilot, at_us));
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
