//! What the aircraft's sensors tell the camera, and when.

use std::collections::VecDeque;

use fmc_camera::flight::event::Event;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;

use super::aircraft::{Aircraft, SpeedAndHeight};
use super::fault::Injection;
use super::fault::trigger::microseconds;
use super::fault::vh::VhFaults;
use crate::formats::mission_file::VhSourceName;
use crate::formats::mission_scenario::MissionScenario;
use crate::formats::number::single;
use crate::noise::Noise;

/// When the receiver's first time pulse comes, µs.
const FIRST_PULSE_US: u64 = 300_250;
/// A second, µs.
const SECOND_US: u64 = 1_000_000;
/// So long after its pulse comes the message that names it, µs.
const NAMED_AFTER_US: u64 = 120_000;

/// All sensors of the aircraft.
#[derive(Debug, Clone)]
pub struct Sensors {
    sources: Vec<Source>,
    attitude: Option<Clocked>,
    /// The time pulse, and the second that the first one begins.
    pulses: Option<(Clocked, u64)>,
    /// When something happens next, µs.
    due_us: u64,
    told_vh_per_s: f64,
}

/// Something that comes round.
#[derive(Debug, Clone, Copy)]
struct Clocked {
    period_us: u64,
    next_us: u64,
}

/// A source of V/H.
#[derive(Debug, Clone)]
struct Source {
    name: VhSourceName,
    clock: Clocked,
    latency_us: u64,
    /// σ of V/H relative to it.
    sigma: f64,
    noise: Noise,
    faults: VhFaults,
    under_way: VecDeque<(u64, VhSample)>,
}

impl Sensors {
    /// The sensors of a scenario; faults are those of the first V/H source.
    #[must_use]
    pub fn of(scenario: &MissionScenario, injections: &[Injection], seed: u64) -> Self {
        let sources = scenario
            .written
            .vh
            .iter()
            .zip(1_u64..)
            .map(|(sensor, number)| Source {
                name: sensor.source,
                clock: Clocked {
                    period_us: microseconds(1.0 / sensor.rate_hz),
                    // Nobody's clocks are in step.
                    next_us: 1000 * number + 137 * number,
                },
                latency_us: microseconds(sensor.latency_ms / 1000.0),
                sigma: sensor.sigma_percent / 100.0,
                noise: Noise::new(seed, number),
                faults: VhFaults::new(if number == 1 { injections } else { &[] }),
                under_way: VecDeque::new(),
            });
        let reported_hz = scenario.written.attitude.reported_hz;
        Self {
            sources: sources.collect(),
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
            due_us: 0,
            told_vh_per_s: 0.0,
        }
    }

    /// What arrives up to a time, in order.
    pub fn arrivals(&mut self, aircraft: &Aircraft, to_us: u64) -> Vec<(Time, Event)> {
        let mut arrived = Vec::new();
        if self.due_us > to_us {
            return arrived;
        }
        let mut due_us = u64::MAX;
        for source in &mut self.sources {
            source.measure(aircraft, to_us);
            while let Some((at_us, sample)) = source.under_way.front().copied() {
                if at_us > to_us {
                    due_us = due_us.min(at_us);
                    break;
                }
                source.under_way.pop_front();
                arrived.push((Time::from_us(at_us), Event::Vh(sample)));
            }
            due_us = due_us.min(source.clock.next_us);
        }
        if let Some(clock) = &mut self.attitude {
            while clock.next_us <= to_us {
                let sample = aircraft.attitude_sample(seconds(clock.next_us));
                arrived.push((Time::from_us(clock.next_us), Event::Attitude(sample)));
                clock.next_us += clock.period_us.max(1);
            }
            due_us = due_us.min(clock.next_us);
        }
        if let Some((clock, first_unix_s)) = &mut self.pulses {
            // Half of the rounds of this clock are pulses, the others their names.
            while clock.next_us <= to_us {
                let time = Time::from_us(clock.next_us);
                let into_second_us = (clock.next_us - FIRST_PULSE_US) % SECOND_US;
                let second = (clock.next_us - FIRST_PULSE_US) / SECOND_US;
                if into_second_us == 0 {
                    arrived.push((time, Event::TimePulse));
                    clock.next_us += NAMED_AFTER_US;
                } else {
                    let unix_us = (*first_unix_s + second) * SECOND_US;
                    arrived.push((time, Event::GnssTime(unix_us)));
                    clock.next_us += clock.period_us - NAMED_AFTER_US;
                }
            }
            due_us = due_us.min(clock.next_us);
        }
        self.due_us = due_us;
        arrived.sort_by_key(|(time, _)| *time);
        if let Some(first) = self.sources.first()
            && let Some(told) = first.told(&arrived)
        {
            self.told_vh_per_s = told;
        }
        arrived
    }

    /// V/H as the first source has it, 1/s; 0 before it has spoken.
    #[must_use]
    pub const fn told_vh_per_s(&self) -> f64 {
        self.told_vh_per_s
    }
}

impl Source {
    /// Takes the samples that are due up to a time and sends them.
    fn measure(&mut self, aircraft: &Aircraft, to_us: u64) {
        while self.clock.next_us <= to_us {
            let time_us = self.clock.next_us;
            self.clock.next_us += self.clock.period_us.max(1);
            let time_s = seconds(time_us);
            let truth = aircraft.speed_and_height(time_s);
            // Speed and height share the variance.
            let part = self.sigma / 2.0_f64.sqrt();
            let [whole, of_speed, of_height] = self.noise.next([self.sigma, part, part]);
            let value = match self.name {
                VhSourceName::Direct => truth.vh_per_s() * (1.0 + whole),
                VhSourceName::Altimeter | VhSourceName::Terrain => {
                    truth.ground_speed_m_s * (1.0 + of_speed)
                }
            };
            let Some(said) = self.faults.said(time_s, value) else {
                continue;
            };
            for sample in samples(self.name, said, &truth, of_height) {
                self.under_way
                    .push_back((time_us + self.latency_us, sample));
            }
        }
    }

    /// V/H of the last samples among the arrivals.
    fn told(&self, arrived: &[(Time, Event)]) -> Option<f64> {
        let [mut speed, mut height] = [None, None];
        for (_, event) in arrived {
            match (self.name, event) {
                (VhSourceName::Direct, Event::Vh(VhSample::Direct(vh))) => {
                    return Some(f64::from(*vh));
                }
                (_, Event::Vh(VhSample::GroundSpeed(value))) => speed = Some(f64::from(*value)),
                (
                    VhSourceName::Altimeter,
                    Event::Vh(VhSample::HeightAboveGround(value) | VhSample::Altitude(value)),
                ) => height = Some(f64::from(*value)),
                (VhSourceName::Terrain, Event::Vh(VhSample::Altitude(value))) => {
                    height = Some(f64::from(*value));
                }
                (VhSourceName::Terrain, Event::Vh(VhSample::TerrainHeight(value))) => {
                    height = height.map(|altitude: f64| altitude - f64::from(*value));
                }
                _ => {}
            }
        }
        Some(speed? / height?)
    }
}

/// What a source sends of one instant.
fn samples(
    name: VhSourceName,
    said: f64,
    truth: &SpeedAndHeight,
    height_error: f64,
) -> Vec<VhSample> {
    let above_ground_m = truth.height_above_ground_m();
    match name {
        VhSourceName::Direct => vec![VhSample::Direct(single(said))],
        VhSourceName::Altimeter => vec![
            VhSample::GroundSpeed(single(said)),
            VhSample::HeightAboveGround(single(above_ground_m * (1.0 + height_error))),
        ],
        VhSourceName::Terrain => vec![
            VhSample::GroundSpeed(single(said)),
            VhSample::Altitude(single(truth.altitude_m + above_ground_m * height_error)),
            VhSample::TerrainHeight(single(truth.terrain_m)),
        ],
    }
}

/// Seconds of microseconds.
#[expect(
    clippy::cast_precision_loss,
    reason = "a flight is shorter than 2^53 µs"
)]
pub(super) fn seconds(us: u64) -> f64 {
    us as f64 * 1e-6
}
