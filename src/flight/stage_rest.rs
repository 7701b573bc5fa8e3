//! Rest of the stage: what a step of its reading may be there, and how far the reading has gone.

use super::controller::timing::{REMEMBERED_ROUNDS, SETTLED_ROUNDS, TICK_S};
use super::drive::velocity_loop::REST_SPEED_MM_S;
use super::stage::Setpoint;
use super::stage_tolerance::StageTolerance;

/// Rounds after one in which the stage has stood, within which its screw may come to push it: in
/// the first the screw comes late, in the second the stage has its speed.
const CONTACT_ROUNDS: u8 = 2;

/// Rest of the stage under force.
///
/// # Model
/// The stage rests where set point and reading do as the velocity loop has it, which then gives no
/// duty. A screw that nothing drives slows down, so after k rounds at rest it comes to a stage with
/// the encoder on it at less than 1/k of the play in a round: that and `jump_mm` bound a step. A
/// screw that is driven on at speed, or faster, comes to a stage that has stood and to no other:
/// any other it pushes. One that slows down may lose the stage, and meet it again.
///
/// A stage that has stood for [`REMEMBERED_ROUNDS`] stays where it is: what its reading goes
/// farther than by a step of the encoder is counts that may be wrong, until the stage has moved and
/// rests again. It is σ of the exposures until then.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct StageRest {
    /// Readings since set point and stage rest.
    rounds: u8,
    /// Readings since the stage has stood, as the reading before it shows.
    moving: u8,
    /// Reading at the remembered place, mm.
    place_mm: f32,
    /// Largest distance of a reading from it, beyond a step of the encoder, and largest step in
    /// doubt since, mm.
    off_mm: f32,
    /// The set point has moved since the place was remembered.
    has_left: bool,
}

/// A reading that is trusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TrustedReading {
    pub(crate) offset_mm: f32,
    /// Way from the reading before, mm.
    pub(crate) moved_mm: f32,
    /// Reading less set point, mm.
    pub(crate) error_mm: f32,
    /// Pace of the set point.
    pub(crate) pace: Pace,
}

/// Pace of the stage's set point since the reading before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    /// It rests.
    Rest,
    /// It goes on at its speed or faster.
    DrivenOn,
    /// It slows down, or there is none.
    Slowing,
}

impl Pace {
    /// Returns the pace of a set point that has moved since the reading before by so much, mm.
    pub(crate) fn of(setpoint: Option<Setpoint>, moved_mm: f32) -> Self {
        let Some(setpoint) = setpoint else {
            return Self::Slowing;
        };
        let has_moved = libm::fabsf(moved_mm) > 0.0;
        let faster = setpoint.speed_mm_s * setpoint.acceleration_mm_s2;
        if !has_moved && setpoint.is_at_rest() {
            Self::Rest
        } else if libm::fabsf(setpoint.speed_mm_s) > 0.0 && faster >= 0.0 {
            Self::DrivenOn
        } else {
            Self::Slowing
        }
    }
}

impl StageRest {
    /// Returns a stage of which nothing is known.
    pub(crate) const fn new() -> Self {
        Self {
            rounds: 0,
            moving: 0,
            place_mm: 0.0,
            off_mm: 0.0,
            has_left: false,
        }
    }

    /// Returns the largest step of the next reading that neither the step before nor the one after
    /// shares, mm.
    pub(crate) fn isolated_mm(&self, pace: Pace, tolerance: &StageTolerance) -> f32 {
        match pace {
            Pace::Rest if self.rounds >= SETTLED_ROUNDS => {
                tolerance.jump_mm + tolerance.play_mm / f32::from(self.rounds)
            }
            Pace::DrivenOn if self.moving >= CONTACT_ROUNDS => tolerance.isolated_mm,
            _ => tolerance.isolated_mm + tolerance.contact_mm,
        }
    }

    /// Notes a reading.
    pub(crate) fn note(&mut self, reading: &TrustedReading, tolerance: &StageTolerance) {
        let moved_mm = libm::fabsf(reading.moved_mm);
        self.moving = if moved_mm <= tolerance.jump_mm {
            0
        } else {
            self.moving.saturating_add(1)
        };
        let error_mm = libm::fabsf(reading.error_mm);
        let band_mm = tolerance.rest_band_mm;
        let is_told_to_rest = reading.pace == Pace::Rest;
        self.has_left |= !is_told_to_rest;
        let rests = is_told_to_rest
            && if self.rounds > 0 {
                error_mm <= 2.0 * band_mm
            } else {
                error_mm <= band_mm && moved_mm <= REST_SPEED_MM_S * TICK_S
            };
        if is_told_to_rest && self.rounds >= REMEMBERED_ROUNDS {
            let gone_mm = libm::fabsf(reading.offset_mm - self.place_mm);
            self.off_mm = self.off_mm.max(gone_mm - tolerance.step_mm);
        }
        self.rounds = if rests {
            self.rounds.saturating_add(1)
        } else {
            0
        };
        if self.rounds == REMEMBERED_ROUNDS {
            self.place_mm = reading.offset_mm;
            if core::mem::replace(&mut self.has_left, false) {
                self.off_mm = 0.0;
            }
        }
    }

    /// Notes a step of the reading that may be counts, mm.
    pub(crate) const fn doubt(&mut self, step_mm: f32) {
        self.off_mm = self.off_mm.max(step_mm);
    }

    /// Returns how far the reading has gone from the place at which the stage stood last, beyond a
    /// step of the encoder, or the largest step in doubt since, mm.
    pub(crate) const fn off_mm(&self) -> f32 {
        self.off_mm
    }
}

#[cfg(test)]
mod tests {
    use super::Pace::{DrivenOn, Rest, Slowing};
    use super::*;

    /// An encoder of 0.056 µm on a stage with 15.2 µm of play.
    const TOLERANCE: StageTolerance = StageTolerance {
        following_mm: 0.03,
        jump_mm: 0.001,
        slip_mm: 0.017,
        isolated_mm: 0.0015,
        undoubted_mm: 0.001,
        contact_mm: 0.0038,
        play_mm: 0.0152,
        rest_band_mm: 0.002,
        step_mm: 0.000_056,
    };

    fn reading(offset_mm: f32, moved_mm: f32, pace: Pace) -> TrustedReading {
        TrustedReading {
            offset_mm,
            moved_mm,
            error_mm: if pace == Pace::Rest { offset_mm } else { 0.0 },
            pace,
        }
    }

    fn rested(rounds: u8) -> StageRest {
        let mut rest = StageRest::new();
        rest.note(&reading(0.0, 0.005, DrivenOn), &TOLERANCE);
        for _ in 0..rounds {
            rest.note(&reading(0.0, 0.0, Rest), &TOLERANCE);
        }
        rest
    }

    #[test]
    fn step_of_a_stage_at_rest_is_bounded_by_what_is_left_of_the_screw_s_speed() {
        let bound_um = |rest: &StageRest| 1e3 * rest.isolated_mm(Rest, &TOLERANCE);
        assert!((bound_um(&rested(3)) - 5.3).abs() < 1e-3);
        // By hand: 1 µm and 15.2 µm in 4, in 10 and in 152 rounds.
        for (rounds, expected_um) in [(4, 4.8), (10, 2.52), (152, 1.1)] {
            let found_um = bound_um(&rested(rounds));
            assert!(
                (found_um - expected_um).abs() < 1e-3,
                "{rounds}: {found_um}"
            );
        }
        // A set point that moves has the stage pushed.
        assert!((rested(152).isolated_mm(DrivenOn, &TOLERANCE) - 0.0053).abs() < 1e-6);
    }

    #[test]
    fn pace_is_that_of_the_set_point() {
        let of = |speed_mm_s, acceleration_mm_s2| {
            Some(Setpoint {
                offset_mm: 1.0,
                speed_mm_s,
                acceleration_mm_s2,
            })
        };
        assert_eq!(Pace::of(of(0.0, 0.0), 0.0), Rest);
        assert_eq!(Pace::of(of(0.0, 0.0), 0.001), Slowing);
        assert_eq!(Pace::of(of(-5.0, -500.0), -0.005), DrivenOn);
        assert_eq!(Pace::of(of(5.0, 0.0), 0.005), DrivenOn);
        assert_eq!(Pace::of(of(5.0, -500.0), 0.005), Slowing);
        assert_eq!(Pace::of(None, 0.0), Slowing);
    }

    #[test]
    fn screw_comes_to_a_stage_that_has_stood_and_to_no_other() {
        let mut rest = rested(10);
        let mut bounds = std::vec::Vec::new();
        for offset_mm in [0.0, 0.005, 0.01, 0.015] {
            let moved_mm = if offset_mm > 0.0 { 0.005 } else { 0.0 };
            rest.note(&reading(offset_mm, moved_mm, DrivenOn), &TOLERANCE);
            bounds.push(rest.isolated_mm(DrivenOn, &TOLERANCE) > TOLERANCE.isolated_mm);
        }
        assert_eq!(bounds, [true, true, false, false]);
        // A stage that runs on while its screw slows down meets the other flank.
        assert!((rest.isolated_mm(Slowing, &TOLERANCE) - 0.0053).abs() < 1e-6);
    }

    #[test]
    fn reading_that_leaves_the_place_of_a_standing_stage_is_doubted_until_the_stage_rests_again() {
        let mut rest = rested(REMEMBERED_ROUNDS);
        // A step of the encoder to either side is no motion.
        for offset_mm in [0.000_056, 0.0, -0.000_056] {
            rest.note(&reading(offset_mm, 0.000_056, Rest), &TOLERANCE);
            assert!(rest.off_mm() <= 1e-9, "{}", rest.off_mm());
        }
        rest.note(&reading(-0.0008, 0.0008, Rest), &TOLERANCE);
        let off_um = |rest: &StageRest| 1e3 * rest.off_mm();
        assert!((off_um(&rest) - 0.744).abs() < 1e-3, "{}", rest.off_mm());
        // In the frame, and on the way back from it.
        for round in 0..100_u8 {
            rest.note(
                &reading(0.005 * f32::from(round), 0.005, DrivenOn),
                &TOLERANCE,
            );
        }
        assert!((off_um(&rest) - 0.744).abs() < 1e-3, "{}", rest.off_mm());
        for round in 1..=REMEMBERED_ROUNDS {
            rest.note(&reading(0.0, 0.0, Rest), &TOLERANCE);
            assert_eq!(rest.off_mm() > 0.0, round < REMEMBERED_ROUNDS);
        }
    }

    #[test]
    fn stage_that_is_moved_back_to_a_set_point_at_rest_stays_in_doubt() {
        let mut rest = rested(REMEMBERED_ROUNDS);
        rest.note(&reading(0.0011, 0.0011, Rest), &TOLERANCE);
        rest.note(&reading(0.0045, 0.001, Rest), &TOLERANCE);
        for _ in 0..2 * REMEMBERED_ROUNDS {
            rest.note(&reading(0.0001, 0.0, Rest), &TOLERANCE);
        }
        assert!(rest.off_mm() > 0.001, "{}", rest.off_mm());
    }
}
