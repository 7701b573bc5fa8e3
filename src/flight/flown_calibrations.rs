//! Calibrations of a flight: the present one, and those of earlier records.

use super::calibration_id::CalibrationId;

/// Most calibrations before the present one with which records that are left have been made.
pub const EARLIER_CALIBRATIONS: usize = 3;

/// A calibration that another has taken the place of in the flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Earlier {
    /// Number of the last trigger before the exchange.
    pub(crate) last_sequence: u32,
    pub(crate) id: Option<CalibrationId>,
}

/// The earlier calibrations, in order; first those that are there.
pub(crate) type EarlierList = [Option<Earlier>; EARLIER_CALIBRATIONS];

/// The calibrations of a flight.
///
/// One is exchanged for another between two frames alone, so that the number of a record tells
/// which calibration it was made with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FlownCalibrations {
    present: Option<CalibrationId>,
    earlier: EarlierList,
}

impl FlownCalibrations {
    /// Returns those of a flight that begins with a calibration.
    pub(crate) const fn new(present: Option<CalibrationId>) -> Self {
        Self {
            present,
            earlier: [None; EARLIER_CALIBRATIONS],
        }
    }

    /// The calibration in use; `None` if it has no identity.
    pub(crate) const fn present(&self) -> Option<CalibrationId> {
        self.present
    }

    /// The calibration with which the record of this number was made.
    pub(crate) fn of(&self, sequence: u32) -> Option<CalibrationId> {
        let mut earlier = self.earlier.iter().flatten();
        match earlier.find(|earlier| sequence <= earlier.last_sequence) {
            Some(earlier) => earlier.id,
            None => self.present,
        }
    }

    /// Returns `true` if there is room for another calibration, given the number of the oldest
    /// record that is left.
    pub(crate) fn have_room(&self, first_left: u32) -> bool {
        self.left(first_left).count() < EARLIER_CALIBRATIONS
    }

    /// Exchanges the calibration for another after a trigger; without room the first of the earlier
    /// ones is forgotten.
    pub(crate) fn exchange(
        &mut self,
        present: Option<CalibrationId>,
        last_sequence: u32,
        first_left: u32,
    ) {
        let replaced = Earlier {
            last_sequence,
            id: self.present,
        };
        let ended = self.left(first_left).last();
        let has_records = last_sequence >= first_left
            && ended.is_none_or(|ended| ended.last_sequence < last_sequence);
        let replaced = (has_records && present != self.present).then_some(replaced);
        let mut earlier = [None; EARLIER_CALIBRATIONS];
        let left = self.left(first_left).chain(replaced);
        for (place, left) in earlier.iter_mut().zip(left) {
            *place = Some(left);
        }
        self.earlier = earlier;
        self.present = present;
    }

    /// The earlier calibrations.
    #[cfg(feature = "link")]
    pub(crate) const fn earlier(&self) -> EarlierList {
        self.earlier
    }

    /// Takes over the earlier calibrations of the flight before a reset.
    #[cfg(feature = "link")]
    pub(crate) const fn take_over(&mut self, earlier: EarlierList) {
        self.earlier = earlier;
    }

    /// The earlier calibrations of which records are left.
    fn left(&self, first_left: u32) -> impl Iterator<Item = Earlier> {
        let is_left = move |earlier: &Earlier| earlier.last_sequence >= first_left;
        self.earlier.into_iter().flatten().filter(is_left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::calibration_id::{SerialNumber, Storage};

    /// Returns the identity of a calibration; 0 is one without.
    fn id(crc: u32) -> Option<CalibrationId> {
        (crc != 0).then_some(CalibrationId {
            serial: SerialNumber::EMPTY,
            version: 0,
            crc,
            storage: Storage::Volatile,
        })
    }

    #[test]
    fn record_has_the_calibration_it_was_made_with() {
        let mut calibrations = FlownCalibrations::new(id(0));
        // Before the first trigger there is nothing to remember.
        calibrations.exchange(id(1), 0, 1);
        assert_eq!(calibrations.of(1), id(1));
        calibrations.exchange(id(2), 5, 1);
        calibrations.exchange(id(0), 5, 1);
        calibrations.exchange(id(4), 7, 1);
        for (sequence, made_with) in [(1, id(1)), (5, id(1)), (6, id(0)), (7, id(0)), (8, id(4))] {
            assert_eq!(calibrations.of(sequence), made_with, "{sequence}");
        }
        assert_eq!(calibrations.present(), id(4));
        // The same once more is no other.
        calibrations.exchange(id(4), 9, 1);
        assert!(calibrations.have_room(1));
        calibrations.exchange(id(5), 10, 1);
        assert_eq!(
            [8, 10, 11].map(|it| calibrations.of(it)),
            [id(4), id(4), id(5)]
        );
    }

    #[test]
    fn there_is_room_again_when_the_records_of_a_calibration_are_gone() {
        let mut calibrations = FlownCalibrations::new(id(0));
        for sequence in 1..=3 {
            assert!(calibrations.have_room(1));
            calibrations.exchange(id(sequence), sequence, 1);
        }
        assert!(!calibrations.have_room(1));
        assert!(calibrations.have_room(2), "record 1 is acknowledged");
        calibrations.exchange(id(4), 4, 2);
        let made_with = [2, 3, 4, 5].map(|sequence| calibrations.of(sequence));
        assert_eq!(made_with, [id(1), id(2), id(3), id(4)]);
        calibrations.exchange(id(5), 6, 7);
        assert_eq!(calibrations, FlownCalibrations::new(id(5)));
    }
}
