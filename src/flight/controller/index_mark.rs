//! Crossings of the index mark, and the ways across it.

use super::readiness::Mode;
use super::setup::Setup;
use super::stage::StageMachine;
use super::{Actions, Controller, act};
use crate::flight::event::Action;
use crate::flight::fault::Fault;
use crate::flight::in_doubt::InDoubt;
use crate::flight::index_watch::{Crossing, IndexPlaces};
use crate::flight::time::Time;

impl Controller {
    /// Takes the reading of the encoder at the index mark, mm.
    pub(super) fn index_mark(&mut self, now: Time, reading_mm: f32) {
        if self.stage.is_under_way(now) {
            let next_sequence = self.frame.next_sequence();
            self.stage.latch_index(reading_mm, next_sequence);
        }
    }

    /// Judges the last crossing of the index mark, once readings before and after it are there. If
    /// it differs from the crossings before, exposures since then are in doubt; if it does not
    /// agree with them, the encoder has failed.
    pub(super) fn judge_index(&mut self, setup: &Setup, actions: &mut Actions) {
        let Some(exposures) = self.stage.cross_index(setup) else {
            return;
        };
        let latest = self.frame.kept.latest().map(|(sequence, _)| *sequence);
        if let Some(through_sequence) = latest.filter(|latest| *latest >= exposures.from_sequence) {
            let range = [exposures.from_sequence, through_sequence];
            let exposures = InDoubt::between(range, exposures.off_mm, exposures.is_fault);
            self.stage.index.doubt(exposures);
            self.frame.kept.records_mut().doubt(&exposures);
            act(actions, Action::InDoubt(exposures));
        }
        if exposures.is_fault {
            self.fail(setup, Fault::Encoder, actions);
        }
    }

    /// Returns the end of the stage's next way after a frame, mm.
    pub(super) fn next_place_mm(
        &mut self,
        setup: &Setup,
        from_mm: f32,
        waiting_mm: f32,
        actions: &mut Actions,
    ) -> f32 {
        let Some(sides) = setup.settings.index_sides() else {
            return waiting_mm;
        };
        let places = IndexPlaces {
            sides,
            ends: setup.exercise_ends(),
        };
        let way = self.stage.index.next_way(from_mm, waiting_mm, &places);
        if way.is_newly_missed {
            self.report(Fault::IndexMark, actions);
        }
        way.to_mm
    }

    /// Judges the ways to and fro at arming. Returns `false` if the mark has not been found: the
    /// camera does not get ready.
    pub(super) fn has_found_index(&mut self, setup: &Setup, actions: &mut Actions) -> bool {
        let is_arming = matches!(self.readiness.mode(), Mode::Arming { .. });
        if !is_arming || setup.settings.drive.index_mm.is_none() {
            return true;
        }
        let index = &mut self.stage.index;
        if index.is_referenced(&setup.settings.drive) {
            return true;
        }
        let is_found = index.is_found();
        if index.miss() || !is_found {
            self.report(Fault::IndexMark, actions);
        }
        is_found
    }
}

impl StageMachine {
    /// Returns `true` if crossings of the index mark count: the stage has been told to move along
    /// the FMC axis, and its screw pushes it. A stage that stands may slip to and fro over the
    /// mark.
    fn is_under_way(&self, now: Time) -> bool {
        let is_told = self
            .setpoint(now)
            .is_some_and(|setpoint| setpoint.speed_mm_s > 0.0);
        is_told && !self.is_place_lost() && self.is_pushed_along()
    }

    /// Keeps the reading of the encoder at the index mark, mm, of a stage that is under way, until
    /// the next reading tells how fast it was.
    const fn latch_index(&mut self, reading_mm: f32, next_sequence: u32) {
        self.latched_index = Some((reading_mm, next_sequence));
    }

    /// Judges the crossing before the last reading. Returns the exposures that are in doubt if it
    /// does not agree with the crossing before.
    fn cross_index(&mut self, setup: &Setup) -> Option<InDoubt> {
        let (reading_mm, next_sequence) = self.latched_index.take()?;
        let (speed_mm_s, change_mm_s) = self.track().speed_at(reading_mm)?;
        if speed_mm_s <= 0.0 {
            return None;
        }
        let crossing = Crossing {
            reading_mm,
            speed_mm_s,
            change_mm_s,
            next_sequence,
        };
        self.index.cross(&crossing, &setup.settings.drive)
    }
}
