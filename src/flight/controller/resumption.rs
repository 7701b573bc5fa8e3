//! The state of a flight that outlives a reset of the camera.

use super::Controller;
use super::readiness::Mode;
use crate::flight::calibration_id::CalibrationId;
use crate::flight::fault::{Fault, Faults};
use crate::flight::flown_calibrations::{EarlierList, FlownCalibrations};
use crate::flight::frame_record::{Flags, Outcome, Reason};
use crate::flight::in_doubt::InDoubt;
use crate::flight::lens_temperature::LensTemperature;
use crate::flight::record_log::{Entry, Extent, RecordLog, Slot, Unkept};
use crate::flight::time::Time;

/// State of a flight that the same camera takes over after a reset, besides settings and records.
///
/// Place of the stage, V/H, UTC and the learned motion are not among it: they come anew.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct FlightState {
    /// The camera is armed, or will be by itself when a fault has ended.
    pub(crate) is_flying: bool,
    /// Bits of the exposure time of the frames to come, s: a NaN is the same as itself.
    exposure_bits: u32,
    /// Those of their focus shift, µm.
    focus_shift_bits: u32,
    /// Those of the temperature of the lens, °C; `None` if none was told.
    temperature_bits: Option<u32>,
    /// Numbers of triggers, of records with an exposure, of records without, and of edges of the
    /// shutter that the camera had not commanded.
    counts: [u32; 4],
    /// Number of events for which there was no place.
    lost_events: u32,
    pub(crate) records: Extent,
    /// Exposures in doubt, with those that a crossing of the index mark is still to confirm: none
    /// will come before somebody may have moved the stage.
    pub(crate) in_doubt: Option<InDoubt>,
}

#[cfg(feature = "store")]
impl FlightState {
    /// State of a flight that has ended without supply, of its records, the number of those with an
    /// exposure, and the exposures in doubt.
    pub(crate) const fn ended(records: Extent, exposed: u32, in_doubt: Option<InDoubt>) -> Self {
        let triggers = records.last_sequence;
        Self {
            is_flying: false,
            exposure_bits: 0,
            focus_shift_bits: 0,
            temperature_bits: None,
            counts: [triggers, exposed, triggers.saturating_sub(exposed), 0],
            lost_events: 0,
            records,
            in_doubt,
        }
    }
}

/// Records in flash.
#[cfg(feature = "store")]
impl Controller {
    /// Exposures that a crossing of the index mark is still to confirm.
    pub(crate) fn unconfirmed(&self) -> Option<InDoubt> {
        let mut unconfirmed = self.stage.unconfirmed;
        unconfirmed.take()
    }

    /// Numbers of the records that are not acknowledged.
    pub(crate) fn extent(&self) -> Extent {
        self.frame.kept.records().extent()
    }

    /// Returns a finished record that the flash does not have as it is.
    pub(crate) fn next_unwritten(&mut self) -> Option<(Entry, u32)> {
        self.records_mut().next_unwritten()
    }

    /// Notes that a record is written as it is.
    pub(crate) fn note_written(&mut self, sequence: u32) {
        self.records_mut().note_written(sequence);
    }

    /// Notes a record that the flash has.
    pub(crate) fn note_found(&mut self, record: &Entry, boot: u32) {
        self.records_mut().note_found(record, boot);
    }

    /// Number of records that the flash does not have as they are.
    pub(crate) fn unwritten(&self) -> u32 {
        self.frame.kept.records().unwritten()
    }
}

impl Controller {
    /// The state that outlives a reset.
    pub(crate) fn flight_state(&self) -> FlightState {
        let mut unconfirmed = self.stage.unconfirmed;
        let in_doubt = match (self.stage.index.in_doubt(), unconfirmed.take()) {
            (Some(doubted), Some(waiting)) => Some(doubted.with(waiting)),
            (doubted, waiting) => doubted.or(waiting),
        };
        FlightState {
            is_flying: self.readiness.is_flying(),
            exposure_bits: self.exposure_s.to_bits(),
            focus_shift_bits: self.focus_shift_um.to_bits(),
            temperature_bits: self.temperature.bits(),
            counts: self.frame.kept.counts(),
            lost_events: self.readiness.lost_events(),
            records: self.frame.kept.records().extent(),
            in_doubt,
        }
    }

    /// Time of the last event; `None` before the first.
    pub(crate) const fn last_event(&self) -> Option<Time> {
        self.readiness.last_event()
    }

    /// Returns a record that has changed since it was copied; the oldest first.
    pub(crate) fn next_unkept(&mut self) -> Option<Unkept> {
        self.records_mut().next_unkept()
    }

    /// Notes that a record has been copied as it is.
    pub(crate) fn note_kept(&mut self, sequence: u32, slot: Slot) {
        self.records_mut().note_kept(sequence, slot);
    }

    /// The calibrations of records before the present one was put into use.
    pub(crate) const fn earlier_calibrations(&self) -> EarlierList {
        self.calibrations.earlier()
    }

    /// Sets the number of the camera's start.
    pub(in crate::flight) const fn set_boot(&mut self, boot: u32) {
        self.records_mut().set_boot(boot);
    }

    /// Takes over the state of the flight before the reset, after the controller has been
    /// restarted, and its earlier calibrations. Its records follow by [`Self::take_up`].
    pub(crate) fn take_over(&mut self, state: &FlightState, earlier: EarlierList) {
        self.calibrations.take_over(earlier);
        self.exposure_s = f32::from_bits(state.exposure_bits);
        self.focus_shift_um = f32::from_bits(state.focus_shift_bits);
        self.temperature = LensTemperature::held(state.temperature_bits);
        self.frame.kept.resume(state.counts, &state.records);
        self.readiness.lose(state.lost_events);
        let next = state.records.last_sequence.saturating_add(1);
        self.stage.index.begin_at(next);
    }

    /// Leaves the exposures in doubt that were so before the reset, once their records have been
    /// taken up.
    pub(crate) fn doubt_again(&mut self, exposures: InDoubt) {
        self.stage.index.doubt(exposures);
        self.records_mut().doubt(&exposures);
    }

    /// Takes over the next record of the flight before the reset. Returns `false` if there is no
    /// room for it.
    pub(crate) fn take_up(&mut self, record: Entry, boot: u32, slot: Option<Slot>) -> bool {
        self.records_mut().take_up(record, boot, slot)
    }

    /// Takes over a trigger, by its number and that of its start, whose record the reset has ended,
    /// or damaged: an image of it may exist.
    pub(crate) fn take_up_unfinished(
        &mut self,
        [sequence, boot]: [u32; 2],
        trigger: Time,
        slot: Option<Slot>,
    ) -> bool {
        let mut faults = Faults::NONE;
        faults.insert(Fault::Watchdog);
        let record = Entry {
            sequence,
            trigger,
            outcome: Outcome::Refused(Reason::Unusable),
            faults,
            flags: Flags::NONE,
        };
        self.take_up(record, boot, slot)
    }

    /// Holds the records of a flight that cannot go on, in a camera that is not prepared.
    pub(in crate::flight) fn hold(&mut self, calibration: CalibrationId) {
        self.frame.restart(Faults::NONE);
        self.readiness.set_mode(Mode::Standby);
        self.calibrations = FlownCalibrations::new(Some(calibration));
    }

    /// Forgets all records.
    pub(in crate::flight) fn forget_records(&mut self) {
        self.records_mut().restart();
    }

    const fn records_mut(&mut self) -> &mut RecordLog {
        self.frame.kept.records_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::unconfirmed::Waiting;

    #[test]
    fn exposure_that_waits_for_a_crossing_is_in_doubt_after_the_reset() {
        let mut before = Controller::new();
        assert_eq!(before.flight_state().in_doubt, None);
        before.stage.unconfirmed.wait(&Waiting {
            sequence: 7,
            is_referenced: true,
            awaits_pair: false,
            lost_mm: 0.009,
        });
        let waiting = InDoubt::between([7; 2], 0.009, false);
        assert_eq!(before.flight_state().in_doubt, Some(waiting));
        before
            .stage
            .index
            .doubt(InDoubt::between([3, 5], 0.004, true));
        let in_doubt = before.flight_state().in_doubt.unwrap();
        assert!(in_doubt.contains(3) && in_doubt.contains(7) && in_doubt.is_fault);
        // To keep it leaves the camera as it is.
        assert_eq!(before.flight_state().in_doubt, Some(in_doubt));
        let mut again = Controller::new();
        again.take_over(&before.flight_state(), before.earlier_calibrations());
        again.doubt_again(in_doubt);
        assert_eq!(again.in_doubt(), Some(in_doubt));
    }

    #[test]
    fn events_that_were_lost_before_the_reset_are_counted_after_it() {
        let mut before = Controller::new();
        before.readiness.lose(7);
        let mut again = Controller::new();
        again.take_over(&before.flight_state(), before.earlier_calibrations());
        again.readiness.lose(2);
        assert_eq!(again.counts().lost_events, 9);
    }
}
