//! The machine of the stage: the force on it, its readings, and its faults.

mod exposure_motion;
mod motion;
mod second_look;

pub(super) use self::exposure_motion::ExposureMotion;
use self::motion::Motion;
use super::setup::Setup;
use super::timing::{
    LATE_EVENT_S, LATE_TICK_S, READINGS_CEASE_S, STANDING_S, TICK_S, UNLEARNED_TOLERANCE,
};
use crate::flight::drive::StageReading;
use crate::flight::fault::Fault;
use crate::flight::following_error_rms::FollowingErrorRms;
use crate::flight::index_watch::{IndexWatch, LatchedIndex};
use crate::flight::play::Play;
use crate::flight::play_watch::PlayWatch;
use crate::flight::slope::Slope;
use crate::flight::stage::{Profile, Setpoint};
use crate::flight::stage_track::{PlaceReading, StagePlace, StageTrack};
use crate::flight::stage_watch::{ReadingVerdict, StageWatch};
use crate::flight::time::Time;
use crate::flight::unconfirmed::Unconfirmed;

/// The machine of the stage. The stage is released, waits at the start of a profile, or moves along
/// one; a fault that has not been cleared keeps it released.
#[derive(Debug, Clone)]
pub(super) struct StageMachine {
    /// `None`: no force on the stage.
    motion: Option<Motion>,
    track: StageTrack,
    /// Last reading that was kept, mm.
    read_mm: Option<f32>,
    watch: StageWatch,
    /// Reading on which the next one decides.
    suspicious: Option<(StageReading, Seen)>,
    /// Crossing of the index mark that is not judged yet.
    pub(super) latched_index: Option<LatchedIndex>,
    /// Following error; of a released stage, its position.
    following_slope: Slope,
    play: Play,
    following_error: FollowingErrorRms,
    /// Fault of the stage, until it is cleared; the stage stays released.
    fault: Option<Fault>,
    /// The encoder has lost its place, until the operator has referred it again; of an absolute
    /// sensor, it is not believed until its fault is cleared.
    is_place_lost: bool,
    /// The sensor shows the place of the stage at any time.
    is_absolute: bool,
    /// Time of the last reading, or the time from which readings are awaited.
    last_reading: Time,
    /// Position at which the released stage stands, and the time since when.
    standing_since: Option<(Time, f32)>,
    /// Wrong readings that were left out.
    glitches: u32,
    pub(super) index: IndexWatch,
    pub(super) play_watch: PlayWatch,
    pub(super) unconfirmed: Unconfirmed,
    /// Waiting place, mm, while the stage goes to where its last way there begins.
    pub(super) approached_mm: Option<f32>,
}

/// Degree to which the stage is expected to follow its set point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Obedience {
    /// The stage may be moved by hand, or coast.
    None,
    /// The velocity loop is still learning.
    Unlearned,
    /// The stage follows.
    Full,
}

/// Verdict on a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    pub(super) verdict: ReadingVerdict,
    /// Reading less set point, mm; of a released stage, its position.
    error_mm: f32,
}

impl StageMachine {
    /// Returns a stage without force.
    #[inline]
    pub(super) const fn new(is_place_lost: bool) -> Self {
        Self {
            motion: None,
            track: StageTrack::new(),
            read_mm: None,
            watch: StageWatch::new(),
            suspicious: None,
            latched_index: None,
            following_slope: Slope::new(),
            play: Play::UNKNOWN,
            following_error: FollowingErrorRms::new(),
            fault: if is_place_lost {
                Some(Fault::Encoder)
            } else {
                None
            },
            is_place_lost,
            is_absolute: false,
            last_reading: Time::START,
            standing_since: None,
            glitches: 0,
            index: IndexWatch::new(),
            play_watch: PlayWatch::new(),
            unconfirmed: Unconfirmed::new(),
            approached_mm: None,
        }
    }

    /// Takes an absolute sensor in place of an encoder: it has its place at any start. With `rests`
    /// the stage stays without force until its fault is cleared.
    pub(super) const fn show_place(&mut self, rests: bool) {
        self.is_absolute = true;
        self.is_place_lost = false;
        self.fault = if rests { Some(Fault::Watchdog) } else { None };
    }

    /// Judges a reading that came with an event of a time. Returns `None` if the reading is left
    /// out, or if the next one has to decide.
    ///
    /// If the reading is to be kept, the caller calls [`Self::keep`] after it has acted on the
    /// verdict.
    pub(super) fn look(
        &mut self,
        setup: &Setup,
        obedience: Obedience,
        time: Time,
        reading: StageReading,
    ) -> Option<Seen> {
        if self.is_place_lost || !setup.camera.has_stage() {
            return None;
        }
        let older_s = time.seconds_since(reading.time);
        if !(-TICK_S..=LATE_EVENT_S).contains(&older_s) || reading.time < self.last_reading {
            // The reading is out of date; if no current one comes, the encoder has failed.
            return None;
        }
        let mut tolerance = setup.stage_tolerance();
        match obedience {
            Obedience::None => self.forget_suspicion(),
            Obedience::Unlearned => tolerance.following_mm *= UNLEARNED_TOLERANCE,
            Obedience::Full => {}
        }
        let setpoint = self.setpoint(reading.time);
        let verdict = self.watch.look(reading, setpoint, &tolerance);
        let told_mm = setpoint.map_or(0.0, |setpoint| setpoint.offset_mm);
        let seen = Seen {
            verdict,
            error_mm: reading.offset_mm - told_mm,
        };
        let suspicious = self.suspicious.take();
        match verdict {
            ReadingVerdict::Suspicious => {
                self.suspicious = Some((reading, seen));
                return None;
            }
            ReadingVerdict::Glitch => self.glitches = self.glitches.saturating_add(1),
            ReadingVerdict::Fault(Fault::Encoder) => {}
            ReadingVerdict::Follows | ReadingVerdict::Fault(_) => {
                // The stage has moved so.
                if let Some((reading, seen)) = suspicious {
                    self.keep(setup, reading, seen);
                }
            }
        }
        Some(seen)
    }

    /// Keeps a reading that is trusted.
    pub(super) fn keep(&mut self, setup: &Setup, reading: StageReading, seen: Seen) {
        self.last_reading = reading.time;
        let play_mm = setup.settings.drive.unseen_play_mm();
        self.play = match self.read_mm.replace(reading.offset_mm) {
            Some(last_mm) if self.motion.is_some() => {
                self.play.after(reading.offset_mm - last_mm, play_mm)
            }
            _ => Play::UNKNOWN,
        };
        let play = self.play.offset(play_mm);
        self.track.push(StagePlace {
            time: reading.time,
            offset_mm: reading.offset_mm + play.offset_mm,
            reading: PlaceReading::of_round(play.sigma_mm),
        });
        self.following_slope.push(reading.time, seen.error_mm);
        if self.motion.is_some() {
            self.following_error.push(seen.error_mm);
        }
    }

    /// Keeps a place that was latched between two readings, if the stage has come there from its
    /// last reading as its set point has, but for what no reading may step beyond it without
    /// suspicion. Another is left out, and the readings about it stand for it.
    pub(super) fn latch(&mut self, setup: &Setup, latched: StageReading) {
        let set = [latched.time, self.last_reading].map(|time| self.setpoint(time));
        let ([Some(there), Some(before)], Some(read_mm)) = (set, self.read_mm) else {
            return;
        };
        let step_mm = latched.offset_mm - read_mm;
        let beyond_mm = libm::fabsf(step_mm - (there.offset_mm - before.offset_mm));
        let is_near = beyond_mm <= setup.stage_tolerance().jump_mm;
        if self.is_place_lost || !is_near {
            return;
        }
        let play = self.play.offset(setup.settings.drive.unseen_play_mm());
        self.track.latch(StagePlace {
            time: latched.time,
            offset_mm: latched.offset_mm + play.offset_mm,
            reading: PlaceReading::latched(play.sigma_mm),
        });
    }

    /// Lets the stage stand at the start of a profile until [`Self::begin`].
    pub(super) fn wait_for(&mut self, profile: Profile) {
        self.motion = Some(Motion {
            profile,
            began: None,
        });
    }

    /// Begins the profile that waits, if there is one, at a time.
    pub(super) fn begin(&mut self, began: Time) {
        if let Some(motion) = &mut self.motion
            && motion.began.is_none()
        {
            motion.began = Some(began);
        }
    }

    /// Sends the stage from its present position to a place, mm. Returns `false` if there is no
    /// such way, as when a number is not finite.
    #[inline(never)]
    pub(super) fn go_to(&mut self, setup: &Setup, now: Time, place_mm: f32) -> bool {
        let from = self.setpoint(now).unwrap_or_else(|| Setpoint {
            offset_mm: self.last_place_mm(),
            ..Setpoint::default()
        });
        let Ok(profile) = setup.camera.stage().reposition(from, place_mm) else {
            return false;
        };
        self.motion = Some(Motion {
            profile,
            began: Some(now),
        });
        true
    }

    /// Awaits readings from now on, which are not compared with earlier ones.
    pub(super) fn expect_readings(&mut self, now: Time) {
        self.following_slope.clear();
        self.forget_suspicion();
        self.last_reading = now;
    }

    /// Begins to watch anew.
    const fn forget_suspicion(&mut self) {
        self.watch = StageWatch::new();
        self.suspicious = None;
        self.latched_index = None;
    }

    /// Releases the stage. Returns `true` if there was force on it.
    pub(super) fn release(&mut self) -> bool {
        self.following_slope.clear();
        self.forget_suspicion();
        self.standing_since = None;
        // Without force the encoder is watched less.
        self.index.demand();
        self.motion.take().is_some()
    }

    /// Takes a fault; one of the stage stays until it is cleared.
    pub(super) fn fail(&mut self, fault: Fault) {
        if !is_of_the_stage(fault) {
            return;
        }
        // A reversed encoder has counted to a place at which the stage is not. At a standstill such
        // a stage looks like one that runs away.
        self.is_place_lost |= matches!(
            fault,
            Fault::Encoder | Fault::WrongDirection | Fault::Runaway
        );
        self.fault = match self.fault {
            Some(first) if fault != Fault::Encoder => Some(first),
            _ => Some(fault),
        };
    }

    /// Notes that the encoder has not counted for a while.
    pub(super) const fn lose_place(&mut self) {
        if !self.is_absolute {
            self.is_place_lost = true;
            self.fault = Some(Fault::Encoder);
        }
    }

    /// Notes that the encoder counts from the calibrated position again.
    pub(super) fn refer(&mut self) {
        self.is_place_lost = false;
        self.index.demand();
        self.play_watch.forget_counts();
        self.track.clear();
        self.read_mm = None;
        self.following_slope.clear();
        self.fault = self.fault.filter(|fault| *fault != Fault::Encoder);
    }

    /// Clears the fault. A place that is lost stays lost, unless the sensor is absolute: it is
    /// believed again.
    pub(super) fn clear_fault(&mut self) {
        if self.is_absolute && core::mem::take(&mut self.is_place_lost) {
            self.forget_readings();
        }
        self.fault = self.is_place_lost.then_some(Fault::Encoder);
    }

    /// Forgets the readings after a jump of the clock: they cannot be compared with later times.
    pub(super) fn forget_readings(&mut self) {
        self.track.clear();
        self.read_mm = None;
        self.following_slope.clear();
        self.standing_since = None;
    }

    /// Restarts the time of the last reading after a jump of the clock.
    pub(super) const fn restart_clock(&mut self, now: Time) {
        self.last_reading = now;
    }

    /// Returns `true` if the stage under force has not been read for too long.
    pub(super) fn is_unread(&self, now: Time) -> bool {
        self.motion.is_some() && now.seconds_since(self.last_reading) > READINGS_CEASE_S
    }

    /// Returns `true` if the stage stands at the end of its way, or has none.
    pub(super) fn has_arrived(&self, now: Time) -> bool {
        self.motion
            .as_ref()
            .is_none_or(|motion| motion.is_over(now))
    }

    /// Returns `true` if the following error changes by at most `allowed_mm` in an exposure, mm, or
    /// if that cannot be known; `false` while the last reading is in doubt.
    pub(super) fn is_steady(
        &self,
        setup: &Setup,
        now: Time,
        exposure_s: f32,
        allowed_mm: f32,
    ) -> bool {
        if !setup.camera.has_stage() || self.is_place_lost {
            return true;
        }
        self.suspicious.is_none()
            && now.seconds_since(self.last_reading) <= LATE_TICK_S
            && self
                .following_slope
                .per_s()
                .is_some_and(|error_mm_s| libm::fabsf(error_mm_s) * exposure_s <= allowed_mm)
    }

    /// Returns `true` if the stage has not moved for [`STANDING_S`], as far as its readings show.
    pub(super) fn has_stood(&mut self, setup: &Setup, now: Time) -> bool {
        let offset_mm = self.last_place_mm();
        let tolerance_mm = setup.stage_tolerance().following_mm;
        match self.standing_since {
            Some((since, place_mm)) if libm::fabsf(offset_mm - place_mm) <= tolerance_mm => {
                now.seconds_since(since) > STANDING_S
            }
            _ => {
                self.standing_since = Some((now, offset_mm));
                false
            }
        }
    }

    /// Returns the set point of a time; `None` if the stage is released.
    pub(super) fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.motion.as_ref().map(|motion| motion.setpoint(now))
    }

    /// Returns the set point's position at a time, mm; of a released stage, its last reading.
    pub(super) fn place_mm(&self, now: Time) -> f32 {
        match self.setpoint(now) {
            Some(setpoint) => setpoint.offset_mm,
            None => self.last_place_mm(),
        }
    }

    /// Returns the position of the last reading, mm; 0 before the first.
    fn last_place_mm(&self) -> f32 {
        self.read_mm.unwrap_or(0.0)
    }

    /// Returns how far the place of the stage may be wrong, as its readings show, mm.
    pub(super) const fn off_mm(&self) -> f32 {
        self.watch.off_mm()
    }

    /// Returns `true` if the screw pushes the stage along the FMC axis.
    pub(super) fn is_pushed_along(&self, setup: &Setup) -> bool {
        self.play
            .is_taken_up(setup.settings.drive.encoder_step_mm())
    }

    /// Returns `true` if the screw pushes the stage against the FMC axis.
    pub(super) fn is_pushed_against(&self, setup: &Setup) -> bool {
        let drive = &setup.settings.drive;
        let (play_mm, step_mm) = (drive.unseen_play_mm(), drive.encoder_step_mm());
        self.play.is_taken_up_against(play_mm, step_mm)
    }

    pub(super) const fn is_released(&self) -> bool {
        self.motion.is_none()
    }

    pub(super) const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    pub(super) const fn is_place_lost(&self) -> bool {
        self.is_place_lost
    }

    pub(super) const fn track(&self) -> &StageTrack {
        &self.track
    }

    pub(super) const fn track_mut(&mut self) -> &mut StageTrack {
        &mut self.track
    }

    pub(super) const fn following_error(&self) -> &FollowingErrorRms {
        &self.following_error
    }

    pub(super) const fn glitches(&self) -> u32 {
        self.glitches
    }
}

/// Returns `true` for faults after which the stage stays released until they are cleared.
const fn is_of_the_stage(fault: Fault) -> bool {
    matches!(
        fault,
        Fault::Stall
            | Fault::Runaway
            | Fault::WrongDirection
            | Fault::LimitSwitch
            | Fault::Encoder
            | Fault::Drive
    )
}

#[cfg(test)]
mod tests;
