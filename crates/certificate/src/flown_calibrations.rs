//! The calibration that the frame records of a flight name.

use std::collections::BTreeMap;
use std::io::Read;

use fmc_camera_file::InputError;
use serde::Deserialize;

/// Column of the calibration's CRC-32 in `records.csv`, and key in `records.json`.
const CRC: &str = "calibration_crc32";

/// The CRC-32 of the calibrations that records name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FlownCalibrations {
    /// Name of the file.
    pub file: String,
    /// For each CRC-32 the number of records with it, and the first of them by its sequence.
    pub calibrations: BTreeMap<String, (u64, String)>,
}

#[derive(Deserialize)]
struct File {
    records: Vec<Record>,
}

#[derive(Deserialize)]
struct Record {
    sequence: u64,
    calibration_crc32: String,
}

impl FlownCalibrations {
    /// Reads `records.csv` or `records.json`; `file` is the name that messages use, and its end
    /// tells the format.
    ///
    /// # Errors
    /// [`InputError`] for a file that is neither, or has no record.
    pub fn read(file: &str, source: impl Read) -> Result<Self, InputError> {
        let mut records = Self {
            file: file.to_owned(),
            calibrations: BTreeMap::new(),
        };
        let refused = |fault: String| InputError::invalid(format!("{file}: {fault}"));
        if file.to_lowercase().ends_with(".json") {
            let read: File = serde_json::from_reader(std::io::BufReader::new(source))
                .map_err(|error| refused(format!("not the records of a flight: {error}")))?;
            for record in read.records {
                records.add(&record.calibration_crc32, &record.sequence.to_string());
            }
        } else {
            let mut reader = csv::Reader::from_reader(source);
            let headers = reader
                .headers()
                .map_err(|error| refused(error.to_string()))?
                .clone();
            let column = |name: &str| {
                let place = headers.iter().position(|one| one.trim() == name);
                place.ok_or_else(|| refused(format!("has no column {name}")))
            };
            let (sequence, crc) = (column("sequence")?, column(CRC)?);
            for row in reader.records() {
                let row = row.map_err(|error| refused(error.to_string()))?;
                let cell = |index: usize| row.get(index).unwrap_or_default().trim();
                records.add(cell(crc), cell(sequence));
            }
        }
        if records.calibrations.is_empty() {
            return Err(refused("has no records".to_owned()));
        }
        Ok(records)
    }

    fn add(&mut self, crc: &str, sequence: &str) {
        let entry = self
            .calibrations
            .entry(crc.to_lowercase())
            .or_insert_with(|| (0, sequence.to_owned()));
        entry.0 += 1;
    }

    /// Number of records.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.calibrations.values().map(|(count, _)| count).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_formats_name_the_calibrations() {
        let csv = "sequence,outcome,calibration_crc32\n1,exposed,deadbeef\n2,refused,DEADBEEF\n3,exposed,00000001\n";
        let read = FlownCalibrations::read("records.csv", csv.as_bytes()).unwrap();
        assert_eq!(read.calibrations["deadbeef"], (2, "1".to_owned()));
        assert_eq!(read.calibrations["00000001"], (1, "3".to_owned()));
        assert_eq!(read.count(), 3);
        let json =
            r#"{"camera":null,"records":[{"sequence":7,"calibration_crc32":"deadbeef","x":1}]}"#;
        let read = FlownCalibrations::read("r.json", json.as_bytes()).unwrap();
        assert_eq!(read.calibrations["deadbeef"], (1, "7".to_owned()));
    }

    #[test]
    fn files_without_records_are_refused() {
        for (file, text, word) in [
            ("r.csv", "", "no column"),
            ("r.csv", "sequence\n1\n", "no column calibration_crc32"),
            ("r.csv", "sequence,calibration_crc32\n", "no records"),
            ("r.json", "{}", "not the records"),
            ("r.json", r#"{"records":[]}"#, "no records"),
        ] {
            let error = FlownCalibrations::read(file, text.as_bytes()).unwrap_err();
            assert!(error.to_string().contains(word), "{error}");
        }
    }
}
