//! The watch of the play: it compares both ways across the index mark.

use super::drive::settings::{DriveSettings, EncoderSide};
use super::index_watch::{
    AGREE_SIGMA, Crossing, OFF_PART, Passage, SUSPECT_SIGMA, UNSEEN_PART, steps_mm, uneven_mm,
};
use super::play::PLAY_SIGMA_PART;

/// Part of the speed of a reference below which a slower pair takes its place.
const SLOWER_PART: f32 = 0.8;

/// Way between the readings at the index mark on the ways along the FMC axis and against it.
///
/// # Model
/// The mark has a width w, and gives an edge where the stage comes to it. A screw that pushes the
/// stage against the axis is behind it by the play p, so the reading there less the reading on the
/// way along the axis is `w - p`, whatever the counts, the zero or the place of the mark. Play that
/// grows makes it smaller; and so do counts that are lost in between, which the next crossing along
/// the axis shows apart, and an encoder that counts another length from a place near the mark on,
/// which that crossing does not show. The width is nobody's setting: the slowest and steadiest pair
/// of crossings since the camera was prepared is the reference: that of arming, until one that is
/// slower by a fifth agrees with it within the steps. With the notation of
/// [`IndexWatch`](super::index_watch::IndexWatch) for each pair, v and u the sums of both speeds, d
/// and c of both changes, the difference g of two pairs agrees up to
///
/// ```text
/// q·(1 + 2·t/T) + 5·√(2·σ_i² + ((v - u)·σ_t)²) + 2·t·(d + c)
/// ```
///
/// The four roundings of two pairs to a step exceed the first term in one of thirty cases.
///
/// # σ of a record
/// Where a pair agrees, [`OFF_PART`] of g beyond the steps, else all of it, is σ of the records
/// that hold the play: those of a flight against the axis, with the encoder on the screw. What has
/// changed since the last pair may be in the records in between: they are in doubt where g is
/// beyond [`SUSPECT_SIGMA`] of what their σ holds. Records of a pair that does not agree have the
/// flag `unreferenced`, in any flight: it may be the play or the encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlayWatch {
    /// The last crossing along the axis that agreed with the mark.
    along: Option<Passage>,
    /// Way between the crossings, sums of speeds and changes, of the slowest and steadiest pair.
    reference: Option<Passage>,
    /// σ of a play that has grown, mm.
    off_mm: f32,
    /// The last pair was outside the tolerance.
    disagrees: bool,
    /// The mark has been crossed against the axis since the last crossing along it.
    is_seen: bool,
    /// The last frame has led across the mark against the axis.
    is_awaited: bool,
}

/// Comparison of a pair of crossings with the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Compared {
    /// Difference from the reference, mm; negative where the play has grown.
    pub(crate) off_mm: f32,
    /// It is within the tolerance.
    pub(crate) agrees: bool,
    /// σ of the records before holds it.
    pub(crate) is_covered: bool,
}

impl PlayWatch {
    /// Returns a watch before the first crossing.
    pub(crate) const fn new() -> Self {
        Self {
            along: None,
            reference: None,
            off_mm: 0.0,
            disagrees: false,
            is_seen: false,
            is_awaited: false,
        }
    }

    /// Forgets the last crossing, whose counts are not those to come. The width and the play stay.
    pub(crate) const fn forget_counts(&mut self) {
        self.along = None;
        self.is_awaited = false;
    }

    /// Notes if the frame has led across the mark against the axis. A crossing is awaited where
    /// there have been any: a drive may latch those along the axis alone.
    pub(crate) const fn expect(&mut self, is_expected: bool) {
        self.is_awaited = is_expected && self.has_reference();
    }

    /// Returns `true` if there is a pair that others are compared with.
    pub(crate) const fn has_reference(&self) -> bool {
        self.reference.is_some()
    }

    /// Returns `true` if the last pair was outside the tolerance.
    pub(crate) const fn disagrees(&self) -> bool {
        self.disagrees
    }

    /// Takes a crossing along the axis; `None` is one that did not agree with the mark. Returns
    /// `true` if the last frame has led across the mark against the axis and no crossing came.
    pub(crate) fn cross_along(&mut self, agreed: Option<Passage>) -> bool {
        self.along = agreed;
        let is_seen = core::mem::replace(&mut self.is_seen, false);
        core::mem::replace(&mut self.is_awaited, false) && !is_seen
    }

    /// Takes a crossing against the axis; `is_play_held` if σ of the records holds that of the play
    /// ([`is_play_in_error`]). Returns `None` if there is nothing to compare it with.
    pub(crate) fn cross_against(
        &mut self,
        crossing: &Crossing,
        drive: &DriveSettings,
        is_play_held: bool,
    ) -> Option<Compared> {
        self.is_seen = true;
        let along = self.along?;
        let against = crossing.passage(drive);
        let latest = Passage {
            place_mm: against.place_mm - along.place_mm,
            speed_mm_s: along.speed_mm_s - against.speed_mm_s,
            change_mm_s: along.change_mm_s + against.change_mm_s,
            bend_mm_s: along.bend_mm_s + against.bend_mm_s,
        };
        let Some(reference) = self.reference else {
            self.reference = Some(latest);
            return None;
        };
        let off_mm = latest.place_mm - reference.place_mm;
        let steps_mm = steps_mm(drive);
        let of_age_mm = drive.reading_age_sigma_s * (latest.speed_mm_s - reference.speed_mm_s);
        let of_mark_mm = core::f32::consts::SQRT_2 * 1e-3 * drive.index_sigma_um;
        let tolerance_mm = steps_mm
            + AGREE_SIGMA * libm::hypotf(of_mark_mm, of_age_mm)
            + uneven_mm(drive, latest.change_mm_s + reference.change_mm_s);
        let beyond_mm = (libm::fabsf(off_mm) - steps_mm).max(0.0);
        let agrees = libm::fabsf(off_mm) <= tolerance_mm;
        let of_play_mm = if is_play_held {
            PLAY_SIGMA_PART * drive.unseen_play_mm()
        } else {
            0.0
        };
        let held_mm = libm::hypotf(UNSEEN_PART * tolerance_mm, of_play_mm);
        let covered_mm = SUSPECT_SIGMA * libm::hypotf(held_mm, self.off_mm);
        self.disagrees = !agrees;
        self.off_mm = if agrees {
            OFF_PART * beyond_mm
        } else {
            beyond_mm
        };
        // A play that grows slowly takes its own reference along at most as often as this.
        let is_slower = latest.speed_mm_s < SLOWER_PART * reference.speed_mm_s;
        if beyond_mm <= 0.0 && is_slower && latest.is_better_than(&reference) {
            self.reference = Some(latest);
        }
        Some(Compared {
            off_mm,
            agrees,
            is_covered: agrees || beyond_mm <= covered_mm,
        })
    }

    /// Returns σ of a play that has grown, mm.
    pub(crate) const fn off_mm(&self) -> f32 {
        self.off_mm
    }
}

/// Returns `true` if play that has grown is in the error of records of a flight in a direction, -1
/// against the FMC axis.
pub(crate) fn is_play_in_error(drive: &DriveSettings, is_pushed_along: bool, sign: f32) -> bool {
    drive.encoder_side == EncoderSide::Screw && (sign < 0.0 || !is_pushed_along)
}

#[cfg(test)]
mod tests;
