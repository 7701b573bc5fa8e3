//! Selection of the frame whose rounds are kept as a trace.

use std::collections::VecDeque;

use super::aircraft::Aircraft;
use super::clock::seconds;
use super::flown::FlownFrame;
use super::trace::{Round, Trace};

/// Number of rounds that are kept: the time that a record may need over a line that is cut.
const REMEMBERED: usize = 120_000;
/// Time before its trigger at which a frame's trace begins, µs.
const TRACE_BEFORE_US: u64 = 20_000;
/// Time after its record at which a frame's trace ends, µs; the fly-back falls into it.
const TRACE_AFTER_US: u64 = 70_000;
/// Longest time from its trigger to the end of a frame's trace, µs.
const LONGEST_TRACE_US: u64 = 250_000;

/// A frame whose rounds are being traced.
#[derive(Debug, Clone)]
struct Traced {
    sequence: u32,
    trigger_us: u64,
    until_us: u64,
}

/// The last rounds, and the trace of the selected frame.
#[derive(Debug, Clone)]
pub(super) struct Tracer {
    /// Number of the requested frame.
    wanted: Option<u32>,
    rounds: VecDeque<Round>,
    /// Selected frame, until its rounds end.
    traced: Option<Traced>,
    /// Badness of the selected frame.
    worst: f64,
    has_failed: bool,
    trace: Option<Trace>,
}

impl Tracer {
    /// Creates a tracer of the requested frame, or else of the first with a fault, or else of the
    /// one with the largest smear.
    pub(super) const fn new(wanted: Option<u32>) -> Self {
        Self {
            wanted,
            rounds: VecDeque::new(),
            traced: None,
            worst: f64::NEG_INFINITY,
            has_failed: false,
            trace: None,
        }
    }

    pub(super) fn push(&mut self, round: Round) {
        if self.wanted == Some(0) {
            return;
        }
        if self.rounds.len() == REMEMBERED {
            self.rounds.pop_front();
        }
        self.rounds.push_back(round);
    }

    /// Selects a frame if it is worse than the ones before.
    pub(super) fn consider(&mut self, now_us: u64, frame: &FlownFrame, aircraft: &Aircraft) {
        let badness = self.badness(frame);
        self.has_failed |= !frame.record.faults.is_empty();
        if badness > self.worst {
            self.worst = badness;
            self.finish(aircraft);
            self.traced = Some(Traced {
                sequence: frame.record.sequence,
                trigger_us: frame.record.trigger.us(),
                until_us: (now_us + TRACE_AFTER_US)
                    .min(frame.record.trigger.us() + LONGEST_TRACE_US),
            });
        }
    }

    /// Ends the trace when its time is over.
    pub(super) fn look(&mut self, now_us: u64, aircraft: &Aircraft) {
        if self
            .traced
            .as_ref()
            .is_some_and(|traced| now_us >= traced.until_us)
        {
            self.finish(aircraft);
        }
    }

    /// Returns the trace at the end of the flight.
    pub(super) fn into_trace(mut self, aircraft: &Aircraft) -> Option<Trace> {
        self.finish(aircraft);
        self.trace
    }

    /// Cuts the rounds of the selected frame out of those that are kept.
    fn finish(&mut self, aircraft: &Aircraft) {
        let Some(traced) = self.traced.take() else {
            return;
        };
        let since_us = traced.trigger_us.saturating_sub(TRACE_BEFORE_US);
        let first = self
            .rounds
            .partition_point(|round| round.time_us < since_us);
        let mut rounds: Vec<Round> = self.rounds.range(first..).copied().collect();
        rounds.retain(|round| round.time_us <= traced.until_us);
        if rounds.is_empty() {
            return;
        }
        let true_vh_per_s = rounds
            .iter()
            .map(|round| {
                let there = aircraft.speed_and_height(seconds(round.time_us));
                there.vh_per_s()
            })
            .collect();
        self.trace = Some(Trace {
            sequence: traced.sequence,
            trigger_us: traced.trigger_us,
            rounds,
            true_vh_per_s,
        });
    }

    /// Returns the badness of a frame; the frame with the greatest is traced.
    fn badness(&self, frame: &FlownFrame) -> f64 {
        if let Some(wanted) = self.wanted {
            return if frame.record.sequence == wanted {
                0.0
            } else {
                f64::NEG_INFINITY
            };
        }
        if !self.has_failed && !frame.record.faults.is_empty() {
            return f64::INFINITY;
        }
        frame.truth.as_ref().map_or(0.0, |truth| truth.smear_mm)
    }
}
