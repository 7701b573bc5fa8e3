//! The files of the records of a flight, `records.csv` and `records.json`, to be marked where a
//! later crossing of the index mark has put exposures in doubt.

use std::borrow::Cow;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use fmc_camera::flight::frame_record::FrameRecord;
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

/// Both files of a folder, or the table alone, which is all that there is of a flight that was
/// followed until the program was killed.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordFiles {
    document: Option<RecordDocument>,
    rows: Vec<Row<String>>,
}

impl RecordFiles {
    /// Reads the files of a folder. Without `records.json`, a last line of `records.csv` that is
    /// not whole is left out: the camera has not been told that it is stored.
    ///
    /// # Errors
    /// [`InputError`] naming the file: it cannot be read, or is none of records, or both differ in
    /// their triggers.
    pub fn read(folder: &Path) -> Result<Self, InputError> {
        let json = folder.join(JSON);
        let document: Option<RecordDocument> = match fs::read(&json) {
            Ok(text) => {
                let read = serde_json::from_slice(&text);
                let read = read
                    .map_err(|error| InputError::invalid(format!("{}: {error}", json.display())));
                Some(read?)
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(InputError::reading(&json, &error)),
        };
        let csv = folder.join(CSV);
        let mut table = fs::read(&csv).map_err(|error| InputError::reading(&csv, &error))?;
        if document.is_none() {
            let whole = table.iter().rposition(|byte| *byte == b'\n');
            table.truncate(whole.map_or(0, |end| end + 1));
        }
        let rows = csv::Reader::from_reader(table.as_slice())
            .into_deserialize()
            .collect::<Result<Vec<Row<String>>, _>>()
            .map_err(|error| InputError::invalid(format!("{}: {error}", csv.display())))?;
        if let Some(document) = &document
            && !(document.records.iter().map(|row| row.sequence))
                .eq(rows.iter().map(|row| row.sequence))
        {
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

    /// Returns if the record of a trigger that is here is the camera's record, whatever has been
    /// put in doubt since one of them was made; `None` for a trigger that is not here.
    #[must_use]
    pub fn is_same(&self, record: &FrameRecord) -> Option<bool> {
        let mut rows = self.rows.iter();
        let row = rows.find(|row| row.sequence == record.sequence)?;
        Some(row.is_of(record))
    }

    /// Returns `true` if there is `records.json`.
    #[must_use]
    pub const fn has_json(&self) -> bool {
        self.document.is_some()
    }

    /// Marks exposures that are in doubt. Returns the number of those that were not yet.
    ///
    /// `records.json` tells which doubts the records hold. Without it a record is marked unless it
    /// has flag and fault, and its σ covers the difference.
    pub fn doubt(&mut self, exposures: &InDoubt) -> usize {
        let Some(document) = &mut self.document else {
            let rows = self.rows.iter_mut();
            let new = rows.filter(|row| exposures.contains(row.sequence) && !row.holds(exposures));
            return new.map(|row| usize::from(row.doubt(exposures))).sum();
        };
        let before = document.in_doubt;
        let is_new = |sequence: u32| {
            exposures.contains(sequence) && !is_held(before.as_ref(), exposures, sequence)
        };
        let mut marked = 0;
        for row in &mut document.records {
            if is_new(row.sequence) && row.doubt(exposures) {
                marked += 1;
            }
        }
        for row in &mut self.rows {
            if is_new(row.sequence) {
                row.doubt(exposures);
            }
        }
        document.in_doubt = Some(match before {
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

    /// Writes `records.json`, if there is one.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write_json(&self, sink: impl Write) -> io::Result<()> {
        match &self.document {
            Some(document) => document.write(sink),
            None => Ok(()),
        }
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
