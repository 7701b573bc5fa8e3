//! Copies of the records in a ring of the flash, which outlasts the supply.

use super::records_in_flash::RecordsInFlash;
use super::ring_contents::{EarlierNumbers, FlightNow, Kind, RingContents, Unconfirmed, relative};
use crate::flight::calibration_id::CalibrationId;
use crate::flight::controller::Controller;
use crate::flight::record_log::Range;
use crate::flight::time::Time;
use crate::io::store::record_flash::RecordFlash;
use crate::io::store::record_ring::{CONTENTS_BYTES, Erasing, RecordRing, RingState};

/// Time after which triggers that are refused for want of room are written again, s: they may come
/// in every round.
const REFUSED_EVERY_S: f32 = 1.0;

/// Copies of the records.
#[derive(Debug)]
pub(super) struct RecordKeeper {
    /// State of the ring; `None` in a camera without.
    pub(super) state: Option<RingState>,
    /// The ring holds an entry that is not written to its end.
    is_writing: bool,
    /// State of the flight by the last entry.
    told: Option<Told>,
    /// Time at which the last one of refused triggers was written.
    refused_at: Option<Time>,
}

/// State of a flight by an entry.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Told {
    boot: u32,
    /// Sector in which an entry has told the calibration.
    sector: u32,
    now: FlightNow,
    refused: Option<Range>,
    calibration: Option<CalibrationId>,
}

impl RecordKeeper {
    /// No ring.
    pub(super) const NONE: Self = Self {
        state: None,
        is_writing: false,
        told: None,
        refused_at: None,
    };

    /// Carries the ring's work on by a step, and hands it what is to be written.
    pub(super) fn keep<F: RecordFlash>(
        &mut self,
        ring: &mut RecordRing<F>,
        boot: u32,
        is_supply_good: bool,
        controller: Option<&mut Controller>,
    ) {
        let is_busy = controller.as_ref().map(|it| it.is_busy());
        let state = ring.step(match is_busy.filter(|_| is_supply_good) {
            Some(false) => Erasing::Ahead,
            Some(true) => Erasing::AtNeed,
            // Without a flight there is nothing to write.
            None => Erasing::Never,
        });
        self.state = Some(state);
        if state == RingState::Idle
            && let Some(controller) = controller
        {
            self.write_next(ring, boot, controller);
        }
        self.is_writing = ring.holds_entry();
    }

    /// Hands the ring its next entry, if there is any.
    #[inline]
    fn write_next<F: RecordFlash>(
        &mut self,
        ring: &mut RecordRing<F>,
        boot: u32,
        controller: &mut Controller,
    ) {
        let extent = controller.extent();
        let last_sequence = extent.last_sequence;
        let told = Told {
            boot,
            sector: RecordRing::<F>::sector_of(ring.next()),
            now: FlightNow {
                number: controller.flight(),
                is_busy: controller.is_busy(),
                exposed: controller.counts().exposed,
                acknowledged: extent.first_left.saturating_sub(1),
                unconfirmed: Unconfirmed::of(controller.unconfirmed(), last_sequence),
            },
            refused: extent.refused,
            calibration: controller.calibration(),
        };
        let now = controller.last_event();
        // Without its calibration no record is of use; the rest may follow it.
        let is_first = self.told.is_none_or(|it| {
            it.now.number != told.now.number || it.calibration != told.calibration
        });
        let unwritten = controller.next_unwritten().filter(|_| !is_first);
        if let Some((record, boot)) = unwritten {
            let contents = RingContents {
                boot,
                flight: told.now,
                kind: Kind::Record(relative(record)),
            };
            push(ring, &contents);
            controller.note_written(record.sequence);
            if let Some(before) = &mut self.told {
                before.now = told.now;
            }
        } else if self.is_to_tell(&told, now, controller.kept() == 0) {
            let Some(calibration) = told.calibration else {
                return;
            };
            let earlier = controller
                .earlier_calibrations()
                .map(|earlier| earlier.map(|it| EarlierNumbers::of(it, calibration)));
            let contents = RingContents {
                boot,
                flight: told.now,
                kind: Kind::Flight {
                    calibration,
                    earlier,
                    last_sequence,
                    refused: extent.refused,
                },
            };
            push(ring, &contents);
            self.refused_at = now;
            self.told = Some(told);
        }
    }

    /// Notes what an earlier start has told of a flight, in a sector and since.
    pub(super) const fn note_told(
        &mut self,
        (boot, sector, now): (u32, u32, FlightNow),
        calibration: CalibrationId,
    ) {
        self.told = Some(Told {
            boot,
            sector,
            now,
            refused: None,
            calibration: Some(calibration),
        });
    }

    /// Returns `true` if the flight's state is to be written by itself.
    fn is_to_tell(&self, told: &Told, now: Option<Time>, are_all_acknowledged: bool) -> bool {
        let Some(before) = &self.told else {
            return true;
        };
        let has_begun = before.now.number != told.now.number
            || before.calibration != told.calibration
            || before.boot != told.boot
            || before.sector != told.sector;
        let is_refused = before.refused != told.refused && self.is_long_ago(now);
        // In flight the next record tells it.
        let has_ended = !told.now.is_busy
            && (before.now.is_busy
                || before.now.unconfirmed != told.now.unconfirmed
                || are_all_acknowledged && before.now.acknowledged != told.now.acknowledged);
        has_begun || is_refused || has_ended
    }

    fn is_long_ago(&self, now: Option<Time>) -> bool {
        match (self.refused_at, now) {
            (Some(before), Some(now)) => now.seconds_since(before) > REFUSED_EVERY_S,
            _ => true,
        }
    }

    /// Copies of a controller's records.
    pub(super) fn in_flash(&self, controller: &Controller) -> RecordsInFlash {
        match self.state {
            None => RecordsInFlash::NotKept,
            Some(RingState::Worn) => RecordsInFlash::Worn,
            Some(_) => {
                // One that is being written counts as written by the log.
                let being_written = u32::from(self.is_writing);
                let behind = controller.unwritten().saturating_add(being_written);
                RecordsInFlash::AllBut(behind.min(controller.kept()))
            }
        }
    }
}

#[inline(never)]
fn push<F: RecordFlash>(ring: &mut RecordRing<F>, contents: &RingContents) {
    let mut buffer = [0; CONTENTS_BYTES];
    if let Ok(bytes) = postcard::to_slice(contents, &mut buffer) {
        ring.push(bytes);
    }
}
