//! Focus shift of a camera over its temperature, as a laboratory has measured it.

use super::range::{OutOfRange, Quantity};

/// Most rows of a [`FocusTable`].
pub const FOCUS_ROWS: usize = 16;

/// A row: the focus shift at one temperature.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FocusRow {
    /// Temperature of the lens, °C.
    pub temperature_c: f32,
    /// Δz at this temperature beyond the run-out of the stage, µm, positive away from the lens.
    pub focus_shift_um: f32,
}

/// Focus shift over temperature; empty for a camera whose focus shift is not known.
///
/// The rows are as they were given: [`Camera`](crate::flight::camera::Camera) validates them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FocusTable {
    /// Those beyond `length` are 0.
    rows: [FocusRow; FOCUS_ROWS],
    length: u8,
}

/// Focus shift that a table has at a temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableShift {
    /// Δz, µm, positive away from the lens.
    pub focus_shift_um: f32,
    /// `true` if the temperature is outside the table: Δz is that of the nearest row.
    pub is_outside: bool,
}

impl FocusTable {
    /// The table of a camera without one.
    pub const NONE: Self = Self {
        rows: [FocusRow {
            temperature_c: 0.0,
            focus_shift_um: 0.0,
        }; FOCUS_ROWS],
        length: 0,
    };

    /// Returns the table of these rows, not yet validated.
    ///
    /// # Errors
    /// [`OutOfRange`] for another number of rows than 2 to [`FOCUS_ROWS`].
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::focus_table::{FocusRow, FocusTable};
    ///
    /// let row = |temperature_c, focus_shift_um| FocusRow {
    ///     temperature_c,
    ///     focus_shift_um,
    /// };
    /// let table = FocusTable::new(&[row(-20.0, -30.0), row(20.0, 0.0), row(40.0, 30.0)])?;
    /// let at = |temperature_c| table.at(temperature_c).unwrap();
    /// assert_eq!(at(0.0).focus_shift_um, -15.0);
    /// assert_eq!(at(30.0).focus_shift_um, 15.0);
    /// assert_eq!(at(50.0).focus_shift_um, 30.0);
    /// assert!(at(50.0).is_outside && !at(40.0).is_outside);
    /// # Ok::<(), fmc_camera::geometry::range::OutOfRange>(())
    /// ```
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "a number of rows in an error; no more than 16 in a table"
    )]
    pub fn new(rows: &[FocusRow]) -> Result<Self, OutOfRange> {
        Quantity::FocusTableRows.check(rows.len() as f32)?;
        let mut table = Self::NONE;
        for (place, row) in table.rows.iter_mut().zip(rows) {
            *place = *row;
        }
        table.length = rows.len() as u8;
        Ok(table)
    }

    /// Returns `true` for a camera without a table.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// The rows, in rising order of their temperatures.
    #[must_use]
    pub fn rows(&self) -> &[FocusRow] {
        self.rows
            .get(..usize::from(self.length))
            .unwrap_or_default()
    }

    /// Checks the rows of a table that is not empty: temperatures in range that rise strictly, and
    /// shifts of up to `most_um` either way.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the quantity, its value and the range; of a temperature that does not
    /// rise, the range begins above the one before.
    pub(crate) fn check(&self, most_um: f32) -> Result<(), OutOfRange> {
        if self.is_empty() {
            return Ok(());
        }
        Quantity::FocusTableRows.check(f32::from(self.length))?;
        let (mut least_c, most_c) = Quantity::TemperatureC.range();
        for row in self.rows() {
            Quantity::TemperatureC.check_within(row.temperature_c, least_c, most_c)?;
            Quantity::FocusShiftUm.check_within(row.focus_shift_um, -most_um, most_um)?;
            least_c = row.temperature_c.next_up();
        }
        Ok(())
    }

    /// Returns the focus shift at a temperature, °C; `None` without a table.
    ///
    /// # Model
    /// Linear between two rows; that of the nearest row outside.
    #[must_use]
    pub fn at(&self, temperature_c: f32) -> Option<TableShift> {
        let rows = self.rows();
        let (first, last) = (rows.first()?, rows.last()?);
        let nearest = |row: &FocusRow, is_outside| TableShift {
            focus_shift_um: row.focus_shift_um,
            is_outside,
        };
        for (low, high) in rows.iter().zip(rows.iter().skip(1)) {
            if temperature_c >= low.temperature_c && temperature_c < high.temperature_c {
                let part =
                    (temperature_c - low.temperature_c) / (high.temperature_c - low.temperature_c);
                let rise_um = high.focus_shift_um - low.focus_shift_um;
                return Some(TableShift {
                    focus_shift_um: low.focus_shift_um + part * rise_um,
                    is_outside: false,
                });
            }
        }
        Some(if temperature_c < first.temperature_c {
            nearest(first, true)
        } else {
            nearest(last, temperature_c > last.temperature_c)
        })
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for FocusTable {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.rows().serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for FocusTable {
    /// Reads rows; of no rows the empty table.
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rows = heapless::Vec::<FocusRow, FOCUS_ROWS>::deserialize(deserializer)?;
        let mut table = Self::NONE;
        for (place, row) in table.rows.iter_mut().zip(&rows) {
            *place = *row;
            table.length += 1;
        }
        Ok(table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(temperature_c: f32, focus_shift_um: f32) -> FocusRow {
        FocusRow {
            temperature_c,
            focus_shift_um,
        }
    }

    #[test]
    fn shift_is_that_of_each_row_and_linear_between_them() {
        let rows = [
            row(-30.0, 45.0),
            row(-10.0, 5.0),
            row(20.0, 0.0),
            row(50.0, -60.0),
        ];
        let table = FocusTable::new(&rows).unwrap();
        for row in rows {
            let at = table.at(row.temperature_c).unwrap();
            assert_eq!(at.focus_shift_um.to_bits(), row.focus_shift_um.to_bits());
            assert!(!at.is_outside, "{row:?}");
        }
        for (temperature_c, shift_um) in [(-20.0, 25.0), (5.0, 2.5), (21.0, -2.0)] {
            let at = table.at(temperature_c).unwrap();
            assert!((at.focus_shift_um - shift_um).abs() < 1e-5, "{at:?}");
        }
        for (temperature_c, shift_um) in [(-30.5, 45.0), (51.0, -60.0)] {
            let at = TableShift {
                focus_shift_um: shift_um,
                is_outside: true,
            };
            assert_eq!(table.at(temperature_c), Some(at));
        }
        assert_eq!(FocusTable::NONE.at(20.0), None);
    }

    #[test]
    fn wrong_number_of_rows_is_refused_with_the_number() {
        for count in [0_u8, 1, 17, 40] {
            let rows: std::vec::Vec<_> = (0..count).map(|it| row(f32::from(it), 0.0)).collect();
            let error = FocusTable::new(&rows).unwrap_err();
            assert_eq!(error.quantity, Quantity::FocusTableRows);
            assert_eq!(error.value.to_bits(), f32::from(count).to_bits());
        }
    }

    #[test]
    fn rows_that_do_not_rise_or_lead_too_far_are_refused_by_name() {
        let refused = |rows: &[FocusRow]| {
            let error = FocusTable::new(rows).unwrap().check(100.0).unwrap_err();
            (error.quantity, error.value.to_bits())
        };
        let good = row(0.0, 100.0);
        assert_eq!(
            FocusTable::new(&[good, row(1.0, -100.0)])
                .unwrap()
                .check(100.0),
            Ok(())
        );
        for temperature_c in [0.0, -1.0, f32::NAN, f32::INFINITY, 1000.0, 100.1] {
            let named = (Quantity::TemperatureC, temperature_c.to_bits());
            assert_eq!(refused(&[good, row(temperature_c, 0.0)]), named);
        }
        assert_eq!(
            refused(&[row(-1000.0, 0.0), good]),
            (Quantity::TemperatureC, (-1000.0_f32).to_bits())
        );
        for shift_um in [100.1, -100.1, f32::NAN, f32::NEG_INFINITY] {
            let named = (Quantity::FocusShiftUm, shift_um.to_bits());
            assert_eq!(refused(&[good, row(1.0, shift_um)]), named);
        }
    }
}
