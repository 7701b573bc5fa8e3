//! Light that has passed the shutter, with the path of the stage meanwhile.

use super::clock::microseconds;
use super::clock::seconds;
use super::oracle::{FrameTruth, Oracle, TrueExposure};
use super::row_clock::RowClock;
use super::shutter::{Opening, ShutterSimulator};
use crate::mechanics::Mechanics;
use crate::scene::stage_path::StagePath;

/// Time before first light and after last light for which the path of the stage is kept, s.
const PATH_MARGIN_S: f64 = 0.002;
/// Largest difference between the edges of a shutter's sensor and the light, µs.
const SAME_OPENING_US: u64 = 100_000;

/// Exposures that have no record yet.
#[derive(Debug, Clone)]
pub(super) struct Light {
    oracle: Oracle,
    /// Row clock of a TDI sensor, in place of the stage.
    rows: Option<RowClock>,
    /// Openings that have ended, while the path of the stage is not yet complete.
    finished: Vec<Opening>,
    truths: Vec<FrameTruth>,
}

impl Light {
    pub(super) const fn new(oracle: Oracle, rows: Option<RowClock>) -> Self {
        Self {
            oracle,
            rows,
            finished: Vec::new(),
            truths: Vec::new(),
        }
    }

    /// Takes the speed of the rows from the next opening on, mm/s.
    pub(super) const fn clock_rows(&mut self, speed_mm_s: f64) {
        if let Some(rows) = &mut self.rows {
            rows.run_at(speed_mm_s);
        }
    }

    /// Takes the light that has passed by a time, µs.
    pub(super) fn take(
        &mut self,
        shutter: &mut ShutterSimulator,
        mechanics: &Mechanics,
        to_us: u64,
    ) {
        self.finished.extend(shutter.finished(to_us));
        let path_until_s = mechanics.time_s();
        let (ready, rest): (Vec<Opening>, Vec<Opening>) = self
            .finished
            .iter()
            .partition(|opening| seconds(opening.closed_us) + PATH_MARGIN_S <= path_until_s);
        self.finished = rest;
        for opening in ready {
            let path = match &self.rows {
                Some(rows) => rows.path(seconds(opening.closed_us - opening.opened_us)),
                None => stage_path(mechanics, opening),
            };
            if let Some(path) = path {
                let is_of_rows = self.rows.is_some();
                let exposure = TrueExposure {
                    opening,
                    path,
                    is_of_rows,
                };
                self.truths.push(self.oracle.truth(&exposure));
            }
        }
    }

    /// Returns true if light has passed whose true exposure is not known yet.
    pub(super) const fn is_passing(&self) -> bool {
        !self.finished.is_empty()
    }

    /// Removes and returns the true exposure of a record: the one that opened nearest to its time.
    pub(super) fn truth_of(&mut self, opened_us: u64) -> Option<FrameTruth> {
        let apart_us = |truth: &FrameTruth| microseconds(truth.opened_s).abs_diff(opened_us);
        let (index, nearest) = self
            .truths
            .iter()
            .enumerate()
            .min_by_key(|(_, truth)| apart_us(truth))?;
        (apart_us(nearest) <= SAME_OPENING_US).then(|| self.truths.remove(index))
    }

    /// Returns the exposures that belong to no record.
    pub(super) fn into_rest(self) -> Vec<FrameTruth> {
        self.truths
    }
}

/// Returns the path of the stage around an opening of the shutter; times from first light.
fn stage_path(mechanics: &Mechanics, opening: Opening) -> Option<StagePath> {
    let opened_s = seconds(opening.opened_us);
    let until_s = seconds(opening.closed_us) + PATH_MARGIN_S;
    let knots = mechanics
        .history(opened_s - PATH_MARGIN_S)
        .take_while(|instant| instant.time_s <= until_s)
        .map(|instant| (instant.time_s - opened_s, instant.stage_mm))
        .collect();
    StagePath::new(knots)
}
