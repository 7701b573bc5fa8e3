//! The watch of the index mark: it compares the encoder's reading from crossing to crossing.

use super::controller::timing::TICK_S;
use super::drive::settings::DriveSettings;
use super::in_doubt::InDoubt;
use super::stage_track::TrackSpeed;

/// Number of σ by which two crossings may differ: one in a million does by chance alone.
pub(crate) const AGREE_SIGMA: f32 = 5.0;

/// Part of a change of speed from one reading to the next by which the speed at the mark may be
/// wrong: a stage that is pushed at a moment that nobody knows goes on at up to twice the change.
const CHANGE_PART: f32 = 2.0;

/// Part, as σ, of the counts that may be lost unseen: the tolerance of a crossing.
pub(crate) const UNSEEN_PART: f32 = 0.15;

/// Part, as σ, of a difference of two crossings that agree, beyond what the encoder's steps make:
/// all of it if counts were lost, nothing if the motion was uneven.
pub(crate) const OFF_PART: f32 = 0.75;

/// Part of a step that the readings of two crossings seldom differ by: of ten differences one is
/// larger, and is in σ as if counts were lost.
const USUAL_STEPS: f32 = 0.7;

/// Number of σ of an evenly distributed error within which it lies.
const EVEN_SIGMA: f32 = 1.73;

/// Number of σ of the records since the last crossing, by what they hold of it, beyond which the
/// difference of the next leaves them in doubt.
pub(crate) const SUSPECT_SIGMA: f32 = 3.0;

/// Reading of the encoder at the index mark, and the records that depend on it.
///
/// # Model
/// The mark sits on the stage. A crossing counts where the screw pushes the stage along the FMC
/// axis, as it does where the encoder's zero is set: play and width of the mark do not enter. The
/// first crossing after arming must agree with the mark's place in the settings. Reference of the
/// others is the slowest and steadiest so far. Two readings of a place differ by up to a step q and
/// by the repeatability of the mark `σ_i`. The age t of a reading moves it by v·t: with the error
/// of t, which stays, by `σ_t` times the difference of the speeds v and u of both crossings, and
/// with the speeds, which are known to [`CHANGE_PART`] of their largest recent changes d and c
/// between two readings, less the change that a step makes. The tolerances are
///
/// ```text
/// against the reference   e = q·(1 + 2·t/T) + 5·√(σ_i² + ((v - u)·σ_t)²) + 2·t·(d + c)
/// against the settings        q·(1 + 2·t/T) + 5·√(σ_i² + σ_0² + (s·x)² + (v·σ_t)²) + 2·t·d
/// ```
///
/// with σ of the zero `σ_0`, of the scale s, the place x of the mark and the time T between
/// readings. A crossing outside shows that counts were lost or added since the last one that agreed
/// within the steps, `q·(1 + 2·t/T)`.
///
/// # σ of a record
/// A record with a crossing since the one before is *referenced*. Its σ is not below
/// [`UNSEEN_PART`] of the tolerance e of another crossing like that: as much may be lost unseen. In
/// that e, d and c are the changes that an even acceleration does not explain: of a stage that
/// accelerates evenly the speed at the mark is known. To that is added [`OFF_PART`] of the
/// difference of that crossing from the reference and of the reference from the settings, both, or
/// the larger of a crossing that becomes the reference: uneven motion, or counts that were lost.
/// [`USUAL_STEPS`] of a step and [`EVEN_SIGMA`] times the error of the age, with the difference of
/// the speeds, are no such difference: that error is in σ of every record. Without a crossing,
/// as on a camera without a mark, each of the n records since the last may have lost a step that
/// the stage's watch lets pass, up to L either way and independent of the others: `σ² = n·L²/3`.
/// The difference of a crossing that did not agree is added to that.
///
/// Counts that are lost after a crossing and before the exposure are seen at the next: a difference
/// beyond [`SUSPECT_SIGMA`] of what the σ of the records in between holds leaves these in doubt,
/// even if it agrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct IndexWatch {
    /// The slowest and steadiest crossing since the camera was armed.
    reference: Option<Passage>,
    /// Difference of the last crossing from the reference and of that from the settings, beyond
    /// that which the encoder's steps usually and the age of its readings make, mm.
    off_mm: f32,
    /// Tolerance of another crossing like the last one that agreed, of a stage that accelerates
    /// evenly, mm.
    tolerance_mm: f32,
    /// Reading at the last crossing, mm, whether it agreed or not.
    last_mm: Option<f32>,
    /// The stage has crossed the mark since it was armed as it does from frame to frame, perhaps
    /// slower than at arming.
    is_flown: bool,
    /// Exposures since the last crossing that agreed; one more if there was none.
    cycles: u16,
    /// Number of the first record after the last crossing that agreed.
    crossed_before: u32,
    /// Number of the first record after the last crossing that agreed within the steps.
    first_since: u32,
    /// Exposures that crossings have left in doubt.
    in_doubt: Option<InDoubt>,
    /// The stage has been moved across the mark, and no crossing came.
    is_missed: bool,
    detour: Detour,
    /// Place at which the stage waits, mm, after the first way back.
    began_mm: f32,
    /// The last way back has led across the mark, along the FMC axis.
    is_expected: bool,
}

/// A crossing, or a pair of them, as it is compared with others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passage {
    /// Place of the mark by the encoder, or the way between two, mm.
    pub(crate) place_mm: f32,
    /// Speed, mm/s.
    pub(crate) speed_mm_s: f32,
    /// Change of the speed between two readings, beyond what a step makes, mm/s.
    pub(crate) change_mm_s: f32,
    /// The same beyond the change of an even acceleration, mm/s.
    pub(crate) bend_mm_s: f32,
}

impl Passage {
    /// Returns `true` if the stage was slower and steadier than in another.
    pub(crate) fn is_better_than(&self, other: &Self) -> bool {
        other.fastest_mm_s() > self.fastest_mm_s()
    }

    /// Largest speed that the stage may have had.
    fn fastest_mm_s(&self) -> f32 {
        self.speed_mm_s + CHANGE_PART * self.change_mm_s
    }

    /// Largest change that an even acceleration does not explain, mm/s.
    fn uneven_mm_s(&self) -> f32 {
        self.bend_mm_s.min(self.change_mm_s)
    }
}

/// Ways across the mark before the way to the waiting place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Detour {
    None,
    /// To the place below the mark.
    Down,
    /// From there to the place above it.
    Up,
    /// To the lower end of the ways at arming, to search for the mark.
    SearchDown,
    /// From there to their upper end.
    SearchUp,
}

/// A reading of the encoder at the mark, until the next reading tells how fast the stage was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LatchedIndex {
    /// Reading of the encoder, mm.
    pub(crate) reading_mm: f32,
    /// Number of the first record whose exposure has not ended.
    pub(crate) next_sequence: u32,
    /// The stage moves along the FMC axis.
    pub(crate) is_along: bool,
}

/// A crossing of the mark with the screw pushing the stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Reading of the encoder, as latched, mm.
    pub(crate) reading_mm: f32,
    /// Speed there; negative against the FMC axis.
    pub(crate) speed: TrackSpeed,
    /// Number of the first record whose exposure has not ended.
    pub(crate) next_sequence: u32,
}

impl Crossing {
    /// Returns the place of the mark that the reading gives, with its age.
    pub(crate) fn passage(&self, drive: &DriveSettings) -> Passage {
        // A step in a reading looks like a change.
        let of_step_mm_s = drive.encoder_step_mm() / TICK_S;
        Passage {
            place_mm: self.reading_mm + self.speed.speed_mm_s * drive.velocity_loop.reading_age_s,
            speed_mm_s: self.speed.speed_mm_s,
            change_mm_s: (self.speed.change_mm_s - of_step_mm_s).max(0.0),
            bend_mm_s: (self.speed.bend_mm_s - 2.0 * of_step_mm_s).max(0.0),
        }
    }
}

/// Places on both sides of the mark, mm, between which a way crosses it with the play taken up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct IndexSides {
    pub(crate) low_mm: f32,
    pub(crate) high_mm: f32,
}

impl IndexSides {
    /// Returns `true` if a way between two places, there or back, crosses the mark.
    pub(crate) fn are_between(&self, one_mm: f32, other_mm: f32) -> bool {
        one_mm.min(other_mm) <= self.low_mm && one_mm.max(other_mm) >= self.high_mm
    }
}

/// Ends of the ways across the mark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct IndexPlaces {
    /// Of the shortest.
    pub(crate) sides: IndexSides,
    /// Of those at arming.
    pub(crate) ends: IndexSides,
}

/// A way of the stage after a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    pub(crate) to_mm: f32,
    /// The stage has been moved across the mark, and for the first time no crossing came.
    pub(crate) is_newly_missed: bool,
    /// The last frame or the way before it has led across the mark, and no crossing came.
    pub(crate) is_overdue: bool,
}

impl IndexWatch {
    /// Returns a watch before the first crossing.
    pub(crate) const fn new() -> Self {
        Self {
            reference: None,
            off_mm: 0.0,
            tolerance_mm: 0.0,
            is_flown: false,
            last_mm: None,
            cycles: 1,
            crossed_before: 1,
            first_since: 1,
            in_doubt: None,
            is_missed: false,
            detour: Detour::None,
            began_mm: f32::NAN,
            is_expected: false,
        }
    }

    /// Forgets the reference: the next crossing is compared with the settings.
    pub(crate) fn arm(&mut self) {
        self.reference = None;
        self.is_flown = false;
        self.is_missed = false;
    }

    /// Takes a crossing. Returns the exposures that it leaves in doubt: it does not agree with
    /// those before, or with the settings, or it agrees and σ does not cover its difference.
    pub(crate) fn cross(&mut self, crossing: &Crossing, drive: &DriveSettings) -> Option<InDoubt> {
        let latest = crossing.passage(drive);
        let place_mm = latest.place_mm;
        self.last_mm = Some(place_mm);
        let index_mm = drive.index_mm?;
        let (expected_mm, at_mm_s, agreed_mm) = if let Some(reference) = self.reference {
            let tolerance_mm = repeat_tolerance_mm(drive, &latest, &reference);
            (reference.place_mm, reference.speed_mm_s, tolerance_mm)
        } else {
            let tolerance_mm = place_tolerance_mm(drive, &latest, index_mm);
            (index_mm, 0.0, tolerance_mm)
        };
        self.is_missed = false;
        let last = crossing.next_sequence.saturating_sub(1);
        let off_mm = place_mm - expected_mm;
        if libm::fabsf(off_mm) > agreed_mm {
            self.off_mm = libm::fabsf(off_mm);
            self.cycles = self.cycles.max(1);
            return Some(InDoubt::between([self.first_since, last], off_mm, true));
        }
        self.is_flown |= self.reference.is_some() && self.cycles > 0;
        let reference = self
            .reference
            .filter(|reference| !latest.is_better_than(reference))
            .unwrap_or(latest);
        self.reference = Some(reference);
        let steps_mm = steps_mm(drive);
        let beyond_mm = libm::fabsf(off_mm) - steps_mm;
        // The error of the readings' age, which is in σ of every record, moves crossings at other
        // speeds. The place in the settings has no steps, and the slowest crossing least of that.
        let of_age = EVEN_SIGMA * drive.reading_age_sigma_s;
        let of_speed_mm = of_age * libm::fabsf(latest.speed_mm_s - at_mm_s);
        let of_settings_mm = libm::fabsf(reference.place_mm - index_mm)
            - 0.5 * steps_mm
            - of_age * reference.speed_mm_s;
        let covered_mm = SUSPECT_SIGMA
            * root_of_squares([UNSEEN_PART * self.tolerance_mm, OFF_PART * self.off_mm, 0.0]);
        let of_settings_mm = of_settings_mm.max(0.0);
        let both_mm = |of_reference_mm: f32| {
            let of_reference_mm = (of_reference_mm - of_speed_mm).max(0.0);
            if reference == latest {
                of_reference_mm.max(of_settings_mm)
            } else {
                of_reference_mm + of_settings_mm
            }
        };
        let usual_mm = USUAL_STEPS * drive.encoder_step_mm();
        self.off_mm = both_mm(libm::fabsf(off_mm) - usual_mm);
        let is_suspect = self.tolerance_mm > 0.0 && both_mm(beyond_mm) > covered_mm;
        let in_doubt = (is_suspect && self.crossed_before <= last)
            .then(|| InDoubt::between([self.crossed_before, last], off_mm, false));
        self.crossed_before = crossing.next_sequence;
        let slowest_mm_s = if self.is_flown {
            reference.speed_mm_s
        } else {
            0.0
        };
        // Of an even acceleration the speed at the mark is known.
        let sigma_mm = repeat_sigma_mm(drive, latest.speed_mm_s - slowest_mm_s);
        let bend_mm_s = latest.uneven_mm_s() + reference.uneven_mm_s();
        self.tolerance_mm = tolerance_mm(drive, sigma_mm, bend_mm_s);
        self.cycles = 0;
        if beyond_mm <= 0.0 {
            self.first_since = crossing.next_sequence;
        }
        in_doubt
    }

    /// Notes the record of an exposure.
    pub(crate) const fn count_record(&mut self) {
        self.cycles = self.cycles.saturating_add(1);
    }

    /// Returns σ of a principal point that is common to the flight, with the counts that may have
    /// been lost unseen, mm; `passed_mm` is the largest step that the stage's watch lets pass.
    pub(crate) fn sigma_mm(&self, common_mm: f32, drive: &DriveSettings, passed_mm: f32) -> f32 {
        if self.is_referenced(drive) {
            let least_mm = common_mm.max(UNSEEN_PART * self.tolerance_mm);
            root_of_squares([least_mm, OFF_PART * self.off_mm, 0.0])
        } else {
            let lost_mm = lost_sigma_mm(passed_mm, f32::from(self.cycles.max(1)));
            root_of_squares([common_mm, lost_mm, self.off_mm])
        }
    }

    /// Returns `true` if the mark has been crossed since the last record, and agreed.
    pub(crate) const fn is_referenced(&self, drive: &DriveSettings) -> bool {
        drive.index_mm.is_some() && self.cycles == 0
    }

    /// Returns `true` if the mark has been crossed since the camera was armed, and agreed.
    pub(crate) const fn is_found(&self) -> bool {
        self.reference.is_some()
    }

    /// Begins with the exposure of this number: a crossing tells nothing of those before.
    #[cfg(feature = "link")]
    pub(crate) const fn begin_at(&mut self, sequence: u32) {
        self.crossed_before = sequence;
        self.first_since = sequence;
    }

    /// Notes exposures that are in doubt.
    pub(crate) fn doubt(&mut self, exposures: InDoubt) {
        self.in_doubt = Some(match self.in_doubt {
            Some(before) => before.with(exposures),
            None => exposures,
        });
    }

    /// Exposures that crossings have left in doubt.
    pub(crate) const fn in_doubt(&self) -> Option<InDoubt> {
        self.in_doubt
    }

    /// Returns the place of the mark by the last crossing, mm.
    pub(crate) const fn last_mm(&self) -> Option<f32> {
        self.last_mm
    }

    /// Asks for a crossing before the stage is ready again.
    pub(crate) fn demand(&mut self) {
        self.cycles = self.cycles.max(1);
        self.detour = Detour::None;
        self.began_mm = f32::NAN;
        self.is_expected = false;
    }

    /// Returns the next way after a frame, from a place to the waiting place, mm: directly, or to a
    /// place beside the mark if the way there and back does not cross it. If no crossing has come
    /// where the stage has been moved across the mark, the mark is searched for once: many counts
    /// may be lost.
    pub(crate) fn next_way(&mut self, from_mm: f32, waiting_mm: f32, places: &IndexPlaces) -> Way {
        let sides = &places.sides;
        let is_up = |one_mm, other_mm| one_mm <= sides.low_mm && other_mm >= sides.high_mm;
        // The record before the last was the last with a crossing.
        let is_overdue = self.cycles > 1 && (self.is_expected || is_up(self.began_mm, from_mm));
        let is_crossed = self.cycles == 0;
        let is_searched_for = is_crossed || self.is_missed;
        let next = match self.detour {
            Detour::Down => Detour::Up,
            Detour::SearchDown => Detour::SearchUp,
            Detour::SearchUp => Detour::None,
            Detour::Up if is_searched_for => Detour::None,
            Detour::Up => Detour::SearchDown,
            Detour::None if is_overdue && !is_searched_for => Detour::SearchDown,
            Detour::None if is_crossed || sides.are_between(from_mm, waiting_mm) => Detour::None,
            Detour::None if from_mm <= sides.low_mm => Detour::Up,
            Detour::None => Detour::Down,
        };
        let is_missed = self.detour == Detour::SearchUp && !is_crossed;
        self.detour = next;
        let to_mm = match next {
            Detour::None => waiting_mm,
            Detour::Down => sides.low_mm,
            Detour::Up => sides.high_mm,
            Detour::SearchDown => places.ends.low_mm,
            Detour::SearchUp => places.ends.high_mm,
        };
        if next == Detour::None {
            self.began_mm = waiting_mm;
            self.is_expected = is_up(from_mm, waiting_mm);
        }
        Way {
            to_mm,
            is_newly_missed: is_missed && self.miss(),
            is_overdue,
        }
    }

    /// Returns `true` if a frame that ends at a place, mm, has led across the mark against the FMC
    /// axis.
    pub(crate) fn has_led_down(&self, to_mm: f32, sides: &IndexSides) -> bool {
        self.began_mm >= sides.high_mm && to_mm <= sides.low_mm
    }

    /// Returns `true` if another way follows before the waiting place is reached.
    pub(crate) const fn is_on_detour(&self) -> bool {
        !matches!(self.detour, Detour::None)
    }

    /// Notes that the stage has been moved across the mark and no crossing came. Returns `true` for
    /// the first time since the last crossing.
    pub(crate) const fn miss(&mut self) -> bool {
        !core::mem::replace(&mut self.is_missed, true)
    }
}

/// Returns σ of the counts that may be lost in so many records, mm, if the stage's watch lets a
/// step of up to `passed_mm` pass in each.
pub(crate) fn lost_sigma_mm(passed_mm: f32, records: f32) -> f32 {
    passed_mm * fmc_camera_kernel::sqrt(records / 3.0)
}

/// Returns the largest difference of two readings of a place that their steps make, mm. Both speeds
/// have the steps of their readings.
pub(crate) fn steps_mm(drive: &DriveSettings) -> f32 {
    let age_s = drive.velocity_loop.reading_age_s;
    drive.encoder_step_mm() * (1.0 + 2.0 * age_s / TICK_S)
}

/// Returns the largest difference of two crossings that agree, mm.
fn repeat_tolerance_mm(drive: &DriveSettings, latest: &Passage, reference: &Passage) -> f32 {
    let sigma_mm = repeat_sigma_mm(drive, latest.speed_mm_s - reference.speed_mm_s);
    let change_mm_s = latest.change_mm_s + reference.change_mm_s;
    tolerance_mm(drive, sigma_mm, change_mm_s)
}

/// Returns the largest difference of a crossing that agrees from the mark's place in the settings,
/// mm.
fn place_tolerance_mm(drive: &DriveSettings, latest: &Passage, index_mm: f32) -> f32 {
    let of_zero_mm = 1e-3 * drive.zero_sigma_um;
    let of_scale_mm = 1e-6 * drive.encoder_scale_ppm * index_mm;
    let of_mark_mm = repeat_sigma_mm(drive, latest.speed_mm_s);
    let sigma_mm = libm::hypotf(of_mark_mm, libm::hypotf(of_zero_mm, of_scale_mm));
    tolerance_mm(drive, sigma_mm, latest.change_mm_s)
}

fn tolerance_mm(drive: &DriveSettings, sigma_mm: f32, change_mm_s: f32) -> f32 {
    steps_mm(drive) + AGREE_SIGMA * sigma_mm + uneven_mm(drive, change_mm_s)
}

/// Returns the largest error of a place by changes of the speed, mm.
pub(crate) fn uneven_mm(drive: &DriveSettings, change_mm_s: f32) -> f32 {
    CHANGE_PART * change_mm_s * drive.velocity_loop.reading_age_s
}

/// Returns σ of a sum of three errors.
fn root_of_squares(sigmas: [f32; 3]) -> f32 {
    fmc_camera_kernel::sqrt(sigmas.map(|it| it * it).iter().sum())
}

/// Returns σ of the difference of two readings at the mark with a difference in speed, mm.
fn repeat_sigma_mm(drive: &DriveSettings, faster_mm_s: f32) -> f32 {
    let of_age_mm = drive.reading_age_sigma_s * faster_mm_s;
    libm::hypotf(1e-3 * drive.index_sigma_um, of_age_mm)
}

#[cfg(test)]
mod tests;
