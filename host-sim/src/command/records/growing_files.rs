//! Files of records that are fetched one by one: `records.csv` grows by whole rows, `records.json`
//! comes at the end.

use std::fmt::Display;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use fmc_camera::flight::frame_record::{FrameRecord, Outcome};
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_frames::record_files::{CSV, JSON, is_held};
use fmc_report::records;

use crate::failure::Failure;
use crate::formats::output::OutputFolder;

/// A record, and the exposures in doubt whose σ it holds already.
#[derive(Debug, Clone, Copy)]
struct Fetched {
    record: FrameRecord,
    known: Option<InDoubt>,
}

/// The files of a flight that is followed.
#[derive(Debug)]
pub(super) struct GrowingFiles {
    folder: OutputFolder,
    path: PathBuf,
    table: File,
    /// Bytes of whole rows.
    length: u64,
    fetched: Vec<Fetched>,
    in_doubt: Option<InDoubt>,
}

impl GrowingFiles {
    /// Begins the table in a folder, which is made if it does not exist.
    ///
    /// # Errors
    /// [`Failure`] naming the file, also where it is there already.
    pub(super) fn create(folder: &Path) -> Result<Self, Failure> {
        let folder = OutputFolder::create(folder)?;
        let path = folder.path().join(CSV);
        let table = OpenOptions::new().write(true).create_new(true).open(&path);
        let table = table.map_err(|error| Failure::writing(path.display(), &error))?;
        let mut files = Self {
            folder,
            path,
            table,
            length: 0,
            fetched: Vec::new(),
            in_doubt: None,
        };
        let mut heading = Vec::new();
        records::write_csv(&[], &mut heading).map_err(|error| files.failed(&error))?;
        files.append_bytes(&heading)?;
        files.folder.sync()?;
        Ok(files)
    }

    /// Appends the row of a record and waits until the disk has it; `known` are the exposures in
    /// doubt whose σ it holds.
    ///
    /// # Errors
    /// [`Failure`] naming the file, which then has the rows before.
    pub(super) fn append(
        &mut self,
        record: FrameRecord,
        known: Option<InDoubt>,
    ) -> Result<(), Failure> {
        let mut row = Vec::new();
        records::write_row(&record, &mut row).map_err(|error| self.failed(&error))?;
        self.append_bytes(&row)?;
        self.fetched.push(Fetched { record, known });
        Ok(())
    }

    fn append_bytes(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let written = self.table.write_all(bytes);
        let written = written.and_then(|()| self.table.sync_data());
        if let Err(error) = written {
            // A part of a row, which a full disk has taken, is not left.
            let _ = self.table.set_len(self.length);
            return Err(Failure::writing(self.path.display(), &error));
        }
        self.length += bytes.len() as u64;
        Ok(())
    }

    /// Takes a record in its present form for one that has been appended, as it is fetched again
    /// after it was put in doubt.
    ///
    /// # Errors
    /// [`Failure`] naming the file, which then has the rows as they were.
    pub(super) fn replace_last(
        &mut self,
        record: FrameRecord,
        known: Option<InDoubt>,
    ) -> Result<(), Failure> {
        if let Some(last) = self.fetched.last_mut() {
            *last = Fetched { record, known };
        }
        self.rewrite()
    }

    /// Marks the exposures that the camera has found to be in doubt. Returns the number of rows
    /// that were changed.
    ///
    /// # Errors
    /// [`Failure`] naming the file, which then has the rows as they were.
    pub(super) fn doubt(&mut self, exposures: InDoubt) -> Result<usize, Failure> {
        if self.in_doubt == Some(exposures) {
            return Ok(0);
        }
        let before = self.records();
        self.in_doubt = Some(exposures);
        let after = self.records();
        let changed = before
            .iter()
            .zip(&after)
            .filter(|(one, other)| one != other);
        let changed = changed.count();
        if changed > 0 {
            self.rewrite()?;
        }
        Ok(changed)
    }

    /// Replaces the table by one that is complete, and goes on at its end.
    fn rewrite(&mut self) -> Result<(), Failure> {
        let mut bytes = Vec::new();
        records::write_csv(&self.records(), &mut bytes).map_err(|error| self.failed(&error))?;
        self.folder.write(CSV, |sink| sink.write_all(&bytes))?;
        self.folder.sync()?;
        let table = OpenOptions::new().append(true).open(&self.path);
        self.table = table.map_err(|error| Failure::writing(self.path.display(), &error))?;
        self.length = bytes.len() as u64;
        Ok(())
    }

    /// The records as they are known now.
    pub(super) fn records(&self) -> Vec<FrameRecord> {
        let marked = self.fetched.iter().map(|fetched| {
            let mut record = fetched.record;
            let is_exposed = matches!(record.outcome, Outcome::Exposed(_));
            if let Some(exposures) = &self.in_doubt
                && is_exposed
                && !is_held(fetched.known.as_ref(), exposures, record.sequence)
            {
                record.doubt(exposures);
            }
            record
        });
        marked.collect()
    }

    /// Returns `true` before the first record.
    pub(super) const fn is_empty(&self) -> bool {
        self.fetched.is_empty()
    }

    /// Writes `records.json`. Returns the records.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub(super) fn complete(self) -> Result<Vec<FrameRecord>, Failure> {
        let records = self.records();
        let mut json = Vec::new();
        records::write_json(None, &records, self.in_doubt, &mut json)
            .map_err(|error| self.failed(&error))?;
        self.folder
            .write(JSON, |sink: &mut dyn io::Write| sink.write_all(&json))?;
        self.folder.sync()?;
        Ok(records)
    }

    fn failed(&self, error: &dyn Display) -> Failure {
        Failure::device_or_io(format!("{}: {error}", self.path.display()))
    }
}
