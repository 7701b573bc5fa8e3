//! Play between the screw, on which the encoder sits, and the stage.

/// Part of the play by which it may differ from its setting: wear, temperature and load, as σ.
pub(crate) const PLAY_SIGMA_PART: f32 = 0.1;

/// Distance by which a screw may go beyond its readings where it turns round, in parts of the
/// difference of the moves before and after: twice that of a turn at constant acceleration, since
/// the motor's force changes from round to round.
pub(crate) const TURNING_PART: f32 = 0.25;

/// σ of a place that is evenly distributed, in parts of the length: 1/√12.
const EVEN_PART: f32 = 0.288_675_13;

/// Offset of the stage from its screw, which the encoder does not see, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlayOffset {
    /// Most probable offset of the stage from the screw, mm along the FMC axis.
    pub(crate) offset_mm: f32,
    /// σ of that offset, mm.
    pub(crate) sigma_mm: f32,
}

/// The offsets of the stage from the screw that its motion so far leaves possible.
///
/// # Model
/// The play operator: a screw that moves along the FMC axis by d pushes the stage once it has taken
/// up the play, so the offset b of the stage, between 0 and the play p, becomes
/// `b' = min(max(b - d, 0), p)` (Visintin, Differential Models of Hysteresis, 1994, section III.2).
/// Both ends of the interval of possible offsets move so. b = 0 while the screw pushes along the
/// axis, which is how the encoder's zero is set; b = p while it pushes against the axis.
///
/// The encoder is read now and then: where the screw turns round between two readings, it may have
/// gone on by up to [`TURNING_PART`] of the difference of the two moves before it turned, which the
/// readings do not show. One end of the interval moves as if it had. A screw that one of the two
/// moves leaves where it was may have turned round, too.
///
/// Without force, vibration may move the stage from one flank to the other: both ends of the play
/// are possible. An interval from lo to hi counts as two points then, the flanks on which friction
/// keeps the stage: h, its part of σ, is (hi - lo)/2. Once a flank has pushed the stage, an
/// interval comes of turns alone, and the stage may be anywhere in it: h is (hi - lo)/√12. A third
/// offset, w, moves as hi does with a play that is larger by [`PLAY_SIGMA_PART`]: it differs from
/// hi as long as the stage is where the far flank has left it. Mean (lo + hi)/2,
/// `σ² = h² + (w - hi)²`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Play {
    /// Least and largest possible offset, mm.
    low_mm: f32,
    high_mm: f32,
    /// Largest possible offset if the play is larger, mm.
    worn_mm: f32,
    /// Last move of the screw, mm.
    moved_mm: f32,
    /// A flank has pushed the stage.
    is_followed: bool,
}

impl Play {
    /// The stage may be anywhere within the play.
    pub(crate) const UNKNOWN: Self = Self {
        low_mm: 0.0,
        high_mm: f32::INFINITY,
        worn_mm: f32::INFINITY,
        moved_mm: 0.0,
        is_followed: false,
    };

    /// Returns the play after the screw has moved along the FMC axis by so much, mm.
    pub(crate) fn after(self, moved_mm: f32, play_mm: f32) -> Self {
        let worn_mm = (1.0 + PLAY_SIGMA_PART) * play_mm;
        let low_mm = taken_up(self.low_mm, moved_mm, play_mm);
        let high_mm = taken_up(self.high_mm, moved_mm, play_mm);
        let seen = Self {
            low_mm,
            high_mm,
            worn_mm: taken_up(self.worn_mm, moved_mm, worn_mm),
            moved_mm,
            is_followed: self.is_followed || low_mm >= high_mm,
        };
        if moved_mm * self.moved_mm > 0.0 {
            return seen;
        }
        let unseen_mm = TURNING_PART * (self.moved_mm - moved_mm);
        let turned = |offset_mm: f32, play_mm: f32| {
            let at_turn_mm = taken_up(offset_mm, unseen_mm, play_mm);
            taken_up(at_turn_mm, moved_mm - unseen_mm, play_mm)
        };
        Self {
            low_mm: seen.low_mm.min(turned(self.low_mm, play_mm)),
            high_mm: seen.high_mm.max(turned(self.high_mm, play_mm)),
            worn_mm: seen.worn_mm.max(turned(self.worn_mm, worn_mm)),
            ..seen
        }
    }

    /// Returns `true` if the screw pushes the stage along the FMC axis, but for what it may have
    /// gone back by where a reading has not moved by a step of the encoder, mm.
    pub(crate) fn is_taken_up(&self, step_mm: f32) -> bool {
        self.high_mm <= TURNING_PART * step_mm
    }

    /// Returns `true` if the screw pushes the stage against the FMC axis, with a play, mm, but for
    /// the same.
    pub(crate) fn is_taken_up_against(&self, play_mm: f32, step_mm: f32) -> bool {
        self.low_mm >= play_mm - TURNING_PART * step_mm
    }

    /// Returns the offset of the stage from its screw.
    pub(crate) fn offset(&self, play_mm: f32) -> PlayOffset {
        let (low_mm, high_mm) = (self.low_mm.min(play_mm), self.high_mm.min(play_mm));
        let part = if self.is_followed { EVEN_PART } else { 0.5 };
        let (offset_mm, of_interval_mm) = (0.5 * (low_mm + high_mm), part * (high_mm - low_mm));
        let of_play_mm = self.worn_mm.min((1.0 + PLAY_SIGMA_PART) * play_mm) - high_mm;
        PlayOffset {
            offset_mm,
            sigma_mm: fmc_camera_kernel::sqrt(
                of_interval_mm * of_interval_mm + of_play_mm * of_play_mm,
            ),
        }
    }
}

/// Returns the offset of a stage after its screw has moved, mm.
fn taken_up(offset_mm: f32, moved_mm: f32, play_mm: f32) -> f32 {
    (offset_mm.min(play_mm) - moved_mm).max(0.0).min(play_mm)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAY_MM: f32 = 0.02;
    const STEP_MM: f32 = 0.005;
    /// Moves before and after a turn that hardly goes beyond them.
    const SLOW_MM: f32 = 2e-5;
    const NONE: PlayOffset = PlayOffset {
        offset_mm: 0.0,
        sigma_mm: 0.0,
    };

    fn after(moves_mm: &[f32]) -> PlayOffset {
        let mut play = Play::UNKNOWN;
        for moved_mm in moves_mm {
            play = play.after(*moved_mm, PLAY_MM);
        }
        play.offset(PLAY_MM)
    }

    #[test]
    fn stage_is_on_its_flank_once_the_play_is_taken_up() {
        assert_eq!(after(&[0.03]), NONE);
        let is_pushed = |play: Play| {
            let against = play.is_taken_up_against(PLAY_MM, STEP_MM);
            (play.is_taken_up(STEP_MM), against)
        };
        let along = Play::UNKNOWN.after(0.03, PLAY_MM);
        assert_eq!(is_pushed(along), (true, false));
        let against = along.after(-0.03, PLAY_MM);
        assert_eq!(is_pushed(against), (false, true));
        assert_eq!(is_pushed(Play::UNKNOWN), (false, false));
        // A screw that is slower than a step in a round is read where it was now and then.
        for (mut slow, sign, pushed) in
            [(along, 1.0, (true, false)), (against, -1.0, (false, true))]
        {
            for moved_mm in [STEP_MM, 0.0, STEP_MM, STEP_MM, 0.0, 0.0, STEP_MM] {
                slow = slow.after(sign * moved_mm, PLAY_MM);
                assert_eq!(is_pushed(slow), pushed);
            }
        }
        // One that has come to a halt by more than that may have turned round.
        let halted = along.after(4.0 * STEP_MM, PLAY_MM).after(0.0, PLAY_MM);
        assert_eq!(is_pushed(halted), (false, false));
        assert!(after(&[-0.03, 0.0, 0.01, 0.01]).offset_mm < 1e-8);
        let against = after(&[0.5, 0.0, -0.03]);
        assert!((against.offset_mm - PLAY_MM).abs() < 1e-8);
        assert!((against.sigma_mm - PLAY_SIGMA_PART * PLAY_MM).abs() < 1e-8);
    }

    #[test]
    fn half_taken_up_play_is_half_known() {
        // Until a flank has pushed it, the stage is on one or the other.
        let unknown = after(&[]);
        assert!((unknown.offset_mm - 0.5 * PLAY_MM).abs() < 1e-8);
        assert!((0.5..0.51).contains(&(unknown.sigma_mm / PLAY_MM)));
        // From a known flank the way back tells the offset, too, but for where the screw turned.
        let on_the_way = after(&[0.5, SLOW_MM, -SLOW_MM, -0.005]);
        assert!((on_the_way.offset_mm - 0.005).abs() < 2.0 * SLOW_MM);
        assert!(on_the_way.sigma_mm < SLOW_MM);
        let half = after(&[-0.5, 0.5, -0.5, -SLOW_MM, SLOW_MM, 0.012]);
        assert!((half.offset_mm - 0.008).abs() < 2.0 * SLOW_MM);
        // The far flank is where a play that may be larger has left it.
        assert!((half.sigma_mm - PLAY_SIGMA_PART * PLAY_MM).abs() < SLOW_MM);
        let from_nowhere = after(&[0.012]);
        assert!((from_nowhere.offset_mm - 0.004).abs() < 1e-7);
        assert!((0.22..0.23).contains(&(from_nowhere.sigma_mm / PLAY_MM)));
    }

    #[test]
    fn screw_that_turns_round_between_readings_may_have_gone_on() {
        let before = after(&[0.05, 0.004]);
        assert_eq!(before, NONE);
        // 4 µm on and 4 µm back: the stage may have been pushed 2 µm beyond the readings.
        let turned = after(&[0.05, 0.004, -0.004]);
        assert!((turned.offset_mm - 0.005).abs() < 1e-7, "{turned:?}");
        let even_mm = |length_mm: f32| length_mm / libm::sqrtf(12.0);
        assert!(
            (turned.sigma_mm - even_mm(0.002)).abs() < 1e-7,
            "{turned:?}"
        );
        // 4 µm on and none: 1 µm on and back between the two last readings.
        let stopped = after(&[0.05, 0.004, 0.0]);
        assert!((stopped.offset_mm - 0.0005).abs() < 1e-7, "{stopped:?}");
        assert!((stopped.sigma_mm - even_mm(0.001)).abs() < 1e-7);
        // Within the play a turn pushes nothing.
        let within = after(&[0.05, SLOW_MM, -SLOW_MM, -0.004, -0.004, 0.001]);
        assert!((within.offset_mm - 0.007).abs() < 2.0 * SLOW_MM);
        assert!(within.sigma_mm < SLOW_MM, "{within:?}");
        // Contact ends the doubt.
        assert!(after(&[0.05, 0.004, -0.004, 0.02]).sigma_mm < 1e-7);
    }

    #[test]
    fn without_play_there_is_no_offset() {
        assert_eq!(Play::UNKNOWN.after(-1.0, 0.0).offset(0.0), NONE);
        assert_eq!(Play::UNKNOWN.offset(0.0), NONE);
    }
}
