//! The files of the records of a flight, `records.csv` and `records.json`, to be marked where a
//! later crossing of the index mark has put exposures in doubt.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera_file::InputError;
use serde::{Deserialize, Serialize};

use crate::row::{Row, write_rows};

/// Name of the table.
pub const CSV: &str = "records.csv";
/// Name of the file for programs.
pub const JSON: &str = "records.json";

type Text = Cow<'static, str>;

/// Content of `records.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordDocument {
    /// Name of the camera file, where it is known.
    pub camera: Option<String>,
    /// Meaning of the numbers, for readers without this program.
    pub conventions: Vec<Text>,
    /// CRC-32 of the records as the link carried them.
    pub records_crc32: String,
    /// Exposures in doubt whose σ the records hold already; `None` if there are none.
    #[serde(default)]
    pub in_doubt: Option<InDoubt>,
    /// Records.
    pub records: Vec<Row<Vec<Text>>>,
}

/// Both files of a folder.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordFiles {
    document: RecordDocument,
    rows: Vec<Row<String>>,
}

impl RecordFiles {
    /// Reads both files of a folder.
    ///
    /// # Errors
    /// [`InputError`] naming the file: it cannot be read, or is none of records, or both differ in
    /// their triggers.
    pub fn read(folder: &Path) -> Result<Self, InputError> {
        let json = folder.join(JSON);
        let text = fs::read(&json).map_err(|error| InputError::reading(&json, &error))?;
        let document: RecordDocument = serde_json::from_slice(&text)
            .map_err(|error| InputError::invalid(format!("{}: {error}", json.display())))?;
        let csv = folder.join(CSV);
        let file = File::open(&csv).map_err(|error| InputError::reading(&csv, &error))?;
        let rows = csv::Reader::from_reader(file)
            .into_deserialize()
            .collect::<Result<Vec<Row<String>>, _>>()
            .map_err(|error| InputError::invalid(format!("{}: {error}", csv.display())))?;
        let of_document = document.records.iter().map(|row| row.sequence);
        if !of_document.eq(rows.iter().map(|row| row.sequence)) {
            return Err(InputError::invalid(format!(
                "{}: other triggers than in {JSON} beside it",
                csv.display()
            )));
        }
        Ok(Self { document, rows })
    }

    /// Sequence number, time of the trigger, µs, and CRC-32 of the calibration of the last record.
    #[must_use]
    pub fn last(&self) -> Option<(u32, u64, &str)> {
        let row = self.rows.last()?;
        Some((row.sequence, row.trigger_us, &row.calibration_crc32))
    }

    /// Returns `true` if a trigger has its record here.
    #[must_use]
    pub fn has(&self, sequence: u32) -> bool {
        self.rows.iter().any(|row| row.sequence == sequence)
    }

    /// Marks exposures that are in doubt. Returns the number of those that were not yet.
    pub fn doubt(&mut self, exposures: &InDoubt) -> usize {
        let before = self.document.in_doubt;
        let is_new = |sequence: u32| {
            exposures.contains(sequence) && !is_held(before.as_ref(), exposures, sequence)
        };
        let mut marked = 0;
        for row in &mut self.document.records {
            if is_new(row.sequence) && row.doubt(exposures) {
                marked += 1;
            }
        }
        for row in &mut self.rows {
            if is_new(row.sequence) {
                row.doubt(exposures);
            }
        }
        self.document.in_doubt = Some(match before {
            Some(before) => before.with(*exposures),
            None => *exposures,
        });
        marked
    }

    /// Writes `records.csv`.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write_csv(&self, sink: impl Write) -> csv::Result<()> {
        write_rows(self.rows.iter(), sink)
    }

    /// Writes `records.json`.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write_json(&self, sink: impl Write) -> io::Result<()> {
        self.document.write(sink)
    }
}

/// Returns `true` if a record whose σ holds the exposures in doubt `before` holds `exposures`, too.
#[must_use]
pub fn is_held(before: Option<&InDoubt>, exposures: &InDoubt, sequence: u32) -> bool {
    before.is_some_and(|before| {
        before.contains(sequence)
            && before.off_mm.abs() >= exposures.off_mm.abs()
            && (before.is_fault || !exposures.is_fault)
    })
}

impl RecordDocument {
    /// Writes the document.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write(&self, mut sink: impl Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut sink, self)?;
        writeln!(sink)
    }
}
