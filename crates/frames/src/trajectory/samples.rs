//! Samples of a file, from any of its places on.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

use csv::{ReaderBuilder, StringRecord, Trim};
use fmc_camera_file::InputError;

use super::clock::{Clock, WeekCount};
use super::heading::Heading;
use super::sample::Sample;
use super::sbet;
use crate::columns::{check_length, csv_error};

/// Place of a sample in its file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct SamplePlace {
    /// First byte.
    pub(super) byte: u64,
    /// Number of the record, or line of the row.
    pub(super) number: u64,
    /// Seconds that turns of the week have added before.
    pub(super) added_s: f64,
}

/// Format of the samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SampleFormat {
    Sbet,
    Table(Box<Heading>),
}

/// A file of samples.
#[derive(Debug)]
pub(super) struct SampleFile {
    /// Name in messages.
    pub(super) name: String,
    pub(super) file: BufReader<File>,
    pub(super) format: SampleFormat,
    pub(super) clock: Clock,
}

impl SampleFile {
    /// Gives each sample from a place on to `each`, until it returns `false`.
    ///
    /// # Errors
    /// [`InputError`] naming file, record or line, field, value and allowed range.
    pub(super) fn read(
        &mut self,
        from: SamplePlace,
        each: impl FnMut(Sample, SamplePlace) -> Result<bool, InputError>,
    ) -> Result<(), InputError> {
        self.file
            .seek(SeekFrom::Start(from.byte))
            .map_err(|error| self.unreadable(&error))?;
        match &self.format {
            SampleFormat::Sbet => self.read_records(from, each),
            SampleFormat::Table(heading) => {
                let heading = heading.clone();
                self.read_rows(&heading, from, each)
            }
        }
    }

    fn read_records(
        &mut self,
        mut place: SamplePlace,
        mut each: impl FnMut(Sample, SamplePlace) -> Result<bool, InputError>,
    ) -> Result<(), InputError> {
        let mut weeks = WeekCount::from(place.added_s);
        let mut bytes = [0; sbet::BYTES];
        loop {
            match self.file.read_exact(&mut bytes) {
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(()),
                read => read.map_err(|error| self.unreadable(&error))?,
            }
            let sample = sbet::sample(&bytes, &mut weeks).map_err(|fault| {
                InputError::invalid(format!("{}, record {}: {fault}", self.name, place.number))
                    .with_help("SBET: 17 numbers of 8 bytes, little endian, with angles in radians")
            })?;
            place.added_s = weeks.added_s;
            if !each(sample, place)? {
                return Ok(());
            }
            place.number += 1;
            place.byte += sbet::BYTES as u64;
        }
    }

    fn read_rows(
        &mut self,
        heading: &Heading,
        from: SamplePlace,
        mut each: impl FnMut(Sample, SamplePlace) -> Result<bool, InputError>,
    ) -> Result<(), InputError> {
        let file = self.name.as_str();
        let mut weeks = WeekCount::from(from.added_s);
        let mut rows = table_reader(&mut self.file);
        let (mut row, mut first) = (StringRecord::new(), None);
        while rows
            .read_record(&mut row)
            .map_err(|error| csv_error(file, &heading.names, &StringRecord::new(), &error))?
        {
            let line = row.position().map_or(0, csv::Position::line);
            let number = from.number + line.saturating_sub(*first.get_or_insert(line));
            check_length(file, number, &row, &heading.names)?;
            let sample = heading
                .sample(&row, self.clock, &mut weeks)
                .map_err(|fault| InputError::invalid(format!("{file}, line {number}: {fault}")))?;
            let place = SamplePlace {
                byte: from.byte + row.position().map_or(0, csv::Position::byte),
                number,
                added_s: weeks.added_s,
            };
            if !each(sample, place)? {
                break;
            }
        }
        Ok(())
    }

    /// Returns the name of a place in messages.
    pub(super) fn place_name(&self, number: u64) -> String {
        let unit = match self.format {
            SampleFormat::Sbet => "record",
            SampleFormat::Table(_) => "line",
        };
        format!("{}, {unit} {number}", self.name)
    }

    fn unreadable(&self, error: &io::Error) -> InputError {
        InputError::reading(self.name.as_ref(), error)
    }
}

/// Returns the reader of rows, of which none is a header.
pub(super) fn table_reader<R: Read>(source: R) -> csv::Reader<R> {
    ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .from_reader(source)
}
