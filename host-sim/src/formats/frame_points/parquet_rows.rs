//! Points of many frames in a Parquet file.

use std::fs::File;

use fmc_camera_file::CameraFile;
use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::block::{self, FrameBlock};
use super::frame_key::FrameFinder;
use super::parquet_column::{ParquetColumn, Values};
use super::parquet_schema::ParquetSchema;
use super::source::RowReader;
use crate::failure::Failure;
use crate::formats::points::CoordinateFrame;

/// The rows of a Parquet file.
pub(super) struct ParquetRows {
    file: String,
    reader: SerializedFileReader<File>,
    schema: ParquetSchema,
    finder: FrameFinder,
    /// Next row group.
    next_group: usize,
    /// Readers of the columns of the present one.
    columns: Vec<ColumnReader>,
    /// Rows of it that are not yet read.
    left: usize,
    read: u64,
    bytes: u64,
}

impl ParquetRows {
    /// Reads the description at the end of the file; `name` is the name of the file in messages.
    ///
    /// # Errors
    /// [`Failure`] naming file and column.
    pub(super) fn new(name: &str, file: File, finder: FrameFinder) -> Result<Self, Failure> {
        let reader = SerializedFileReader::new(file).map_err(|error| failure(name, &error))?;
        let description = reader.metadata().file_metadata().schema_descr();
        let schema = ParquetSchema::of(description, finder.has_images()).map_err(|fault| {
            Failure::bad_input(format!("{name}: {fault}")).with_help(
                "points of frames have columns sequence, frame or image, and x_mm, y_mm or col_px, row_px, without lists \
                 and structures",
            )
        })?;
        Ok(Self {
            file: name.to_owned(),
            reader,
            schema,
            finder,
            next_group: 0,
            columns: Vec::new(),
            left: 0,
            read: 0,
            bytes: 0,
        })
    }

    pub(super) const fn schema(&self) -> &ParquetSchema {
        &self.schema
    }

    /// Opens the next row group that has rows; returns `false` behind the last.
    fn open_group(&mut self) -> Result<bool, ParquetError> {
        while self.left == 0 {
            if self.next_group >= self.reader.num_row_groups() {
                return Ok(false);
            }
            let group = self.reader.get_row_group(self.next_group)?;
            self.next_group += 1;
            self.left = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
            self.bytes += u64::try_from(group.metadata().compressed_size()).unwrap_or(0);
            self.columns = (0..group.num_columns())
                .map(|column| group.get_column_reader(column))
                .collect::<Result<_, _>>()?;
        }
        Ok(true)
    }

    /// Reads the next rows of all columns.
    fn read_columns(&mut self, rows: usize) -> Result<Vec<ParquetColumn>, ParquetError> {
        let readers = self.columns.iter_mut().zip(&self.schema.optional);
        let columns = readers
            .map(|(reader, is_optional)| ParquetColumn::read(reader, *is_optional, rows))
            .collect::<Result<Vec<_>, _>>()?;
        if columns.iter().any(|column| column.rows() != rows) {
            return Err(ParquetError::General(
                "a column has fewer rows than its group states".to_owned(),
            ));
        }
        Ok(columns)
    }

    /// Returns the frames that the rows name.
    fn frames(&self, column: &ParquetColumn) -> (Vec<u32>, Option<String>) {
        let key = self.schema.key;
        let finder = &self.finder;
        let mut last: Option<(&[u8], u32)> = None;
        let mut last_number: Option<(i64, u32)> = None;
        let mut find_number = |number: i64| match last_number {
            Some((one, frame)) if one == number => Ok(frame),
            _ => {
                let frame = finder.find_number(key, number)?;
                last_number = Some((number, frame));
                Ok(frame)
            }
        };
        match &column.values {
            Values::Int32(values) => {
                collect(values.iter().map(|value| find_number(i64::from(*value))))
            }
            Values::Int64(values) => collect(values.iter().map(|value| find_number(*value))),
            Values::Bytes(values) => collect(values.iter().map(|value| match last {
                Some((cell, frame)) if cell == value.data() => Ok(frame),
                _ => {
                    let frame = finder.find(key, value.data())?;
                    last = Some((value.data(), frame));
                    Ok(frame)
                }
            })),
            _ => (
                Vec::new(),
                Some(format!("column {} is no number", key.name())),
            ),
        }
    }
}

/// Collects frames up to the first fault.
fn collect(frames: impl Iterator<Item = Result<u32, String>>) -> (Vec<u32>, Option<String>) {
    let mut fault = None;
    let frames = frames
        .map_while(|frame| frame.map_err(|text| fault = Some(text)).ok())
        .collect();
    (frames, fault)
}

impl RowReader for ParquetRows {
    fn fill(&mut self, block: &mut FrameBlock, camera: &CameraFile) -> Result<(), Failure> {
        block.restart(self.read);
        let is_open = self.open_group();
        if !is_open.map_err(|error| failure(&self.file, &error))? {
            return Ok(());
        }
        let rows = self.left.min(block::POINTS);
        let columns = self.read_columns(rows);
        block.columns = columns.map_err(|error| failure(&self.file, &error))?;
        self.left -= rows;
        let (file, read) = (&self.file, self.read);
        let whole = |place: usize, name: &str| {
            let column = block.columns.get(place);
            let null = column.filter(|column| !column.is_whole());
            match (column, null) {
                (Some(column), None) => Ok(column),
                (_, null) => {
                    let row =
                        null.and_then(|null| null.levels.iter().position(|level| *level == 0));
                    let row = read + row.unwrap_or_default() as u64;
                    Err(Failure::bad_input(format!(
                        "{file}, row {row}: {name} has no value"
                    )))
                }
            }
        };
        let (mut frames, fault) =
            self.frames(whole(self.schema.key_place, self.schema.key.name())?);
        let names = self.schema.frame.columns();
        let [first, second] = self.schema.coordinates;
        let numbers = |column: &ParquetColumn| -> Vec<f64> {
            match &column.values {
                Values::Float(values) => values.iter().copied().map(f64::from).collect(),
                Values::Double(values) => values.clone(),
                _ => Vec::new(),
            }
        };
        let [first_name, second_name] = names;
        let first = numbers(whole(first, first_name)?);
        let second = numbers(whole(second, second_name)?);
        let points = first
            .into_iter()
            .zip(second)
            .map(|(a, b)| match self.schema.frame {
                CoordinateFrame::Sensor => [a, b],
                CoordinateFrame::Pixel => camera.sensor_from_pixel([a, b]),
            });
        block.points_mm.extend(points.take(frames.len()));
        block.frames.append(&mut frames);
        self.read += block.points_mm.len() as u64;
        block.read_bytes = self.bytes;
        match fault {
            Some(fault) => Err(Failure::bad_input(format!(
                "{}, row {}: {fault}",
                self.file, self.read
            ))),
            None => Ok(()),
        }
    }
}

/// Returns the failure of a file that cannot be read.
pub(super) fn failure(file: &str, error: &ParquetError) -> Failure {
    let failure = Failure::bad_input(format!(
        "{file} is not a file of Parquet that can be read: {error}"
    ));
    match error {
        ParquetError::General(text) if text.contains("Disabled feature") => {
            failure.with_help("compressed with Snappy, or not at all, it can be read")
        }
        _ => failure,
    }
}
