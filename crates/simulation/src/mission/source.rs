//! Source of V/H, with its noise and its faults.

use std::collections::VecDeque;

use fmc_camera::flight::event::Event;
use fmc_camera::flight::vh::VhSample;
use fmc_camera_file::number::single;

use super::aircraft::{Aircraft, SpeedAndHeight};
use super::clock::microseconds;
use super::clock::{Clocked, seconds};
use super::fault::Injection;
use super::fault::line::Traffic;
use super::fault::vh::VhFaults;
use super::file::{VhQuantity, VhSourceName, VhTable};
use super::wires::Wires;
use crate::noise::Noise;

/// First stream of the noise of speeds between the samples.
const BETWEEN: u64 = 110;

/// A source of V/H.
#[derive(Debug, Clone)]
pub(super) struct Source {
    name: VhSourceName,
    /// `true` for the first source, which faults without a source are of.
    is_first: bool,
    clock: Clocked,
    latency_us: u64,
    /// σ of V/H, relative to V/H.
    sigma: f64,
    noise: Noise,
    /// Noise of the speeds between the samples.
    noise_between: Noise,
    /// Faults of the whole source, of its speed and of its height.
    faults: [VhFaults; 3],
    /// `true` if an earlier source reports the speed of the same receiver.
    is_speed_known: bool,
    under_way: VecDeque<(u64, VhSample)>,
}

impl Source {
    /// Creates the source of a number, counted from 1, with its faults among the injections.
    pub(super) fn new(
        table: &VhTable,
        number: u64,
        injections: &[Injection],
        is_speed_known: bool,
        seed: u64,
    ) -> Self {
        let mut source = Self {
            name: table.source,
            is_first: number == 1,
            clock: Clocked {
                period_us: microseconds(1.0 / table.rate_hz),
                // The clocks of the sources are not in step.
                next_us: 1000 * number + 137 * number,
            },
            latency_us: microseconds(table.latency_ms / 1000.0),
            sigma: table.sigma_percent / 100.0,
            noise: Noise::new(seed, number),
            noise_between: Noise::new(seed, BETWEEN + number),
            faults: [(); 3].map(|()| VhFaults::new(&[])),
            is_speed_known,
            under_way: VecDeque::new(),
        };
        for injection in injections {
            source.inject(*injection);
        }
        source
    }

    /// Adds a fault, if it is one of this source.
    pub(super) fn inject(&mut self, injection: Injection) {
        let is_mine = injection
            .source
            .map_or(self.is_first, |source| source == self.name);
        let [of_all, of_speed, of_height] = &mut self.faults;
        if is_mine {
            match injection.quantity {
                None => of_all.inject(injection),
                Some(VhQuantity::Speed) => of_speed.inject(injection),
                Some(VhQuantity::Height) => of_height.inject(injection),
            }
        }
    }

    /// Traffic that the source is on the line.
    pub(super) const fn traffic(&self) -> Traffic {
        Traffic::Vh(self.name)
    }

    /// Returns true if its speed is that of the satellite receiver.
    pub(super) const fn has_receiver(&self) -> bool {
        self.name.has_receiver()
    }

    /// Returns the speed that the source knows at a time, µs, beside its samples: measured for it,
    /// with noise, latency and faults of its own; `None` while it is silent.
    pub(super) fn speed_m_s(&mut self, aircraft: &Aircraft, at_us: u64) -> Option<f32> {
        let time_s = seconds(at_us.saturating_sub(self.latency_us));
        let truth = aircraft.speed_and_height(time_s);
        let [relative] = self.noise_between.next([self.sigma / 2.0_f64.sqrt()]);
        let [faults, faults_of_speed, _] = &mut self.faults;
        let said = faults.said(time_s, truth.ground_speed_m_s * (1.0 + relative))?;
        faults_of_speed.said(time_s, said).map(single)
    }

    /// Measures the samples due up to a time and sends them, on the wires of receiver and autopilot
    /// if there are any.
    pub(super) fn measure(&mut self, aircraft: &Aircraft, wires: &mut Wires, to_us: u64) {
        while self.clock.next_us <= to_us {
            let time_us = self.clock.next_us;
            self.clock.next_us += self.clock.period_us.max(1);
            let truth = aircraft.speed_and_height(seconds(time_us));
            let at_us = time_us + self.latency_us;
            for sample in self.samples(seconds(time_us), &truth) {
                let is_sent = self.name.has_receiver() && wires.send(at_us, sample);
                if !is_sent {
                    self.under_way.push_back((at_us, sample));
                }
            }
        }
    }

    /// Removes and returns the next sample that has arrived by a time, µs.
    pub(super) fn arrived(&mut self, to_us: u64) -> Option<(u64, VhSample)> {
        self.under_way.pop_front_if(|(at_us, _)| *at_us <= to_us)
    }

    /// Returns the time of the next event, µs.
    pub(super) fn due_us(&self) -> u64 {
        let arrives = self.under_way.front().map_or(u64::MAX, |(at_us, _)| *at_us);
        arrives.min(self.clock.next_us)
    }

    /// Returns the samples of an instant.
    fn samples(&mut self, time_s: f64, truth: &SpeedAndHeight) -> Vec<VhSample> {
        // Speed and height share the variance.
        let part = self.sigma / 2.0_f64.sqrt();
        let [whole, of_speed, of_height] = self.noise.next([self.sigma, part, part]);
        let [faults, faults_of_speed, faults_of_height] = &mut self.faults;
        let first = if self.name == VhSourceName::Direct {
            truth.vh_per_s() * (1.0 + whole)
        } else {
            truth.ground_speed_m_s * (1.0 + of_speed)
        };
        let Some(first) = faults.said(time_s, first) else {
            return Vec::new();
        };
        let first = faults_of_speed.said(time_s, first).map(single);
        if self.name == VhSourceName::Direct {
            return first.map(VhSample::Direct).into_iter().collect();
        }
        let above_ground_m = truth.height_above_ground_m();
        let error_m = above_ground_m * of_height;
        let height_m = match self.name {
            VhSourceName::Terrain => truth.altitude_m + error_m,
            _ => above_ground_m + error_m,
        };
        let height = faults_of_height.said(time_s, height_m).map(single);
        let speed = first.filter(|_| !self.is_speed_known);
        let (speed, height, terrain) = match self.name {
            VhSourceName::Direct => (None, None, None),
            VhSourceName::Altimeter => (
                speed.map(VhSample::GroundSpeed),
                height.map(VhSample::HeightAboveGround),
                None,
            ),
            VhSourceName::Laser => (
                speed.map(VhSample::InertialSpeed),
                height.map(VhSample::LaserHeight),
                None,
            ),
            VhSourceName::Terrain => (
                speed.map(VhSample::GroundSpeed),
                height.map(VhSample::Altitude),
                Some(VhSample::TerrainHeight(single(truth.terrain_m))),
            ),
        };
        [speed, height, terrain].into_iter().flatten().collect()
    }
}

/// V/H according to a source, from the samples that have arrived.
#[derive(Debug, Clone, Copy)]
pub(super) struct ToldVh {
    name: VhSourceName,
    speed_m_s: Option<f64>,
    height_m: Option<f64>,
    terrain_m: Option<f64>,
    vh_per_s: f64,
}

impl ToldVh {
    /// Creates the state before the first sample.
    pub(super) const fn of(name: VhSourceName) -> Self {
        Self {
            name,
            speed_m_s: None,
            height_m: None,
            terrain_m: None,
            vh_per_s: 0.0,
        }
    }

    /// V/H, 1/s; 0 before the first value.
    pub(super) const fn vh_per_s(&self) -> f64 {
        self.vh_per_s
    }

    pub(super) fn hear(&mut self, event: &Event) {
        let Event::Vh(sample) = event else {
            return;
        };
        match (self.name, *sample) {
            (VhSourceName::Direct, VhSample::Direct(vh)) => {
                self.vh_per_s = f64::from(vh);
                return;
            }
            (VhSourceName::Altimeter | VhSourceName::Terrain, VhSample::GroundSpeed(speed))
            | (VhSourceName::Laser, VhSample::InertialSpeed(speed)) => {
                self.speed_m_s = Some(f64::from(speed));
            }
            (VhSourceName::Altimeter, VhSample::HeightAboveGround(height))
            | (VhSourceName::Laser, VhSample::LaserHeight(height))
            | (VhSourceName::Terrain, VhSample::Altitude(height)) => {
                self.height_m = Some(f64::from(height));
            }
            (VhSourceName::Terrain, VhSample::TerrainHeight(height)) => {
                self.terrain_m = Some(f64::from(height));
            }
            _ => return,
        }
        let below_m = if self.name == VhSourceName::Terrain {
            self.terrain_m
        } else {
            Some(0.0)
        };
        if let (Some(speed), Some(height), Some(below)) = (self.speed_m_s, self.height_m, below_m) {
            self.vh_per_s = speed / (height - below);
        }
    }
}
