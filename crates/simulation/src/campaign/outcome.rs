//! Outcome of one run, as a row of a table.

use serde::{Deserialize, Serialize};

/// Outcome of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Time from the onset to the first round in which the camera was told something else than
    /// without the fault, ms; `None` if it never was: the fault has not arrived.
    pub arrived_ms: Option<u32>,
    /// First effect; `none` without one.
    pub effect: String,
    /// Its time after the onset, ms.
    pub effect_ms: Option<u32>,
    /// Quantity of the worst error of the frames without fault or flag; empty without such frames.
    pub worst_of: String,
    /// This error in parts of what its record allows; above 1 the frame is silently wrong.
    pub worst: Option<f64>,
    /// Number of frames that were judged.
    pub exposed: u32,
    /// Number of frames that are wrong without a flag, or record light that did not pass.
    pub silent: u32,
    /// Number of the first of them.
    pub first_silent: Option<u32>,
    /// Number of exposures of which no record tells.
    pub unrecorded: u32,
    /// Number of triggers without their record, and of records without their trigger.
    pub unanswered: u32,
}

impl Outcome {
    /// Name without an effect.
    pub const NO_EFFECT: &'static str = "none";

    /// Returns the number of exposures that are wrong and say nothing of it.
    #[must_use]
    pub const fn silent_bad(&self) -> u32 {
        self.silent.saturating_add(self.unrecorded)
    }

    /// Writes outcomes as rows of CSV without a heading, numbers with all their digits.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_rows(outcomes: &[Self]) -> csv::Result<String> {
        let mut writer = csv::WriterBuilder::new()
            .has_headers(false)
            .from_writer(Vec::new());
        for outcome in outcomes {
            writer.serialize(outcome)?;
        }
        let bytes = writer
            .into_inner()
            .map_err(csv::IntoInnerError::into_error)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// Reads the rows that [`Self::write_rows`] has written.
    ///
    /// # Errors
    /// An error for a row that is not one.
    pub fn read_rows(text: &str) -> csv::Result<Vec<Self>> {
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(text.as_bytes());
        reader.into_deserialize().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_are_read_back_as_they_were_written_and_a_torn_row_is_an_error() {
        let full = Outcome {
            arrived_ms: Some(3),
            effect: "flag V/H jump".to_owned(),
            effect_ms: Some(120),
            worst_of: "smear".to_owned(),
            worst: Some(0.1 + 0.2),
            exposed: 4,
            silent: 1,
            first_silent: Some(40),
            unrecorded: 0,
            unanswered: 2,
        };
        let empty = Outcome {
            arrived_ms: None,
            effect: Outcome::NO_EFFECT.to_owned(),
            effect_ms: None,
            worst_of: String::new(),
            worst: None,
            first_silent: None,
            ..full.clone()
        };
        let outcomes = [full, empty];
        let rows = Outcome::write_rows(&outcomes).unwrap();
        assert_eq!(rows.lines().count(), 2);
        assert_eq!(Outcome::read_rows(&rows).unwrap(), outcomes);
        // A shorter number is a number: torn rows are told by the sum of their block.
        let torn = rows.rsplit_once(',').unwrap().0;
        assert!(Outcome::read_rows(torn).is_err(), "{torn}");
    }
}
