//! Points of a CSV file.

use std::io::Read;
use std::path::Path;

use csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder};
use fmc_camera_file::CameraFile;
use fmc_frames::Lines;

use super::columns::Columns;
use super::{Block, CoordinateFrame};
use crate::failure::Failure;

/// The rows of a CSV file behind its header.
pub(super) struct CsvPoints<R> {
    file: String,
    reader: Reader<R>,
    columns: Columns,
    record: ByteRecord,
    lines: Lines,
    read: u64,
}

impl<R: Read> CsvPoints<R> {
    /// Reads the header; `file` is the name of the file in messages.
    ///
    /// # Errors
    /// [`Failure`] naming file, line and column.
    pub(super) fn new(file: &str, source: R) -> Result<Self, Failure> {
        let mut reader = ReaderBuilder::new()
            .buffer_capacity(1 << 18)
            .from_reader(source);
        let header = reader
            .byte_headers()
            .map_err(|error| csv_failure(file, &error))?;
        let columns = Columns::find(header).map_err(|fault| {
            Failure::bad_input(format!("{file}, line 1: {fault}")).with_help(
                "the first line names the columns, separated by commas, in any order: id,x_mm,y_mm or id,col_px,row_px",
            )
        })?;
        Ok(Self {
            file: file.to_owned(),
            reader,
            columns,
            record: ByteRecord::new(),
            lines: Lines::default(),
            read: 0,
        })
    }

    pub(super) const fn frame(&self) -> CoordinateFrame {
        self.columns.frame
    }

    /// Reads the next points into a block; it stays empty at the end.
    ///
    /// # Errors
    /// [`Failure`] naming file, line, column and value; the points before it are in the block.
    pub(super) fn fill(&mut self, block: &mut Block, camera: &CameraFile) -> Result<(), Failure> {
        block.restart(self.read);
        let file = &self.file;
        while !block.is_full() {
            if !self
                .reader
                .read_byte_record(&mut self.record)
                .map_err(|error| csv_failure(file, &error))?
            {
                break;
            }
            let line = self.lines.of(self.record.position());
            self.columns
                .read(&self.record, line, camera, block)
                .map_err(|fault| Failure::bad_input(format!("{file}, line {line}: {fault}")))?;
        }
        self.read += block.points_mm.len() as u64;
        block.read_bytes = self.reader.position().byte();
        Ok(())
    }
}

pub(in crate::formats) fn csv_failure(file: &str, error: &csv::Error) -> Failure {
    match error.kind() {
        ErrorKind::UnequalLengths {
            pos,
            expected_len,
            len,
        } => Failure::bad_input(format!(
            "{file}, line {}: {len} columns where the header has {expected_len}",
            pos.as_ref().map_or(0, csv::Position::line)
        )),
        ErrorKind::Io(error) => Failure::reading(Path::new(file), error),
        _ => Failure::bad_input(format!("{file}: {error}")),
    }
}
