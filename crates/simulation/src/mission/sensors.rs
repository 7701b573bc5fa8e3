//! Sensors of the aircraft: what they report to the camera, and when.

use fmc_camera::flight::event::Event;
use fmc_camera::flight::time::Time;

use super::aircraft::Aircraft;
use super::clock::{Clocked, microseconds, seconds};
use super::fault::line::{SerialLine, Traffic};
use super::fault::{Injection, attitude, receiver};
use super::receiver::SentenceCounts;
use super::scenario::MissionScenario;
use super::source::{Source, ToldVh};
use super::wire::WireTraffic;
use super::wires::Wires;
use crate::noise::Noise;

/// Time of the receiver's first time pulse, µs.
pub(super) const FIRST_PULSE_US: u64 = 300_250;
/// One second, µs.
const SECOND_US: u64 = 1_000_000;
/// Time from a pulse to the message that names it, µs.
const NAMED_AFTER_US: u64 = 120_000;

/// All sensors of the aircraft.
#[derive(Debug, Clone)]
pub struct Sensors {
    sources: Vec<Source>,
    wires: Wires,
    line: SerialLine,
    attitude: Option<Clocked>,
    /// The time pulse, and the second that begins with the first one.
    pulses: Option<(Clocked, u64)>,
    /// σ of the pulses' stamps, s, and its source.
    pulse_jitter_s: f64,
    pulse_noise: Noise,
    /// Time at which the last pulse comes again, µs.
    second_pulse_us: Option<u64>,
    injections: Vec<Injection>,
    /// Time of the next event, µs.
    due_us: u64,
    /// V/H according to the first source.
    told: Option<ToldVh>,
}

impl Sensors {
    /// Creates the sensors of a scenario, with the faults of its sources.
    #[must_use]
    pub fn of(
        scenario: &MissionScenario,
        line: &SerialLine,
        injections: &[Injection],
        seed: u64,
    ) -> Self {
        let tables = &scenario.written.vh;
        let sources = tables.iter().zip(1_u64..).map(|(table, number)| {
            // All sources share the one receiver of the aircraft.
            let is_speed_known = table.source.has_receiver()
                && tables
                    .iter()
                    .take_while(|earlier| earlier.source != table.source)
                    .any(|earlier| earlier.source.has_receiver());
            Source::new(table, number, injections, is_speed_known, seed)
        });
        let reported_hz = scenario.written.attitude.reported_hz;
        Self {
            sources: sources.collect(),
            wires: Wires::of(scenario, injections, seed),
            line: line.clone(),
            attitude: (reported_hz > 0.0).then(|| Clocked {
                period_us: microseconds(1.0 / reported_hz),
                next_us: 700,
            }),
            pulses: scenario.written.gnss.as_ref().map(|gnss| {
                let clock = Clocked {
                    period_us: SECOND_US,
                    next_us: FIRST_PULSE_US,
                };
                (clock, u64::try_from(gnss.first_pulse_unix_s).unwrap_or(0))
            }),
            pulse_jitter_s: scenario
                .written
                .gnss
                .as_ref()
                .map_or(0.0, |gnss| 1e-6 * gnss.pulse_jitter_us),
            pulse_noise: Noise::new(seed, 102),
            second_pulse_us: None,
            injections: injections.to_vec(),
            due_us: 0,
            told: tables.first().map(|table| ToldVh::of(table.source)),
        }
    }

    /// Adds a fault.
    pub fn inject(&mut self, injection: Injection) {
        for source in &mut self.sources {
            source.inject(injection);
        }
        self.wires.inject(injection);
        self.line.inject(&injection);
        self.injections.push(injection);
        // The next event may come sooner.
        self.due_us = 0;
    }

    /// Returns the events that arrive up to a time, in order.
    pub fn arrivals(&mut self, aircraft: &Aircraft, to_us: u64) -> Vec<(Time, Event)> {
        let mut arrived = Vec::new();
        if self.due_us > to_us {
            return arrived;
        }
        let mut due_us = u64::MAX;
        for source in &mut self.sources {
            source.measure(aircraft, &mut self.wires, to_us);
            while let Some((at_us, sample)) = source.arrived(to_us) {
                if !self.line.loses(source.traffic(), at_us) {
                    arrived.push((Time::from_us(at_us), Event::Vh(sample)));
                }
            }
            due_us = due_us.min(source.due_us());
        }
        if let Some(clock) = &mut self.attitude {
            while clock.next_us <= to_us {
                let time_s = seconds(clock.next_us);
                let sample = attitude::reported(&self.injections, aircraft, time_s);
                let is_sent = self.wires.send_attitude(clock.next_us, aircraft, &sample);
                if !is_sent && !self.line.loses(Traffic::Attitude, clock.next_us) {
                    arrived.push((Time::from_us(clock.next_us), Event::Attitude(sample)));
                }
                clock.next_us += clock.period_us.max(1);
            }
            due_us = due_us.min(clock.next_us);
        }
        if let Some((clock, first_unix_s)) = &mut self.pulses {
            // The events of this clock are alternately pulses and the messages that name them.
            let injections = &self.injections;
            let is_pulse =
                |clock: &Clocked| (clock.next_us - FIRST_PULSE_US).is_multiple_of(SECOND_US);
            let next_us = |clock: &Clocked| {
                if is_pulse(clock) {
                    receiver::moved_us(injections, clock.next_us)
                } else {
                    clock.next_us
                }
            };
            while next_us(clock) <= to_us {
                let time = Time::from_us(clock.next_us);
                let second = (clock.next_us - FIRST_PULSE_US) / SECOND_US;
                if is_pulse(clock) {
                    let [jitter_s] = self.pulse_noise.next([self.pulse_jitter_s]);
                    let at_us = microseconds(seconds(next_us(clock)) + jitter_s);
                    if !receiver::is_missing(injections, clock.next_us) {
                        arrived.push((Time::from_us(at_us), Event::TimePulse));
                    }
                    self.second_pulse_us = receiver::again_us(injections, clock.next_us);
                    clock.next_us += NAMED_AFTER_US;
                } else {
                    let unix_s = *first_unix_s + second;
                    let unix_s = receiver::named_s(injections, clock.next_us, unix_s);
                    if self.wires.has_receiver() {
                        let mut sources = self.sources.iter_mut();
                        let receiver = sources.find(|source| source.has_receiver());
                        let speed_m_s =
                            receiver.and_then(|one| one.speed_m_s(aircraft, clock.next_us));
                        self.wires.send_time(clock.next_us, unix_s, speed_m_s);
                    } else if !self.line.loses(Traffic::Time, clock.next_us) {
                        arrived.push((time, Event::GnssTime(unix_s * SECOND_US)));
                    }
                    clock.next_us += clock.period_us - NAMED_AFTER_US;
                }
            }
            due_us = due_us.min(next_us(clock));
        }
        if let Some(pulse_us) = self.second_pulse_us.take_if(|pulse_us| *pulse_us <= to_us) {
            arrived.push((Time::from_us(pulse_us), Event::TimePulse));
        }
        due_us = due_us.min(self.second_pulse_us.unwrap_or(u64::MAX));
        self.wires.carry(&self.line, to_us);
        self.due_us = due_us.min(self.wires.due_us());
        arrived.sort_by_key(|(time, _)| *time);
        if let Some(told) = &mut self.told {
            let on_wires = self.wires.read(to_us);
            for (_, event) in arrived.iter().chain(&on_wires) {
                told.hear(event);
            }
        }
        arrived
    }

    /// Returns the bytes that have arrived on the wires since the last call; `None` without wires.
    pub fn traffic(&mut self) -> Option<WireTraffic> {
        self.wires.traffic()
    }

    /// V/H according to the first source, 1/s; 0 before its first value.
    #[must_use]
    pub fn told_vh_per_s(&self) -> f64 {
        self.told.map_or(0.0, |told| told.vh_per_s())
    }

    /// Counts of the receiver's sentences.
    #[must_use]
    pub const fn sentence_counts(&self) -> SentenceCounts {
        self.wires.sentence_counts()
    }
}
