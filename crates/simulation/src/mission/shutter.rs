//! Shutter and its sensor.

use fmc_camera::flight::event::ShutterEdge;

use super::clock::microseconds;
use super::clock::seconds;
use super::fault::Injection;
use super::fault::shutter::opening_fault;
use crate::noise::Noise;

/// A shutter that opens a time after the command.
#[derive(Debug, Clone)]
pub struct ShutterSimulator {
    latency_s: f64,
    jitter_s: f64,
    noise: Noise,
    injections: Vec<Injection>,
    /// Light that passes now or later.
    openings: Vec<Opening>,
    /// Edges that the sensor has yet to report, in order of time.
    edges: Vec<(u64, ShutterEdge)>,
}

/// Times of light through the shutter, µs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Opening {
    /// First light.
    pub opened_us: u64,
    /// Last light.
    pub closed_us: u64,
}

/// Latency of the shutter and its scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShutterTiming {
    /// Time from the command to first light, s.
    pub latency_s: f64,
    /// σ of the latency, s.
    pub jitter_s: f64,
}

impl ShutterSimulator {
    /// Creates a closed shutter.
    #[must_use]
    pub fn new(timing: ShutterTiming, injections: &[Injection], seed: u64) -> Self {
        Self {
            latency_s: timing.latency_s,
            jitter_s: timing.jitter_s,
            noise: Noise::new(seed, 100),
            injections: injections.to_vec(),
            openings: Vec::new(),
            edges: Vec::new(),
        }
    }

    /// Adds a fault.
    pub fn inject(&mut self, injection: Injection) {
        self.injections.push(injection);
    }

    /// Receives the command to open at a time, µs.
    pub fn open(&mut self, at_us: u64, exposure_s: f64) {
        let [jitter_s] = self.noise.next([self.jitter_s]);
        let fault = opening_fault(&self.injections, seconds(at_us));
        if fault.stays_shut {
            return;
        }
        let delay_s = (self.latency_s + fault.late_s + jitter_s).max(0.0);
        let opened_us = at_us + microseconds(delay_s);
        let closed_us = opened_us + microseconds(exposure_s);
        self.openings.push(Opening {
            opened_us,
            closed_us,
        });
        if !fault.opening_unseen {
            self.edges.push((opened_us, ShutterEdge::Opened));
        }
        if let Some(again_s) = fault.again_s {
            let again_us = opened_us + microseconds(again_s);
            self.edges.push((again_us, ShutterEdge::Opened));
        }
        if !fault.closing_unseen {
            self.edges.push((closed_us, ShutterEdge::Closed));
        }
        self.edges.sort_by_key(|(time, _)| *time);
    }

    /// Receives the command to close, or to stay closed, at a time, µs.
    pub fn close(&mut self, at_us: u64) {
        self.openings.retain(|opening| opening.opened_us <= at_us);
        self.edges.retain(|(time, _)| *time <= at_us);
        for opening in &mut self.openings {
            if opening.closed_us > at_us {
                opening.closed_us = at_us;
                self.edges.push((at_us, ShutterEdge::Closed));
            }
        }
    }

    /// Returns true if light passes at a time, µs.
    #[must_use]
    pub fn is_open(&self, at_us: u64) -> bool {
        self.openings
            .iter()
            .any(|opening| opening.opened_us <= at_us && at_us < opening.closed_us)
    }

    /// Returns true if light passes now or later.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.openings.is_empty()
    }

    /// Removes and returns the edges of the sensor up to a time, µs.
    pub fn edges(&mut self, to_us: u64) -> Vec<(u64, ShutterEdge)> {
        let until = self.edges.partition_point(|(time, _)| *time <= to_us);
        self.edges.drain(..until).collect()
    }

    /// Removes and returns the light that has passed by a time, µs.
    pub fn finished(&mut self, to_us: u64) -> Vec<Opening> {
        let (done, rest) = self
            .openings
            .iter()
            .partition(|opening| opening.closed_us <= to_us);
        self.openings = rest;
        done
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::fault::InjectedFault;

    fn shutter(injections: &[Injection]) -> ShutterSimulator {
        let timing = ShutterTiming {
            latency_s: 0.005,
            jitter_s: 0.0,
        };
        ShutterSimulator::new(timing, injections, 1)
    }

    #[test]
    fn light_passes_one_latency_after_the_order_and_both_edges_are_seen() {
        let mut shutter = shutter(&[]);
        shutter.open(1_000_000, 0.002);
        assert!(shutter.edges(1_004_999).is_empty());
        assert!(shutter.is_open(1_005_000) && !shutter.is_open(1_007_000));
        let edges = shutter.edges(1_010_000);
        let expected = [
            (1_005_000, ShutterEdge::Opened),
            (1_007_000, ShutterEdge::Closed),
        ];
        assert_eq!(edges, expected);
        assert_eq!(shutter.finished(1_010_000).len(), 1);
        assert!(!shutter.is_busy());
    }

    #[test]
    fn order_to_close_ends_the_light_or_prevents_it() {
        let mut open = shutter(&[]);
        open.open(0, 0.010);
        open.close(8000);
        let [light] = open.finished(20_000)[..] else {
            panic!("one opening")
        };
        assert_eq!((light.opened_us, light.closed_us), (5000, 8000));
        let mut not_yet = shutter(&[]);
        not_yet.open(0, 0.010);
        not_yet.close(1000);
        assert!(!not_yet.is_busy() && not_yet.edges(20_000).is_empty());
    }

    #[test]
    fn sensor_that_misses_an_edge_does_not_stop_the_light() {
        let missing = |size| [Injection::new(InjectedFault::ShutterMissing, 0.0).of_size(size)];
        let mut unseen = shutter(&missing(1.0));
        unseen.open(0, 0.002);
        assert_eq!(unseen.edges(10_000), [(7000, ShutterEdge::Closed)]);
        assert_eq!(unseen.finished(10_000).len(), 1);
        let mut shut = shutter(&missing(0.0));
        shut.open(0, 0.002);
        assert!(!shut.is_busy());
        let mut twice = shutter(&[Injection::new(InjectedFault::ShutterDouble, 0.0)]);
        twice.open(0, 0.002);
        assert_eq!(twice.edges(10_000).len(), 3);
    }
}
