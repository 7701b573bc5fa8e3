//! Crossings of the index mark, the ways across it, and the records that wait for them.

use super::frame::Recorded;
use super::readiness::Mode;
use super::setup::Setup;
use super::stage::StageMachine;
use super::{Actions, Controller, act};
use crate::flight::event::Action;
use crate::flight::fault::Fault;
use crate::flight::in_doubt::InDoubt;
use crate::flight::index_watch::{Crossing, IndexPlaces, LatchedIndex, lost_sigma_mm};
use crate::flight::play_watch::is_play_in_error;
use crate::flight::time::Time;
use crate::flight::unconfirmed::Waiting;

impl Controller {
    /// Takes the reading of the encoder at the index mark, mm.
    pub(super) fn index_mark(&mut self, setup: &Setup, now: Time, reading_mm: f32) {
        if let Some(is_along) = self.stage.way_across(setup, now) {
            self.stage.latched_index = Some(LatchedIndex {
                reading_mm,
                next_sequence: self.frame.next_sequence(),
                is_along,
            });
        }
    }

    /// Judges the last crossing of the index mark, once readings before and after it are there. If
    /// it differs from the crossings before, exposures since then are in doubt; if one along the
    /// FMC axis does not agree with them, the encoder has failed.
    pub(super) fn judge_index(&mut self, setup: &Setup, actions: &mut Actions) {
        let Some(exposures) = self.stage.cross_index(setup) else {
            return;
        };
        let latest = self.frame.kept.latest().map(|(sequence, _)| *sequence);
        if let Some(through_sequence) = latest.filter(|latest| *latest >= exposures.from_sequence) {
            let range = [exposures.from_sequence, through_sequence];
            let exposures = InDoubt::between(range, exposures.off_mm, exposures.is_fault);
            self.doubt(exposures, actions);
        }
        if exposures.is_fault {
            self.fail(setup, Fault::Encoder, actions);
        }
    }

    /// Marks exposures that are in doubt.
    pub(super) fn doubt(&mut self, exposures: InDoubt, actions: &mut Actions) {
        self.stage.index.doubt(exposures);
        self.frame.kept.records_mut().doubt(&exposures);
        act(actions, Action::InDoubt(exposures));
    }

    /// Lets a record wait for the crossings that confirm it, unless its motion is not that of the
    /// encoder.
    pub(super) fn await_crossings(&mut self, setup: &Setup, now: Time, recorded: &Recorded) {
        let drive = &setup.settings.drive;
        let to_mm = self.stage.place_mm(now);
        let stage = &mut self.stage;
        if let Some(sides) = setup
            .settings
            .index_sides()
            .filter(|_| recorded.is_measured)
        {
            stage.unconfirmed.wait(&Waiting {
                sequence: recorded.sequence,
                is_referenced: stage.index.is_referenced(drive),
                awaits_pair: stage.play_watch.has_reference(),
                lost_mm: lost_sigma_mm(setup.stage_tolerance().unseen_mm(), 1.0),
            });
            let is_expected = stage.index.has_led_down(to_mm, &sides);
            stage.play_watch.expect(is_expected);
        }
        stage.index.count_record();
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
        if (way.is_newly_missed || way.is_overdue)
            && let Some(exposures) = self.stage.unconfirmed.take_counts()
        {
            self.doubt(exposures, actions);
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
    /// Returns `true` if the stage crosses the index mark along the FMC axis, `false` if against
    /// it, and `None` if a crossing does not count: it does where the stage has been told to move,
    /// and its screw pushes it. A stage that stands may slip to and fro over the mark.
    fn way_across(&self, setup: &Setup, now: Time) -> Option<bool> {
        let speed_mm_s = self.setpoint(now)?.speed_mm_s;
        let is_along = speed_mm_s > 0.0;
        let is_pushed = if is_along {
            self.is_pushed_along(setup)
        } else {
            speed_mm_s < 0.0 && self.is_pushed_against(setup)
        };
        (is_pushed && !self.is_place_lost()).then_some(is_along)
    }

    /// Judges the crossing before the last reading. Returns the exposures that are in doubt if it
    /// differs from the crossings before.
    fn cross_index(&mut self, setup: &Setup) -> Option<InDoubt> {
        let latched = self.latched_index.take()?;
        let speed = self.track().speed_at(latched.reading_mm)?;
        let speed_mm_s = speed.speed_mm_s;
        let crossing = Crossing {
            reading_mm: latched.reading_mm,
            speed,
            next_sequence: latched.next_sequence,
        };
        if latched.is_along && speed_mm_s > 0.0 {
            self.cross_along(setup, &crossing)
        } else if !latched.is_along && speed_mm_s < 0.0 {
            self.cross_against(setup, &crossing)
        } else {
            None
        }
    }

    /// Judges a crossing along the FMC axis, which tells of the counts.
    fn cross_along(&mut self, setup: &Setup, crossing: &Crossing) -> Option<InDoubt> {
        let drive = &setup.settings.drive;
        let doubted = self.index.cross(crossing, drive);
        let has_agreed = self.index.is_referenced(drive);
        let agreed = has_agreed.then(|| crossing.passage(drive));
        let is_pair_missed = self.play_watch.cross_along(agreed);
        self.unconfirmed.confirm_counts();
        if !has_agreed {
            self.unconfirmed.confirm_pair();
        }
        let unseen = is_pair_missed.then(|| self.unconfirmed.take_pair());
        doubted.or(unseen.flatten())
    }

    /// Judges a crossing against the FMC axis, which tells of the play, and of counts since the
    /// last crossing along it.
    fn cross_against(&mut self, setup: &Setup, crossing: &Crossing) -> Option<InDoubt> {
        let drive = &setup.settings.drive;
        let sign = setup.settings.direction.sign();
        let is_play_held = is_play_in_error(drive, true, sign);
        let compared = self
            .play_watch
            .cross_against(crossing, drive, is_play_held)?;
        // In a flight against the axis, the way back along it is to confirm the counts before.
        if compared.agrees && sign > 0.0 {
            self.unconfirmed.confirm_counts();
        }
        let from_sequence = self.unconfirmed.confirm_pair()?;
        let range = [from_sequence, crossing.next_sequence.saturating_sub(1)];
        (!compared.is_covered).then(|| InDoubt::between(range, compared.off_mm, false))
    }
}
