//! Recent places of the stage, and its path in an exposure.

use heapless::{Deque, Vec};

use super::time::Time;
use crate::geometry::principal_point::StageSample;

/// Number of readings that are kept.
pub const CAPACITY: usize = 64;

/// Number of places before an exposure that are kept with it.
const BEFORE: usize = 2;

/// Number of the latest places that tell how evenly the stage moves: three changes of its speed.
const RECENT: usize = 5;

/// Number of the latest changes of speed, of which the largest counts.
const RECENT_CHANGES: usize = 2;

/// Time by which the path is continued beyond its ends, s.
const CONTINUED_S: f32 = 0.003;

/// Place of the stage at a reading of its encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagePlace {
    /// Time of the reading.
    pub time: Time,
    /// Offset of the stage, mm: that of the encoder, and of the stage from its screw.
    pub offset_mm: f32,
    /// The way in which it was read, with its σ.
    pub reading: PlaceReading,
}

/// The way in which a place was read, and σ of the stage's offset from its screw: one word, since
/// the track has many.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceReading {
    /// σ, mm; negative where it was latched.
    signed_mm: f32,
}

impl PlaceReading {
    /// A reading of the control loop, with σ of the stage's offset from its screw, mm.
    #[must_use]
    pub const fn of_round(play_sigma_mm: f32) -> Self {
        Self {
            signed_mm: play_sigma_mm.abs(),
        }
    }

    /// A place that hardware latched between two readings, with σ, mm. It may be so near to one of
    /// them that nothing is told by the speed between the two.
    #[must_use]
    pub const fn latched(play_sigma_mm: f32) -> Self {
        Self {
            signed_mm: -play_sigma_mm.abs(),
        }
    }

    /// Returns `true` if hardware latched it.
    #[must_use]
    pub const fn is_latched(self) -> bool {
        self.signed_mm.is_sign_negative()
    }

    /// σ of the stage's offset from its screw, mm.
    #[must_use]
    pub const fn play_sigma_mm(self) -> f32 {
        self.signed_mm.abs()
    }
}

/// The latest places, in order of time; from the opening of the shutter on, all of the exposure.
#[derive(Debug, Clone)]
pub struct StageTrack {
    places: Deque<StagePlace, CAPACITY>,
    keep_from: Option<Time>,
    /// Stride of the places that are kept during an exposure.
    stride: u32,
    since_kept: u32,
    /// `true` if the last reading makes room for the next.
    is_last_passing: bool,
    /// `true` if there may be places between the readings of an exposure.
    has_latched: bool,
    /// `true` in an exposure that has no room for them.
    takes_no_more: bool,
}

impl Default for StageTrack {
    fn default() -> Self {
        Self::new()
    }
}

/// Speed of the stage at a place, and what the latest readings show of its changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TrackSpeed {
    /// Speed, mm/s.
    pub(crate) speed_mm_s: f32,
    /// Largest of the last two changes from one reading to the next, mm/s.
    pub(crate) change_mm_s: f32,
    /// Largest difference of two changes that follow one another, mm/s: 0 at constant acceleration.
    /// It is the largest change where there is only one.
    pub(crate) bend_mm_s: f32,
}

/// The path of an exposure.
#[derive(Debug, Clone)]
pub struct ExposurePath {
    /// Samples, s after first light, that cover the exposure as far as [`Self::is_covered`]; at
    /// most one lies before it.
    pub samples: Vec<StageSample, { CAPACITY + 2 }>,
    /// `true` if an end was continued from its neighbours.
    pub is_continued: bool,
    /// The longest time between two samples in the exposure, s.
    pub longest_gap_s: f32,
    /// Departure of the path from the straight line between its ends, to both sides together, mm.
    pub wander_mm: f32,
    /// Largest difference of two moves that follow one another, at equal times, mm: what the stage
    /// may have done between two readings.
    pub bend_mm: f32,
    /// `true` if the samples cover the exposure.
    pub is_covered: bool,
    /// Largest σ of the stage's offset from its screw at a sample, mm.
    pub play_sigma_mm: f32,
}

impl StageTrack {
    /// Returns a track without readings.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            places: Deque::new(),
            keep_from: None,
            stride: 1,
            since_kept: 0,
            is_last_passing: false,
            has_latched: false,
            takes_no_more: false,
        }
    }

    /// Takes a place. One that is not later than the last is left out.
    ///
    /// If there is no room, the oldest is forgotten. In an exposure these are the places before it
    /// but for the last `BEFORE`; once they are gone, every other place of the exposure is
    /// forgotten, and from then on every other one is kept, so that an exposure of any length is
    /// covered evenly.
    pub fn push(&mut self, place: StagePlace) {
        if self
            .places
            .back()
            .is_some_and(|last| place.time <= last.time)
        {
            return;
        }
        if self.is_last_passing {
            self.places.pop_back();
        }
        if self.places.is_full() {
            self.make_room();
        }
        self.since_kept = self.since_kept.saturating_add(1);
        self.is_last_passing = self.since_kept < self.stride;
        if !self.is_last_passing {
            self.since_kept = 0;
        }
        self.add(place);
    }

    /// Takes a place that was latched between two readings, in order of time. One of the time of
    /// another place is left out, and one that is older than the first.
    ///
    /// In an exposure that has no room for it all such places are forgotten, and no more are
    /// taken: it is long enough to be known by its readings.
    pub fn latch(&mut self, place: StagePlace) {
        let before = self.count(|time| time < place.time);
        let is_there = |it: &StagePlace| it.time == place.time;
        if self.takes_no_more || before == 0 || self.places.get(before).is_some_and(is_there) {
            return;
        }
        self.has_latched = true;
        // Otherwise the next reading would take the room of this place.
        self.is_last_passing &= before < self.places.len();
        self.add(place);
        let mut at = self.places.len().saturating_sub(1);
        while let Some(earlier) = at.checked_sub(1)
            && self
                .places
                .get(earlier)
                .is_some_and(|it| it.time > place.time)
        {
            self.copy(earlier, at);
            at = earlier;
        }
        if let Some(there) = self.places.get_mut(at) {
            *there = place;
        }
    }

    fn add(&mut self, place: StagePlace) {
        if self.places.is_full() {
            self.make_room();
        }
        // There is room now.
        let _ = self.places.push_back(place);
    }

    fn make_room(&mut self) {
        let Some(keep_from) = self.keep_from else {
            self.places.pop_front();
            return;
        };
        // The two before the exposure tell how the stage came into it.
        let before = self.places.iter().take_while(|it| it.time <= keep_from);
        let before = before.count();
        if before > BEFORE {
            for _ in BEFORE..before {
                self.places.pop_front();
            }
            return;
        }
        self.takes_no_more = true;
        if core::mem::take(&mut self.has_latched) {
            self.forget_latched(before);
            if !self.places.is_full() {
                return;
            }
        }
        let of_exposure = self.places.len().saturating_sub(before);
        let every_other = before + of_exposure / 2;
        for to in before..every_other {
            self.copy(2 * to + 1 - before, to);
        }
        // The last is kept, too.
        let kept = every_other + of_exposure % 2;
        self.copy(self.places.len().saturating_sub(1), kept.saturating_sub(1));
        self.places.truncate(kept);
        self.stride = self.stride.saturating_mul(2);
        self.since_kept = 0;
    }

    /// Forgets the places between readings from an index on.
    fn forget_latched(&mut self, first: usize) {
        let mut kept = first;
        for from in first..self.places.len() {
            if self
                .places
                .get(from)
                .is_some_and(|it| !it.reading.is_latched())
            {
                self.copy(from, kept);
                kept += 1;
            }
        }
        self.places.truncate(kept);
    }

    /// Copies a place to another index.
    fn copy(&mut self, from: usize, to: usize) {
        if let Some(place) = self.places.get(from).copied()
            && let Some(other) = self.places.get_mut(to)
        {
            *other = place;
        }
    }

    /// Keeps everything from an instant on, at which the shutter opens.
    pub(crate) fn keep_from(&mut self, opened: Time) {
        self.keep_from = Some(opened);
    }

    /// Returns `true` in an exposure, whose places are kept.
    pub(crate) const fn is_kept(&self) -> bool {
        self.keep_from.is_some()
    }

    /// Ends an exposure: old readings may be forgotten.
    pub(crate) fn keep_latest(&mut self) {
        self.keep_from = None;
        self.stride = 1;
        self.since_kept = 0;
        self.is_last_passing = false;
        self.takes_no_more = false;
    }

    /// Forgets everything: the places to come cannot be compared with those so far.
    pub fn clear(&mut self) {
        self.places.clear();
        self.keep_latest();
    }

    /// The last place.
    #[must_use]
    pub fn last(&self) -> Option<StagePlace> {
        self.places.back().copied()
    }

    /// The readings, in order of time.
    pub(crate) fn readings(&self) -> impl DoubleEndedIterator<Item = &StagePlace> {
        self.places.iter().filter(|it| !it.reading.is_latched())
    }

    /// Returns the speed of the stage where it was at a place between the last two readings, and
    /// how uneven it was; `None` before the third.
    ///
    /// # Model
    /// The speed changes evenly: it has its mean between two readings in the middle of them.
    #[must_use]
    pub(crate) fn speed_at(&self, offset_mm: f32) -> Option<TrackSpeed> {
        let latest = || self.readings().rev().take(RECENT);
        let mut speeds = latest().zip(latest().skip(1)).map(|(after, before)| {
            (after.offset_mm - before.offset_mm) / after.time.seconds_since(before.time)
        });
        let (speed_mm_s, mut before_mm_s) = (speeds.next()?, speeds.next()?);
        let latest_mm_s = speed_mm_s - before_mm_s;
        let mut change_mm_s = libm::fabsf(latest_mm_s);
        let mut bend_mm_s = None;
        let mut later_mm_s = latest_mm_s;
        for (number, earlier_mm_s) in (2..).zip(speeds) {
            let change = before_mm_s - earlier_mm_s;
            if number <= RECENT_CHANGES {
                change_mm_s = larger(change_mm_s, libm::fabsf(change));
            }
            let bend = libm::fabsf(later_mm_s - change);
            bend_mm_s = Some(bend_mm_s.map_or(bend, |largest| larger(largest, bend)));
            (before_mm_s, later_mm_s) = (earlier_mm_s, change);
        }
        let bend_mm_s = bend_mm_s.unwrap_or(change_mm_s);
        let (last, middle) = (latest().next()?, latest().nth(1)?);
        let moved_mm = last.offset_mm - middle.offset_mm;
        let after_middle_mm_s = if moved_mm == 0.0 {
            0.0
        } else {
            let part = ((offset_mm - middle.offset_mm) / moved_mm).clamp(0.0, 1.0);
            (part - 0.5) * latest_mm_s
        };
        Some(TrackSpeed {
            speed_mm_s: speed_mm_s + after_middle_mm_s,
            change_mm_s,
            bend_mm_s,
        })
    }

    /// Returns the path from first to last light.
    #[must_use]
    pub fn path(&self, opened: Time, closed: Time) -> ExposurePath {
        let exposure_s = closed.seconds_since(opened);
        let mut path = ExposurePath {
            samples: Vec::new(),
            is_continued: false,
            longest_gap_s: 0.0,
            wander_mm: 0.0,
            bend_mm: 0.0,
            is_covered: false,
            play_sigma_mm: 0.0,
        };
        let sample = |place: &StagePlace| StageSample {
            time_s: place.time.seconds_since(opened),
            offset_mm: place.offset_mm,
        };
        let (Some(first), Some(last)) = (self.places.front(), self.places.back()) else {
            return path;
        };
        let [first, last] = [first, last].map(sample);
        let readings = || self.readings().map(sample);
        let mut from_the_end = readings().rev();
        let first_two = (readings().next(), readings().nth(1));
        let last_two = (from_the_end.next(), from_the_end.next());
        let ((Some(one), Some(two)), (Some(end), Some(before))) = (first_two, last_two) else {
            return path;
        };
        // Of the places up to the opening, only the last concerns the exposure.
        let before_it = self.count(|time| time <= opened).saturating_sub(1);
        // There is room for all and two more.
        if first.time_s > 0.0 && first.time_s <= CONTINUED_S {
            path.is_continued = true;
            let _ = path.samples.push(continued(first, slope(one, two), 0.0));
        }
        let mut play_sigma_mm = 0.0;
        for places in self.parts(before_it, self.places.len()) {
            for place in places {
                let _ = path.samples.push(sample(place));
                play_sigma_mm = larger(play_sigma_mm, place.reading.play_sigma_mm());
            }
        }
        path.play_sigma_mm = play_sigma_mm;
        if last.time_s < exposure_s && last.time_s + CONTINUED_S >= exposure_s {
            path.is_continued = true;
            let _ = path
                .samples
                .push(continued(last, slope(before, end), exposure_s));
        }
        path.is_covered = first.time_s <= CONTINUED_S && last.time_s + CONTINUED_S >= exposure_s;
        path.look_over(exposure_s);
        path.bend_mm = self.bend_mm(before_it, closed);
        path
    }

    /// Returns the largest difference of a move and of the move before it, at equal times, mm, of
    /// the moves between readings from the one before a place on until an exposure ends.
    fn bend_mm(&self, first: usize, closed: Time) -> f32 {
        let is_latched = |index| {
            self.places
                .get(index)
                .is_some_and(|it| it.reading.is_latched())
        };
        let first = first.saturating_sub(1 + usize::from(is_latched(first)));
        // The last move begins before the end.
        let end = self.count(|time| time < closed);
        let end = end + 1 + usize::from(is_latched(end));
        let mut bend_mm = 0.0;
        let (mut from, mut earlier): (Option<&StagePlace>, Option<Move>) = (None, None);
        for places in self.parts(first, end) {
            for to in places.iter().filter(|it| !it.reading.is_latched()) {
                if let Some(from) = from {
                    let later = Move::between(from, to);
                    if let Some(earlier) = earlier {
                        bend_mm = larger(bend_mm, later.bend_mm(earlier));
                    }
                    earlier = Some(later);
                }
                from = Some(to);
            }
        }
        bend_mm
    }

    /// Returns the number of places whose times are before an instant.
    fn count(&self, is_before: impl Fn(Time) -> bool) -> usize {
        let (older, newer) = self.places.as_slices();
        let [older, newer] = [older, newer].map(|it| it.partition_point(|it| is_before(it.time)));
        older + newer
    }

    /// Returns the places from one index to before another, the older ones apart.
    fn parts(&self, first: usize, end: usize) -> [&[StagePlace]; 2] {
        let (older, newer) = self.places.as_slices();
        [(older, 0), (newer, older.len())].map(|(places, before)| {
            let of_these = |index: usize| index.saturating_sub(before).min(places.len());
            let range = of_these(first)..of_these(end);
            places.get(range).unwrap_or_default()
        })
    }
}

/// Move of the stage from one place to the next.
#[derive(Clone, Copy)]
struct Move {
    lasts_s: f32,
    moved_mm: f32,
}

impl Move {
    fn between(from: &StagePlace, to: &StagePlace) -> Self {
        Self {
            lasts_s: to.time.seconds_since(from.time),
            moved_mm: to.offset_mm - from.offset_mm,
        }
    }

    /// Returns the difference from the move before, at equal times, mm.
    fn bend_mm(self, before: Self) -> f32 {
        libm::fabsf(self.moved_mm - before.moved_mm * self.lasts_s / before.lasts_s)
    }
}

impl ExposurePath {
    /// Determines the longest gap and the wander.
    fn look_over(&mut self, exposure_s: f32) {
        // Places at first and last light, or beyond them, and all between.
        let from = self.samples.partition_point(|it| it.time_s <= 0.0);
        let to = self.samples.partition_point(|it| it.time_s < exposure_s);
        let inside = from.saturating_sub(1)..(to + 1).min(self.samples.len());
        let Some(samples @ [first, .., last]) = self.samples.get(inside) else {
            return;
        };
        let slope = slope(*first, *last);
        let (mut above, mut below, mut gap_s) = (0.0_f32, 0.0_f32, 0.0_f32);
        for (before, after) in samples.iter().zip(samples.iter().skip(1)) {
            let line_mm = first.offset_mm + slope * (after.time_s - first.time_s);
            above = larger(above, after.offset_mm - line_mm);
            below = larger(below, line_mm - after.offset_mm);
            gap_s = larger(gap_s, after.time_s - before.time_s);
        }
        self.wander_mm = above + below;
        self.longest_gap_s = gap_s;
    }
}

/// Returns the larger of two numbers, the first if the second is not a number. A call of `f32::max`
/// takes longer than a place of the path.
fn larger(one: f32, other: f32) -> f32 {
    if other > one { other } else { one }
}

/// Returns the speed from one sample to a later one, mm/s.
fn slope(from: StageSample, to: StageSample) -> f32 {
    (to.offset_mm - from.offset_mm) / (to.time_s - from.time_s)
}

/// Continues the path from a sample at a speed, mm/s, to a time beyond the samples.
fn continued(from: StageSample, speed_mm_s: f32, time_s: f32) -> StageSample {
    StageSample {
        time_s,
        offset_mm: from.offset_mm + speed_mm_s * (time_s - from.time_s),
    }
}

#[cfg(test)]
mod tests;
