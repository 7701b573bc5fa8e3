//! Points of many frames in a CSV file.

use std::io::{self, Read, Write};

use csv::{ByteRecord, Reader, ReaderBuilder};
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::clipped;
use fmc_frames::Lines;

use super::answers::{AnsweredBlock, FLAG, Flag, OutColumns};
use super::block::{self, FrameBlock};
use super::csv_header::CsvHeader;
use super::frame_key::FrameFinder;
use super::source::{RowReader, RowWriter};
use crate::failure::Failure;
use crate::formats::points::{CoordinateFrame, csv_failure, decimal, number, push_cell};

/// The rows of a CSV file behind its header.
pub(super) struct CsvRows<R> {
    file: String,
    reader: Reader<R>,
    header: CsvHeader,
    finder: FrameFinder,
    record: ByteRecord,
    /// The last cell that named a frame, and that frame: rows of a frame mostly follow each other.
    last: (Vec<u8>, Option<u32>),
    lines: Lines,
    read: u64,
}

impl<R: Read> CsvRows<R> {
    /// Reads the header; `file` is the name of the file in messages.
    ///
    /// # Errors
    /// [`Failure`] naming file, line and column.
    pub(super) fn new(file: &str, source: R, finder: FrameFinder) -> Result<Self, Failure> {
        let mut reader = ReaderBuilder::new()
            .buffer_capacity(1 << 18)
            .from_reader(source);
        let header = reader
            .byte_headers()
            .map_err(|error| csv_failure(file, &error))?;
        let header = CsvHeader::find(header, &finder).map_err(|fault| {
            Failure::bad_input(format!("{file}, line 1: {fault}")).with_help(
                "the first line names the columns, in any order: sequence, frame or image, and x_mm,y_mm or col_px,row_px",
            )
        })?;
        Ok(Self {
            file: file.to_owned(),
            reader,
            header,
            finder,
            record: ByteRecord::new(),
            last: (Vec::new(), None),
            lines: Lines::default(),
            read: 0,
        })
    }

    pub(super) const fn header(&self) -> &CsvHeader {
        &self.header
    }

    /// Adds the record to a block.
    fn push(&mut self, block: &mut FrameBlock, camera: &CameraFile) -> Result<(), String> {
        let key = self.record.get(self.header.key_place);
        let key = key.unwrap_or_default().trim_ascii();
        let frame = match self.last {
            (ref cell, Some(frame)) if cell == key => frame,
            _ => {
                let frame = self.finder.find(self.header.key, key)?;
                self.last.0.clear();
                self.last.0.extend_from_slice(key);
                self.last.1 = Some(frame);
                frame
            }
        };
        let [first, second] = self.header.coordinates;
        let (Some(first), Some(second)) =
            (number(&self.record, first), number(&self.record, second))
        else {
            return Err(self.no_number());
        };
        block.points_mm.push(match self.header.frame {
            CoordinateFrame::Sensor => [first, second],
            CoordinateFrame::Pixel => camera.sensor_from_pixel([first, second]),
        });
        block.frames.push(frame);
        let start = block.rows.len();
        block.rows.extend_from_slice(self.record.as_slice());
        let mut end = start;
        block.cell_ends.extend(self.record.iter().map(|cell| {
            end += cell.len();
            end
        }));
        Ok(())
    }

    /// Describes the first coordinate that is not a number.
    #[cold]
    fn no_number(&self) -> String {
        let places = self.header.coordinates.into_iter();
        let mut columns = places.zip(self.header.frame.columns());
        let wrong = columns.find(|(place, _)| number(&self.record, *place).is_none());
        let (place, column) = wrong.unwrap_or_default();
        let text = String::from_utf8_lossy(self.record.get(place).unwrap_or_default());
        format!(
            "{column} = \"{}\" is not a finite number",
            clipped(text.trim()).escape_debug()
        )
    }
}

impl<R: Read + Send> RowReader for CsvRows<R> {
    fn fill(&mut self, block: &mut FrameBlock, camera: &CameraFile) -> Result<(), Failure> {
        block.restart(self.read);
        while block.points_mm.len() < block::POINTS {
            if !self
                .reader
                .read_byte_record(&mut self.record)
                .map_err(|error| csv_failure(&self.file, &error))?
            {
                break;
            }
            let line = self.lines.of(self.record.position());
            self.push(block, camera).map_err(|fault| {
                Failure::bad_input(format!("{}, line {line}: {fault}", self.file))
            })?;
            block.lines.push(line);
        }
        self.read += block.points_mm.len() as u64;
        block.read_bytes = self.reader.position().byte();
        Ok(())
    }
}

/// Meaning of a column of the answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum OutCell {
    /// A cell of the points.
    Kept(usize),
    /// A coordinate, by its place in the pair.
    Coordinate(usize),
    /// An added number, by its place among them.
    Number(usize),
    Flag,
}

/// Writer of the answers as CSV.
pub(super) struct CsvAnswers {
    frame: CoordinateFrame,
    cells: Vec<OutCell>,
    names: Vec<String>,
    /// Number of columns of the points.
    columns: usize,
    /// Points without an answer are left out.
    skip: bool,
    text: Vec<u8>,
}

impl CsvAnswers {
    /// Creates the writer of answers to points with this header. A column of an earlier answer is
    /// replaced, the others are added at the end.
    pub(super) fn new(header: &CsvHeader, out: OutColumns) -> Self {
        let mut names = header.names.clone();
        let mut cells: Vec<OutCell> = (0..names.len()).map(OutCell::Kept).collect();
        for (which, place) in header.coordinates.into_iter().enumerate() {
            if let Some(cell) = cells.get_mut(place) {
                *cell = OutCell::Coordinate(which);
            }
        }
        let numbers = out.numbers().enumerate();
        let added = numbers.map(|(place, name)| (name, OutCell::Number(place)));
        for (name, cell) in added.chain(out.flag.then_some((FLAG, OutCell::Flag))) {
            let place = names.iter().position(|one| one == name);
            if let Some(there) = place.and_then(|place| cells.get_mut(place)) {
                *there = cell;
            } else {
                names.push(name.to_owned());
                cells.push(cell);
            }
        }
        Self {
            frame: header.frame,
            cells,
            names,
            columns: header.names.len(),
            skip: out.skip,
            text: Vec::new(),
        }
    }
}

impl RowWriter for CsvAnswers {
    fn begin(&mut self, sink: &mut dyn Write) -> io::Result<()> {
        self.text.clear();
        for (index, name) in self.names.iter().enumerate() {
            if index > 0 {
                self.text.push(b',');
            }
            push_cell(&mut self.text, name.as_bytes());
        }
        self.text.push(b'\n');
        sink.write_all(&self.text)
    }

    fn write(&mut self, answered: &AnsweredBlock<'_>, sink: &mut dyn Write) -> io::Result<()> {
        let Self { text, .. } = self;
        text.clear();
        for (index, flag) in answered.answers.flags.iter().enumerate() {
            if self.skip && *flag != Flag::None {
                continue;
            }
            let point = answered.point(index, self.frame);
            for (place, cell) in self.cells.iter().enumerate() {
                if place > 0 {
                    text.push(b',');
                }
                match cell {
                    OutCell::Kept(column) => {
                        push_cell(text, answered.block.cell(index * self.columns + column));
                    }
                    OutCell::Flag => {
                        push_cell(text, answered.flag_text(index).as_bytes());
                    }
                    // A point without an answer has no numbers.
                    OutCell::Coordinate(which) => {
                        if let Some(value) = point.as_ref().and_then(|point| point.get(*which)) {
                            decimal::push::<9>(text, value + 0.0);
                        }
                    }
                    OutCell::Number(which) => {
                        if let Some(value) = answered.number(index, *which) {
                            decimal::push::<6>(text, value);
                        }
                    }
                }
            }
            text.push(b'\n');
        }
        sink.write_all(text)
    }

    fn end(&mut self, _: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }
}
