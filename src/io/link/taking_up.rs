//! The flight before a reset, from memory that the reset has left alone.

use super::after_reset::{AfterReset, FlightAfterReset, RESETS_IN_A_ROW, WithoutEyes};
use super::deck::FlightDeck;
use super::digest;
use super::flight_memory::{FlightMemory, KeptFlight, KeptHead};
use super::loading;
use super::message::{Refusal, ResetCause};
use super::packet::CRC;
use super::responder::Responder;
use crate::flight::calibration_id::{CalibrationId, Storage};
use crate::flight::camera::Camera;
use crate::flight::controller::Controller;
use crate::flight::record_log::{CAPACITY, SLOTS};
use crate::flight::settings::FlightSettings;
use crate::flight::time::Time;

/// Records that have been taken up.
#[derive(Debug, Clone, Copy, Default)]
struct TakenUp {
    unfinished: u32,
    damaged: u32,
}

impl<Deck: FlightDeck> Responder<Deck> {
    /// Takes up what the memory has, and keeps the flight there from now on.
    #[inline(never)]
    pub(super) fn keep_flight_in(&mut self, memory: &'static FlightMemory) -> AfterReset {
        let build = CRC.checksum(self.identity.build.as_bytes());
        let found = memory.head();
        let keeper = &mut self.keeper;
        keeper.memory = Some(memory);
        keeper.head.build = build;
        let outcome = match found {
            Some(head) if head.build == build => {
                keeper.head = KeptHead {
                    boot: head.boot.saturating_add(1),
                    has_round: false,
                    prepared: None,
                    ..head
                };
                None
            }
            Some(_) => Some(FlightAfterReset::OtherBuild),
            None if self.identity.reset_cause == ResetCause::PowerOn => {
                Some(FlightAfterReset::Nothing)
            }
            None => Some(FlightAfterReset::Damaged),
        };
        let KeptHead { boot, flight, .. } = self.keeper.head;
        self.deck.count_from(boot, flight);
        let flight = found.and_then(|head| head.prepared);
        let last_round = flight.and_then(|_| memory.time());
        let (outcome, taken_up) = match (outcome, flight) {
            (Some(outcome), _) => {
                // Records of another numbering would be taken for those of this one.
                memory.clear();
                self.keeper.write_head();
                (outcome, TakenUp::default())
            }
            (None, None) => {
                self.keeper.write_head();
                (FlightAfterReset::Nothing, TakenUp::default())
            }
            (None, Some(flight)) => self.take_up(memory, flight),
        };
        let had_round = found.is_some_and(|head| head.has_round);
        let without_eyes = match (outcome, self.keeper.reset_ms) {
            (FlightAfterReset::Nothing, _) => WithoutEyes::NoFlight,
            (FlightAfterReset::OtherBuild | FlightAfterReset::Damaged, _) => WithoutEyes::Unknown,
            // A start without a round may have lasted for any time.
            (_, Some(before_clock_ms)) if had_round => WithoutEyes::GoesOn { before_clock_ms },
            _ => WithoutEyes::Unknown,
        };
        let records = self.deck.record_holder().map_or(0, Controller::kept);
        let after_reset = AfterReset {
            boot: self.keeper.head.boot,
            flight: self.keeper.head.flight,
            outcome,
            last_round,
            records,
            unfinished: taken_up.unfinished,
            damaged: taken_up.damaged,
            without_eyes,
        };
        self.identity.after_reset = after_reset;
        after_reset
    }

    /// Takes a flight up: prepares the camera as it was, armed if it was, or holds the records.
    fn take_up(
        &mut self,
        memory: &'static FlightMemory,
        flight: KeptFlight,
    ) -> (FlightAfterReset, TakenUp) {
        let (mut outcome, mut kept) = (FlightAfterReset::StandsBy, flight);
        if flight.state.is_flying {
            outcome = FlightAfterReset::FliesOn;
            if self.keeper.head.resumed >= RESETS_IN_A_ROW {
                outcome = FlightAfterReset::ResetAgain;
            }
        }
        kept.state.is_flying &= outcome == FlightAfterReset::FliesOn;
        // It is counted before anything is done that may lead to the same reset.
        let before = self.keeper.head.resumed;
        self.keeper.head.resumed = before.saturating_add(1);
        self.keeper.head.prepared = Some(kept);
        self.keeper.write_head();
        let prepared = if before > RESETS_IN_A_ROW {
            // To be prepared may be what leads to the reset.
            Err(FlightAfterReset::ResetAgain)
        } else {
            self.prepare_again(memory, &flight, outcome)
        };
        let outcome = prepared.unwrap_or_else(|refused| {
            self.deck.hold_records(flight.calibration);
            refused
        });
        if let Some(prepared) = &mut self.keeper.head.prepared {
            prepared.state.is_flying &= outcome == FlightAfterReset::FliesOn;
        }
        self.keeper.write_head();
        (outcome, self.take_up_records(memory, &flight))
    }

    #[inline(never)]
    fn prepare_again(
        &mut self,
        memory: &'static FlightMemory,
        flight: &KeptFlight,
        outcome: FlightAfterReset,
    ) -> Result<FlightAfterReset, FlightAfterReset> {
        self.calibrate_again(memory, flight)?;
        let settings = memory.settings::<FlightSettings>(flight.settings);
        let settings = settings.ok_or(FlightAfterReset::SettingsDamaged)?;
        let outcome = match outcome {
            FlightAfterReset::FliesOn if !settings.flies_on_after_reset => {
                FlightAfterReset::SwitchedOff
            }
            other => other,
        };
        let flies_on = outcome == FlightAfterReset::FliesOn;
        let prepared = self.deck.prepare_after_reset(&settings, flies_on);
        prepared.map_err(|_| FlightAfterReset::NotFlyable)?;
        Ok(outcome)
    }

    /// Puts the calibration of the flight into use, unless it is: one that was stored comes from
    /// the store.
    #[inline(never)]
    fn calibrate_again(
        &mut self,
        memory: &'static FlightMemory,
        flight: &KeptFlight,
    ) -> Result<(), FlightAfterReset> {
        let calibration = &flight.calibration;
        let in_use = self.deck.camera().and_then(Camera::id);
        if in_use.as_ref() == Some(calibration) {
            return Ok(());
        }
        if calibration.storage == Storage::Stored {
            return Err(FlightAfterReset::NoCalibration);
        }
        if flight.has_grids {
            return Err(FlightAfterReset::NoGrids);
        }
        let parameters = memory.parameters(calibration.crc, loading::parameters);
        let parameters = parameters.ok_or(FlightAfterReset::NoCalibration)?;
        if digest::of_camera(&parameters) != calibration.crc {
            return Err(FlightAfterReset::NoCalibration);
        }
        let loaded: Result<CalibrationId, Refusal> =
            self.put_into_use(&parameters, calibration.crc, Storage::Volatile, false);
        match loaded {
            Ok(loaded) if loaded == *calibration => Ok(()),
            _ => Err(FlightAfterReset::NoCalibration),
        }
    }

    /// Hands the records to the controller, in order of their numbers. A trigger whose record is
    /// not whole gets one that says so.
    #[inline(never)]
    fn take_up_records(&mut self, memory: &'static FlightMemory, flight: &KeptFlight) -> TakenUp {
        let mut taken_up = TakenUp::default();
        let flight_number = self.keeper.head.flight;
        let Some(controller) = self.deck.record_holder_mut() else {
            return taken_up;
        };
        let before = self.keeper.head.boot.saturating_sub(1);
        let mut state = flight.state;
        let found = newest(memory, flight_number);
        // A trigger may have come after the state was written.
        let first = state.records.first_left;
        let last = found.iter().flatten().map(|(sequence, _)| *sequence);
        let last = last.max().unwrap_or(0).max(state.records.last_sequence);
        let end = if let Some(range) = state.records.refused {
            range.first_sequence
        } else {
            state.records.last_sequence = last;
            last.saturating_add(1)
        };
        controller.take_over(&state, flight.earlier);
        for sequence in (first..end).take(CAPACITY) {
            let slots = (0..).zip(&found);
            let mut whole =
                slots.filter(|(_, found)| found.is_some_and(|(found, _)| found == sequence));
            let slot = whole.next().map(|(slot, _)| slot);
            let record = slot.and_then(|slot| memory.record(slot));
            match record {
                Some(kept) if !kept.is_pending => {
                    controller.take_up(kept.record, kept.boot, slot);
                }
                Some(kept) => {
                    taken_up.unfinished = taken_up.unfinished.saturating_add(1);
                    let numbers = [sequence, kept.boot];
                    controller.take_up_unfinished(numbers, kept.record.trigger, slot);
                }
                None => {
                    taken_up.damaged = taken_up.damaged.saturating_add(1);
                    let numbers = [sequence, before];
                    controller.take_up_unfinished(numbers, Time::START, None);
                }
            }
        }
        if let Some(exposures) = state.in_doubt {
            controller.doubt_again(exposures);
        }
        taken_up
    }
}

/// Returns number and writing of the record in each slot, of a flight; of two copies of a record
/// the newer one.
fn newest(memory: &FlightMemory, flight: u32) -> [Option<(u32, u32)>; SLOTS] {
    let mut found = [None; SLOTS];
    for slot in 0..u8::try_from(SLOTS).unwrap_or(0) {
        let kept = memory.record(slot).filter(|kept| kept.flight == flight);
        let Some(kept) = kept else {
            continue;
        };
        let this = (kept.record.sequence, kept.writing);
        let other = found
            .iter_mut()
            .find(|other| other.is_some_and(|(sequence, _)| sequence == this.0));
        if let Some(other) = other {
            if other.is_some_and(|(_, writing)| writing > this.1) {
                continue;
            }
            *other = None;
        }
        if let Some(place) = found.get_mut(usize::from(slot)) {
            *place = Some(this);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::fault::Faults;
    use crate::flight::flag::Flags;
    use crate::flight::frame_record::{Outcome, Reason};
    use crate::flight::record_log::Entry;
    use crate::io::link::flight_memory::KeptRecord;

    fn copy(writing: u32) -> KeptRecord {
        KeptRecord {
            flight: 7,
            writing,
            is_pending: false,
            boot: 3,
            record: Entry {
                sequence: 12,
                trigger: Time::from_us(1_234_567),
                outcome: Outcome::Refused(Reason::Overlap),
                faults: Faults::NONE,
                flags: Flags::NONE,
            },
        }
    }

    #[test]
    fn of_two_copies_of_a_record_the_newer_one_is_found_in_whichever_place_it_is() {
        for (writings, newer) in [([5, 6], 3), ([6, 5], 1)] {
            let memory = FlightMemory::blank();
            for (slot, writing) in [1, 3].into_iter().zip(writings) {
                memory.write_record(&copy(writing), slot, None);
            }
            let found = newest(&memory, 7).into_iter().zip(0..);
            let found: std::vec::Vec<_> = found.filter_map(|(one, at)| Some((at, one?))).collect();
            assert_eq!(found, [(newer, (12, 6))]);
            assert_eq!(newest(&memory, 8), [None; SLOTS]);
        }
    }
}
