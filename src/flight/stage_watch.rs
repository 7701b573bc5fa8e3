//! The stage's watch: it compares readings with set points, and finds faults of stage and encoder.

use super::controller::timing::LATE_TICK_S;
use super::drive::StageReading;
use super::fault::Fault;
use super::stage::Setpoint;
use super::stage_rest::{Pace, StageRest, TrustedReading};
use super::stage_tolerance::{ACCELERATING, MADE_GOOD, StageTolerance};

/// Verdict on a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ReadingVerdict {
    /// The stage follows.
    Follows,
    /// The reading is far from where the stage can be; the next one decides.
    Suspicious,
    /// The last reading was wrong, this one is right.
    Glitch,
    /// A fault was found.
    Fault(Fault),
}

/// Compares readings with set points.
///
/// # Model
/// A reading whose step from the last differs from its set point's by more than `jump_mm` is
/// suspicious, and so is one that differs by more than `isolated_mm` from both the set point's step
/// and the step before. With the next it turns out to be
/// - a glitch, where that one steps back by as much;
/// - lost or added counts, [`Fault::Encoder`], where that one follows again from the new place;
/// - motion of the stage otherwise.
///
/// A stage is a mass: what moves it in one round moves it in the next, too, unless a force stops
/// it. The accelerations that motor, friction and contact with the screw give it bound a step that
/// stands alone between two rounds, whatever the play that lets the stage leave its set point;
/// [`StageRest`] tells where a screw may come to push it. A step within that bound whose part that
/// stands alone is more than `undoubted_mm` may be either: it is σ of the exposures until the stage
/// rests again ([`StageWatch::off_mm`]).
///
/// Motion is at fault if it is off its set point by more than `following_mm`: if the stage should
/// move, [`Fault::WrongDirection`] if it moves the other way, [`Fault::Runaway`] if it is ahead,
/// else [`Fault::Stall`]; if it should stand, [`Fault::Runaway`] if it moves, else
/// [`Fault::Stall`], since it has not arrived. A released stage may move anywhere without a fault.
///
/// Counts lost or added in a step of up to [`StageTolerance::unseen_mm`] may stay undetected, until
/// the stage crosses its index mark ([`IndexWatch`](super::index_watch::IndexWatch)).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct StageWatch {
    /// The last reading, and where the stage should have been, mm; released, 0.
    last: Option<(StageReading, f32)>,
    /// Step of the last reading beyond its set point's, mm, if it came a round after the one
    /// before.
    step_mm: Option<f32>,
    /// The step before it, if both were motion.
    earlier_mm: Option<f32>,
    suspicion: Option<Suspicion>,
    rest: StageRest,
}

/// A step on which the next one decides.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Suspicion {
    /// Its size, mm.
    step_mm: f32,
    /// Largest next step in the same direction after which the stage counts as following again
    /// from a new place, mm.
    follows_mm: f32,
}

impl StageWatch {
    /// Returns a watch without readings.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self {
            last: None,
            step_mm: None,
            earlier_mm: None,
            suspicion: None,
            rest: StageRest::new(),
        }
    }

    /// Returns how far the reading has gone while the stage stood, before its last motion or now,
    /// and the largest step since that may be counts as well as motion, mm: as far its place may be
    /// wrong.
    pub(crate) const fn off_mm(&self) -> f32 {
        self.rest.off_mm()
    }

    /// Judges a reading against the set point of its time. A released stage has no set point
    /// (`None`) and may move, but its encoder must not jump.
    pub(crate) fn look(
        &mut self,
        reading: StageReading,
        setpoint: Option<Setpoint>,
        tolerance: &StageTolerance,
    ) -> ReadingVerdict {
        if !reading.offset_mm.is_finite() {
            return ReadingVerdict::Fault(Fault::Encoder);
        }
        let told_mm = setpoint.map_or(0.0, |setpoint| setpoint.offset_mm);
        let Some((last, last_told_mm)) = self.last.replace((reading, told_mm)) else {
            return verdict_of_motion(reading, setpoint, 0.0, tolerance);
        };
        let moved_mm = reading.offset_mm - last.offset_mm;
        let told_step_mm = told_mm - last_told_mm;
        let step_mm = moved_mm - told_step_mm;
        let is_next = reading.time.seconds_since(last.time) <= LATE_TICK_S;
        let before_mm = core::mem::replace(&mut self.step_mm, is_next.then_some(step_mm))
            .filter(|_| is_next && setpoint.is_some());
        let pace = Pace::of(setpoint, told_step_mm);
        let step = Step {
            step_mm,
            before_mm,
            jump_mm: jump_mm(setpoint, tolerance),
            isolated_mm: self.rest.isolated_mm(pace, tolerance),
        };
        let verdict = match self.verdict_of_step(&step) {
            Some(verdict) => verdict,
            None => verdict_of_motion(reading, setpoint, moved_mm, tolerance),
        };
        let earlier_mm = self.earlier_mm.take();
        if verdict == ReadingVerdict::Follows {
            if let (Some(earlier_mm), Some(before_mm)) = (earlier_mm, before_mm) {
                let alone_mm = alone_mm(before_mm, earlier_mm, step_mm);
                if alone_mm > tolerance.undoubted_mm {
                    self.rest.doubt(alone_mm);
                }
            }
            self.earlier_mm = before_mm;
        }
        if verdict != ReadingVerdict::Suspicious {
            let trusted = TrustedReading {
                offset_mm: reading.offset_mm,
                moved_mm,
                error_mm: reading.offset_mm - told_mm,
                pace,
            };
            self.rest.note(&trusted, tolerance);
        }
        verdict
    }

    /// Judges a step by those before it; `None` if it is motion of the stage.
    fn verdict_of_step(&mut self, step: &Step) -> Option<ReadingVerdict> {
        let step_mm = step.step_mm;
        let Some(suspicion) = self.suspicion.take() else {
            self.suspicion = step.follows_mm().map(|follows_mm| Suspicion {
                step_mm,
                follows_mm,
            });
            return self.suspicion.map(|_| ReadingVerdict::Suspicious);
        };
        let size_mm = libm::fabsf(suspicion.step_mm);
        if libm::fabsf(suspicion.step_mm + step_mm) <= step.jump_mm.min(MADE_GOOD * size_mm) {
            return Some(ReadingVerdict::Glitch);
        }
        let is_lost =
            libm::fabsf(step_mm) <= suspicion.follows_mm || step_mm * suspicion.step_mm < 0.0;
        is_lost.then_some(ReadingVerdict::Fault(Fault::Encoder))
    }
}

/// Returns the largest step beyond its set point's that may be motion of the stage, mm.
fn jump_mm(setpoint: Option<Setpoint>, tolerance: &StageTolerance) -> f32 {
    let is_steady = setpoint.is_some_and(|setpoint| setpoint.acceleration_mm_s2 == 0.0);
    tolerance.slip_mm + tolerance.jump_mm * if is_steady { 1.0 } else { ACCELERATING }
}

/// A step of the stage beyond that of its set point, and what bounds it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    step_mm: f32,
    /// The step before, mm, if it came a round before.
    before_mm: Option<f32>,
    /// Largest step that may be motion, mm.
    jump_mm: f32,
    /// Largest step that stands alone, mm.
    isolated_mm: f32,
}

impl Step {
    /// Returns the largest next step in the same direction after which counts have been lost or
    /// added, mm; `None` if the step is not suspicious.
    fn follows_mm(&self) -> Option<f32> {
        let size_mm = libm::fabsf(self.step_mm);
        let made_good_mm = MADE_GOOD * size_mm;
        if size_mm > self.jump_mm {
            return Some(made_good_mm);
        }
        let alone_mm = alone_mm(self.step_mm, self.before_mm?, 0.0);
        (alone_mm > self.isolated_mm).then_some(made_good_mm.min(size_mm - self.isolated_mm))
    }
}

/// Returns the part of a step, mm, that neither the one before nor the one after shares.
fn alone_mm(step_mm: f32, before_mm: f32, after_mm: f32) -> f32 {
    let sign = libm::copysignf(1.0, step_mm);
    libm::fabsf(step_mm) - (sign * before_mm).max(sign * after_mm).max(0.0)
}

/// Judges the position of the stage, and its motion since the last reading.
fn verdict_of_motion(
    reading: StageReading,
    setpoint: Option<Setpoint>,
    moved_mm: f32,
    tolerance: &StageTolerance,
) -> ReadingVerdict {
    let Some(setpoint) = setpoint else {
        return ReadingVerdict::Follows;
    };
    let error_mm = reading.offset_mm - setpoint.offset_mm;
    if libm::fabsf(error_mm) <= tolerance.following_mm {
        return ReadingVerdict::Follows;
    }
    let speed = setpoint.speed_mm_s;
    let is_moving = libm::fabsf(moved_mm) > 0.5 * tolerance.jump_mm;
    ReadingVerdict::Fault(if speed == 0.0 {
        if is_moving {
            Fault::Runaway
        } else {
            Fault::Stall
        }
    } else if is_moving && moved_mm * speed < 0.0 {
        Fault::WrongDirection
    } else if error_mm * speed > 0.0 {
        Fault::Runaway
    } else {
        Fault::Stall
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::time::Time;

    const TOLERANCE: StageTolerance = StageTolerance {
        following_mm: 0.008,
        jump_mm: 0.001,
        slip_mm: 0.0,
        isolated_mm: 0.001,
        undoubted_mm: 0.001,
        contact_mm: 0.0,
        play_mm: 0.0,
        rest_band_mm: 0.002,
        step_mm: 0.0001,
    };
    const SPEED_MM_S: f32 = 5.0;

    /// Findings over readings at 1 kHz, the set point at constant speed from 0.
    fn verdicts(readings: impl Iterator<Item = f32>) -> std::vec::Vec<ReadingVerdict> {
        let mut watch = StageWatch::new();
        let mut time = Time::START;
        readings
            .map(|offset_mm| {
                let setpoint = Setpoint {
                    offset_mm: SPEED_MM_S * time.seconds_since(Time::START),
                    speed_mm_s: SPEED_MM_S,
                    acceleration_mm_s2: 0.0,
                };
                let verdict =
                    watch.look(StageReading { time, offset_mm }, Some(setpoint), &TOLERANCE);
                time = time.plus_s(1e-3);
                verdict
            })
            .collect()
    }

    fn steady() -> impl Iterator<Item = f32> {
        (0..20_u8).map(|tick| 1e-3 * SPEED_MM_S * f32::from(tick))
    }

    fn first_fault(verdicts: &[ReadingVerdict]) -> Option<(usize, Fault)> {
        verdicts
            .iter()
            .enumerate()
            .find_map(|(tick, verdict)| match verdict {
                ReadingVerdict::Fault(fault) => Some((tick, *fault)),
                _ => None,
            })
    }

    #[test]
    fn steady_motion_follows() {
        assert!(
            verdicts(steady())
                .iter()
                .all(|it| *it == ReadingVerdict::Follows)
        );
    }

    #[test]
    fn stall_is_seen_within_three_readings() {
        let stalled = steady().map(|offset_mm| offset_mm.min(0.05));
        assert_eq!(first_fault(&verdicts(stalled)), Some((12, Fault::Stall)));
    }

    #[test]
    fn motion_against_the_command_and_ahead_of_it_have_their_names() {
        let wrong = steady().map(|offset_mm| -offset_mm);
        assert_eq!(
            first_fault(&verdicts(wrong)).unwrap().1,
            Fault::WrongDirection
        );
        let ahead = steady().map(|offset_mm| 3.0 * offset_mm);
        assert_eq!(first_fault(&verdicts(ahead)).unwrap().1, Fault::Runaway);
    }

    #[test]
    fn released_stage_may_go_anywhere_but_not_at_once() {
        let mut watch = StageWatch::new();
        let mut look = |us, offset_mm| {
            let time = Time::from_us(us);
            watch.look(StageReading { time, offset_mm }, None, &TOLERANCE)
        };
        for tick in 0..1000_u16 {
            let found = look(1000 * u64::from(tick), 0.003 * f32::from(tick));
            assert_eq!(found, ReadingVerdict::Follows);
        }
        assert_eq!(look(1_000_000, 3.5), ReadingVerdict::Suspicious);
        assert_eq!(look(1_001_000, 3.0), ReadingVerdict::Glitch);
        assert_eq!(look(1_002_000, 3.5), ReadingVerdict::Suspicious);
        assert_eq!(look(1_003_000, 3.5), ReadingVerdict::Fault(Fault::Encoder));
    }

    #[test]
    fn one_wrong_reading_is_a_glitch_and_lost_counts_are_a_fault() {
        let glitch = steady()
            .enumerate()
            .map(|(tick, offset_mm)| offset_mm + if tick == 9 { 0.5 } else { 0.0 });
        let found = verdicts(glitch);
        assert_eq!(found[9], ReadingVerdict::Suspicious);
        assert_eq!(found[10], ReadingVerdict::Glitch);
        assert_eq!(first_fault(&found), None);
        let lost = steady()
            .enumerate()
            .map(|(tick, offset_mm)| offset_mm - if tick >= 9 { 0.003 } else { 0.0 });
        assert_eq!(first_fault(&verdicts(lost)), Some((10, Fault::Encoder)));
        let not_a_number = steady().map(|_| f32::NAN);
        assert_eq!(
            first_fault(&verdicts(not_a_number)),
            Some((0, Fault::Encoder))
        );
    }

    /// Tolerances of a stage with the encoder on it and 10.8 µm of play, at up to 546 mm/s².
    const WITH_PLAY: StageTolerance = StageTolerance {
        following_mm: 0.0215,
        jump_mm: 0.001,
        slip_mm: 0.0144,
        isolated_mm: 0.0028,
        undoubted_mm: 0.001,
        contact_mm: 0.0027,
        play_mm: 0.0108,
        rest_band_mm: 0.002,
        step_mm: 0.0001,
    };

    /// First fault of a stage at 5 mm/s from the steps of its reading beyond that, µm.
    fn fault_of_steps(acceleration_mm_s2: f32, steps_um: &[f32]) -> Option<(usize, Fault)> {
        let mut watch = StageWatch::new();
        let mut found = std::vec::Vec::new();
        let mut offset_mm = 0.0;
        for (tick, step_um) in (0_u8..).zip(steps_um) {
            let setpoint = Setpoint {
                offset_mm: 1e-3 * SPEED_MM_S * f32::from(tick),
                speed_mm_s: SPEED_MM_S,
                acceleration_mm_s2,
            };
            offset_mm += 1e-3 * (step_um + if tick > 0 { SPEED_MM_S } else { 0.0 });
            let time = Time::from_us(1000 * u64::from(tick));
            let reading = StageReading { time, offset_mm };
            found.push(watch.look(reading, Some(setpoint), &WITH_PLAY));
        }
        first_fault(&found)
    }

    #[test]
    fn step_that_stands_alone_is_no_motion_however_large_the_play() {
        for sign in [1.0, -1.0] {
            let fault_of = |acceleration_mm_s2, steps_um: [f32; 6]| {
                fault_of_steps(acceleration_mm_s2, &steps_um.map(|it| sign * it))
            };
            let counts_lost = Some((4, Fault::Encoder));
            let (slowing, faster) = (-546.0, 546.0);
            // The drive takes a tenth of it back in the next round.
            for pace in [slowing, faster] {
                assert_eq!(
                    fault_of(pace, [0.0, 0.1, -0.1, 14.8, -1.8, -1.8]),
                    counts_lost
                );
            }
            assert_eq!(
                fault_of(slowing, [0.0, 0.1, -0.1, 5.7, 0.1, -0.5]),
                counts_lost
            );
            assert_eq!(fault_of(slowing, [0.0, 0.1, -0.1, 5.3, -0.5, -0.5]), None);
            // A stage that is pushed on leaves its screw nowhere.
            assert_eq!(
                fault_of(faster, [0.0, 0.1, -0.1, 3.1, 0.1, -0.1]),
                counts_lost
            );
            assert_eq!(fault_of(faster, [0.0, 0.1, -0.1, 2.7, -0.5, -0.5]), None);
            // A step that the rounds beside share is motion: the stage stands in the play, and its
            // screw catches it.
            for steps_um in [
                [0.0, -5.0, -5.0, 4.0, 6.0, 3.0],
                [0.0, 3.0, 6.0, 8.0, 2.0, -1.0],
                [0.0, 0.0, -5.0, -8.0, -3.0, 2.0],
            ] {
                assert_eq!(fault_of(slowing, steps_um), None, "{steps_um:?}");
            }
        }
        // A screw comes to a stage that has stood at 5.2 µm a round beyond the set point's speed.
        let to_one_that_stood = fault_of_steps(546.0, &[0.0, -5.0, -5.0, 5.2, 0.0, 0.0]);
        assert_eq!(to_one_that_stood, None);
        let to_one_that_it_pushes = fault_of_steps(546.0, &[0.0, -1.0, -1.0, 5.2, 0.0, 0.0]);
        assert_eq!(to_one_that_it_pushes, Some((4, Fault::Encoder)));
    }

    #[test]
    fn step_that_friction_allows_but_its_neighbours_do_not_share_is_in_doubt() {
        let doubt_um = |steps_um: [f32; 6]| {
            let mut watch = StageWatch::new();
            let mut offset_mm = 0.0;
            for (round, step_um) in (0_u64..).zip(steps_um) {
                offset_mm += 1e-3 * step_um;
                let time = Time::from_us(1000 * round);
                let moving = Setpoint {
                    speed_mm_s: SPEED_MM_S,
                    ..Setpoint::default()
                };
                let found = watch.look(StageReading { time, offset_mm }, Some(moving), &WITH_PLAY);
                assert!(!matches!(found, ReadingVerdict::Fault(_)), "{steps_um:?}");
            }
            1e3 * watch.off_mm()
        };
        for sign in [1.0, -1.0] {
            // The drive takes a part of it back.
            let alone = doubt_um([0.0, 0.1, 0.1, 2.0, -0.5, -0.5].map(|it| sign * it));
            assert!((alone - 1.9).abs() < 1e-3, "{alone}");
            for motion in [
                [0.0, 0.1, 0.1, 0.9, 0.0, 0.0],
                [0.0, 0.1, 1.2, 2.0, 1.1, 0.2],
                // A reading that is left out.
                [0.0, 0.0, 0.0, 8.0, -8.0, 0.0],
            ] {
                let doubt = doubt_um(motion.map(|it| sign * it));
                assert!(doubt <= 0.0, "{motion:?}: {doubt}");
            }
        }
    }

    /// First fault of a stage whose reading steps by 3.5 µm and stays after so many rounds at rest.
    fn fault_after_rest(rounds: u64) -> Option<Fault> {
        let mut watch = StageWatch::new();
        let readings = (0..rounds + 6).map(|round| {
            let offset_mm = if round > rounds { 0.0035 } else { 0.0 };
            let time = Time::from_us(1000 * round);
            let reading = StageReading { time, offset_mm };
            watch.look(reading, Some(Setpoint::default()), &WITH_PLAY)
        });
        let found: std::vec::Vec<_> = readings.collect();
        first_fault(&found).map(|(_, fault)| fault)
    }

    #[test]
    fn step_of_a_stage_that_has_stood_is_counts_that_are_lost_whatever_the_play() {
        // 1 µm and a part of 10.8 µm of play: its screw may still come.
        assert_eq!(fault_after_rest(3), None);
        assert_eq!(fault_after_rest(10), Some(Fault::Encoder));
        assert_eq!(fault_after_rest(1000), Some(Fault::Encoder));
    }

    #[test]
    fn reading_that_stands_out_alone_is_left_out_within_the_play() {
        let mut watch = StageWatch::new();
        let mut look = |us: u64, offset_mm| {
            let time = Time::from_us(us);
            let rest = Some(Setpoint::default());
            watch.look(StageReading { time, offset_mm }, rest, &WITH_PLAY)
        };
        for round in 0..3 {
            assert_eq!(look(1000 * round, 0.0), ReadingVerdict::Follows);
        }
        assert_eq!(look(3000, 0.008), ReadingVerdict::Suspicious);
        assert_eq!(look(4000, 0.0), ReadingVerdict::Glitch);
        // After a round that was left out, nobody knows what the stage has done in between.
        assert_eq!(look(6000, 0.008), ReadingVerdict::Follows);
    }

    #[test]
    fn stage_off_a_set_point_at_rest_has_stalled_or_runs_away_if_it_moves() {
        let reading = StageReading {
            time: Time::START,
            offset_mm: -0.0081,
        };
        for (moved_mm, fault) in [(0.0005, Fault::Stall), (-0.00051, Fault::Runaway)] {
            let rest = Some(Setpoint::default());
            let found = verdict_of_motion(reading, rest, moved_mm, &TOLERANCE);
            assert_eq!(found, ReadingVerdict::Fault(fault));
        }
    }
}
