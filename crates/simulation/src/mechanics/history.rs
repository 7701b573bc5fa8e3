//! Record of the motion of the last seconds.

use std::collections::VecDeque;

/// Positions of screw and stage at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Time since the start of the mechanics, s.
    pub time_s: f64,
    /// Position of the screw, reduced to the stage, mm.
    pub screw_mm: f64,
    /// Position of the stage, mm.
    pub stage_mm: f64,
}

/// Instants in order of time, one per substep.
#[derive(Debug, Clone)]
pub(super) struct History {
    instants: VecDeque<Instant>,
    length_s: f64,
}

impl History {
    pub(super) fn new(start: Instant, length_s: f64) -> Self {
        Self {
            instants: VecDeque::from([start]),
            length_s,
        }
    }

    pub(super) fn push(&mut self, instant: Instant) {
        self.instants.push_back(instant);
        let oldest_s = instant.time_s - self.length_s;
        // One instant before the first stays, so that it can be interpolated from.
        while self
            .instants
            .get(1)
            .is_some_and(|one| one.time_s < oldest_s)
        {
            self.instants.pop_front();
        }
    }

    pub(super) fn since(&self, time_s: f64) -> impl Iterator<Item = Instant> {
        let first = self.instants.partition_point(|one| one.time_s < time_s);
        self.instants.range(first..).copied()
    }

    /// Interpolates linearly between two instants; outside returns the nearest one.
    pub(super) fn at(&self, time_s: f64) -> Option<Instant> {
        let next = self.instants.partition_point(|one| one.time_s < time_s);
        let after = self.instants.get(next).or(self.instants.back())?;
        let before = next.checked_sub(1).and_then(|one| self.instants.get(one));
        let before = before.unwrap_or(after);
        let span_s = after.time_s - before.time_s;
        let part = if span_s > 0.0 {
            (time_s - before.time_s) / span_s
        } else {
            0.0
        };
        Some(Instant {
            time_s,
            screw_mm: before.screw_mm + part * (after.screw_mm - before.screw_mm),
            stage_mm: before.stage_mm + part * (after.stage_mm - before.stage_mm),
        })
    }
}
