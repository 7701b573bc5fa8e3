//! The records of a flight from a ring of the flash, at the start.

use super::after_reset::{AfterReset, FlightAfterReset, WithoutEyes};
use super::deck::FlightDeck;
use super::responder::Responder;
use super::ring_contents::{FlightNow, Kind, RingContents, absolute};
use crate::flight::calibration_id::CalibrationId;
use crate::flight::controller::{Controller, FlightState};
use crate::flight::flown_calibrations::{EARLIER_CALIBRATIONS, EarlierList};
use crate::flight::record_log::{CAPACITY, Entry, Extent, Range};
use crate::flight::time::Time;
use crate::io::store::record_flash::RecordFlash;
use crate::io::store::record_ring::RecordRing;

/// Sectors in which the entries of a flight are looked for: each has its calibration.
const SECTORS: u32 = 2;

/// The last flight of which the ring has entries.
#[derive(Debug, Clone, Copy)]
struct LastFlight {
    /// Highest number of a start.
    boot: u32,
    now: FlightNow,
    /// The calibration, and the place of an entry that has it.
    calibration: Option<(CalibrationId, u32)>,
    /// Those before it in the flight.
    earlier: EarlierList,
    last_sequence: u32,
    refused: Option<Range>,
    /// Place of the newest entry of all: its last word may have been cut, and read otherwise later.
    newest: u32,
    /// Place of the newest entry of each record that is not acknowledged.
    places: [Option<u32>; CAPACITY],
}

impl LastFlight {
    /// The flight of the newest entry.
    const fn of(place: u32, newest: &RingContents) -> Self {
        Self {
            boot: newest.boot,
            now: newest.flight,
            calibration: None,
            earlier: [None; EARLIER_CALIBRATIONS],
            last_sequence: 0,
            refused: None,
            newest: place,
            places: [None; CAPACITY],
        }
    }

    /// Number of the oldest record that is not acknowledged.
    const fn first_left(&self) -> u32 {
        self.now.acknowledged.saturating_add(1)
    }

    /// Takes an older entry; returns `false` if no older one is wanted.
    fn add(&mut self, place: u32, contents: &RingContents) -> bool {
        if contents.flight.number != self.now.number {
            return false;
        }
        self.boot = self.boot.max(contents.boot);
        match contents.kind {
            Kind::Flight {
                calibration,
                earlier,
                last_sequence,
                refused,
            } => {
                if self.calibration.is_none() {
                    self.calibration = Some((calibration, place));
                    self.earlier = earlier.map(|it| it.map(|it| it.earlier(calibration)));
                    self.refused = refused;
                }
                self.last_sequence = self.last_sequence.max(last_sequence);
            }
            Kind::Record(record) => {
                self.last_sequence = self.last_sequence.max(record.sequence);
                let index = record.sequence.checked_sub(self.first_left());
                let index = index.and_then(|index| usize::try_from(index).ok());
                if let Some(found) = index.and_then(|index| self.places.get_mut(index)) {
                    // Of several entries of a record the newest has come first.
                    found.get_or_insert(place);
                }
            }
        }
        self.is_incomplete()
    }

    /// Returns `true` while the calibration, or a record that is not acknowledged, is wanted.
    fn is_incomplete(&self) -> bool {
        let left = self.end().saturating_sub(self.first_left());
        let left = usize::try_from(left).unwrap_or(usize::MAX);
        self.calibration.is_none() || self.places.iter().take(left).any(Option::is_none)
    }

    /// Number behind the last whole record.
    fn end(&self) -> u32 {
        match &self.refused {
            Some(range) => range.first_sequence,
            None => self.last_sequence.saturating_add(1),
        }
    }

    /// Places of records that have been written to their ends.
    fn whole(&self) -> impl Iterator<Item = &u32> {
        let places = self.places.iter().flatten();
        places.filter(|place| **place != self.newest)
    }

    /// The records that are not acknowledged.
    fn extent(&self) -> Extent {
        let refused = self.refused.filter(|range| {
            let last = self.last_sequence;
            range.first_sequence <= last && last > self.now.acknowledged
        });
        Extent {
            first_left: self.first_left(),
            last_sequence: self.last_sequence,
            refused,
        }
    }
}

impl<Deck: FlightDeck> Responder<Deck> {
    /// Carries the work of the ring on.
    #[inline]
    pub(super) fn keep_records<F: RecordFlash>(&mut self, ring: &mut RecordRing<F>) {
        let is_supply_good = self.deck.is_supply_good();
        let boot = self.keeper.head.boot;
        let holder = self.deck.record_holder_mut();
        self.records.keep(ring, boot, is_supply_good, holder);
    }

    /// Takes up what the ring has of the last flight: its numbers, and its records unless memory
    /// has had them. It comes after [`Self::keep_flight_in`].
    #[inline(never)]
    pub(super) fn keep_records_in<F: RecordFlash>(
        &mut self,
        ring: &mut RecordRing<F>,
    ) -> AfterReset {
        self.records.state = Some(ring.state());
        if let Some(found) = find(ring) {
            if let Some((calibration, place)) = found.calibration {
                let sector = RecordRing::<F>::sector_of(place);
                let told = (found.boot, sector, found.now);
                self.records.note_told(told, calibration);
            }
            if self.deck.record_holder().is_some() {
                self.note_found(ring, &found);
            } else {
                self.take_up_last(ring, &found);
            }
        }
        self.identity.after_reset
    }

    /// Notes which of the records that memory has had are in the ring, so that they are not written
    /// again at every start.
    #[inline(never)]
    fn note_found<F: RecordFlash>(&mut self, ring: &mut RecordRing<F>, found: &LastFlight) {
        let Some(controller) = self.deck.record_holder_mut() else {
            return;
        };
        if controller.flight() != found.now.number {
            return;
        }
        for place in found.whole() {
            if let Some((record, boot)) = record(ring, *place) {
                controller.note_found(&record, boot);
            }
        }
    }

    /// Counts on from the last flight, and holds its records.
    #[inline(never)]
    fn take_up_last<F: RecordFlash>(&mut self, ring: &mut RecordRing<F>, found: &LastFlight) {
        let head = &mut self.keeper.head;
        head.boot = head.boot.max(found.boot.saturating_add(1));
        head.flight = head.flight.max(found.now.number);
        let (boot, flight) = (head.boot, head.flight);
        self.keeper.write_head();
        self.deck.count_from(boot, flight);
        let after_reset = &mut self.identity.after_reset;
        (after_reset.boot, after_reset.flight) = (boot, flight);
        if found.now.number != flight {
            // Memory has had a later one, and nothing is left of it.
            return;
        }
        let extent = found.extent();
        let is_left = extent.last_sequence >= extent.first_left;
        if !is_left && !found.now.is_busy {
            return;
        }
        after_reset.outcome = FlightAfterReset::FromFlash;
        after_reset.without_eyes = WithoutEyes::Unknown;
        if let Some((calibration, _)) = found.calibration.filter(|_| is_left) {
            self.hold_last(ring, found, calibration, &extent);
        }
    }

    #[inline(never)]
    fn hold_last<F: RecordFlash>(
        &mut self,
        ring: &mut RecordRing<F>,
        found: &LastFlight,
        calibration: CalibrationId,
        extent: &Extent,
    ) {
        self.deck.hold_records(calibration);
        let Some(controller) = self.deck.record_holder_mut() else {
            return;
        };
        let unconfirmed = found.now.unconfirmed;
        let in_doubt = unconfirmed.map(|it| it.in_doubt(found.last_sequence));
        let state = FlightState::ended(*extent, found.now.exposed, in_doubt);
        controller.take_over(&state, found.earlier);
        let (mut damaged, mut last) = (0_u32, None);
        for (sequence, place) in (extent.first_left..found.end()).zip(found.places) {
            if let Some((record, boot)) = place.and_then(|place| record(ring, place)) {
                last = Some(record.trigger);
                controller.take_up(record, boot, None);
                if place != Some(found.newest) {
                    controller.note_written(sequence);
                }
            } else {
                damaged = damaged.saturating_add(1);
                controller.take_up_unfinished([sequence, found.boot], Time::START, None);
            }
        }
        if let Some(exposures) = in_doubt {
            controller.doubt_again(exposures);
        }
        let records = self.deck.record_holder().map_or(0, Controller::kept);
        let after_reset = &mut self.identity.after_reset;
        after_reset.records = records;
        after_reset.damaged = damaged;
        after_reset.last_round = last;
    }
}

/// Finds the last flight in a ring; `None` if it has no entries.
#[inline(never)]
fn find<F: RecordFlash>(ring: &mut RecordRing<F>) -> Option<LastFlight> {
    let mut found: Option<LastFlight> = None;
    let most = SECTORS.saturating_mul(RecordRing::<F>::ENTRIES);
    ring.newest_first(most, |place, bytes| {
        let Ok(contents) = postcard::from_bytes::<RingContents>(bytes) else {
            return true;
        };
        let flight = found.get_or_insert_with(|| LastFlight::of(place, &contents));
        flight.add(place, &contents)
    });
    found
}

/// Returns the record in a place, and the number of its start.
#[inline(never)]
fn record<F: RecordFlash>(ring: &mut RecordRing<F>, place: u32) -> Option<(Entry, u32)> {
    let entry = ring.read(place)?;
    let contents: RingContents = postcard::from_bytes(entry.contents()).ok()?;
    match contents.kind {
        Kind::Record(record) => Some((absolute(record), contents.boot)),
        Kind::Flight { .. } => None,
    }
}
