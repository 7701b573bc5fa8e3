//! Temperature of the lens, as the camera is told it, and the focus shift at it.

use super::flag::{Flag, Flags};
use super::time::Time;
use crate::geometry::focus_table::FocusTable;
use crate::geometry::range::Quantity;

/// Time for which a temperature that was told is taken for the present one, s: a lens of some
/// kilograms changes by less than a degree in it.
pub const TEMPERATURE_VALID_S: f32 = 600.0;

/// The last temperature that was told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LensTemperature {
    /// °C; `None` before the first.
    celsius: Option<f32>,
    /// Time at which it was told; `None` if it cannot be compared with the present time.
    told: Option<Time>,
}

impl LensTemperature {
    /// Before the first.
    pub(crate) const UNKNOWN: Self = Self {
        celsius: None,
        told: None,
    };

    /// Takes a temperature, °C. What is none is ignored.
    pub(crate) fn tell(&mut self, time: Time, celsius: f32) {
        if let Ok(celsius) = Quantity::TemperatureC.check(celsius) {
            *self = Self {
                celsius: Some(celsius),
                told: Some(time),
            };
        }
    }

    /// Forgets the time at which it was told, after a jump of the clock.
    pub(crate) const fn forget_time(&mut self) {
        self.told = None;
    }

    /// Focus shift by a table, µm; 0 without a table, and before the first temperature.
    pub(crate) fn focus_shift_um(&self, table: &FocusTable) -> f32 {
        let shift = self.celsius.and_then(|celsius| table.at(celsius));
        shift.map_or(0.0, |shift| shift.focus_shift_um)
    }

    /// Flags of a frame of a camera with a table.
    pub(crate) fn flags(&self, table: &FocusTable, now: Time) -> Flags {
        let mut flags = Flags::NONE;
        if table.is_empty() {
            return flags;
        }
        let age_s = self.told.map(|told| now.seconds_since(told));
        if age_s.is_none_or(|age_s| age_s > TEMPERATURE_VALID_S) {
            flags.insert(Flag::TemperatureUnknown);
        }
        let shift = self.celsius.and_then(|celsius| table.at(celsius));
        if shift.is_some_and(|shift| shift.is_outside) {
            flags.insert(Flag::TemperatureOutside);
        }
        flags
    }

    /// Bits of the temperature, which outlives a reset: a value that equals itself.
    #[cfg(feature = "link")]
    pub(crate) fn bits(&self) -> Option<u32> {
        self.celsius.map(f32::to_bits)
    }

    /// Returns the temperature of before a reset: it is held, but nobody knows how old it is.
    #[cfg(feature = "link")]
    pub(crate) fn held(bits: Option<u32>) -> Self {
        Self {
            celsius: bits.map(f32::from_bits),
            told: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::focus_table::FocusRow;

    fn table() -> FocusTable {
        let row = |temperature_c, focus_shift_um| FocusRow {
            temperature_c,
            focus_shift_um,
        };
        FocusTable::new(&[row(0.0, -10.0), row(20.0, 30.0)]).unwrap()
    }

    fn at_s(seconds: u64) -> Time {
        Time::from_us(1_000_000 * seconds)
    }

    fn flags(temperature: &LensTemperature, seconds: u64) -> std::vec::Vec<Flag> {
        temperature.flags(&table(), at_s(seconds)).iter().collect()
    }

    #[test]
    fn what_is_no_temperature_leaves_the_last_one_which_grows_old() {
        let mut temperature = LensTemperature::UNKNOWN;
        assert_eq!(temperature.focus_shift_um(&table()).to_bits(), 0);
        assert_eq!(flags(&temperature, 0), [Flag::TemperatureUnknown]);
        temperature.tell(at_s(10), 10.0);
        for bad in [f32::NAN, f32::INFINITY, 1000.0, -1000.0] {
            temperature.tell(at_s(100), bad);
        }
        assert_eq!(
            temperature.focus_shift_um(&table()).to_bits(),
            10.0_f32.to_bits()
        );
        assert_eq!(flags(&temperature, 610), []);
        assert_eq!(flags(&temperature, 611), [Flag::TemperatureUnknown]);
    }

    #[test]
    fn outside_the_table_the_nearest_row_holds_and_is_flagged() {
        let mut temperature = LensTemperature::UNKNOWN;
        for (celsius, shift_um) in [(-5.0, -10.0_f32), (21.0, 30.0)] {
            temperature.tell(at_s(1), celsius);
            assert_eq!(
                temperature.focus_shift_um(&table()).to_bits(),
                shift_um.to_bits()
            );
            assert_eq!(flags(&temperature, 2), [Flag::TemperatureOutside]);
        }
    }

    #[test]
    fn camera_without_a_table_has_neither_shift_nor_flag() {
        let mut temperature = LensTemperature::UNKNOWN;
        let none = FocusTable::NONE;
        assert!(temperature.flags(&none, at_s(0)).is_empty());
        temperature.tell(at_s(1), 20.0);
        assert!(temperature.flags(&none, at_s(5000)).is_empty());
        assert_eq!(temperature.focus_shift_um(&none).to_bits(), 0);
    }
}
