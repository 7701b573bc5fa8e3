//! Answers as a Parquet file.

use std::io::{self, Write};
use std::mem;
use std::sync::{Arc, Mutex, PoisonError};

use fmc_camera_file::number::single;
use parquet::basic::Compression;
use parquet::data_type::ByteArray;
use parquet::errors::{ParquetError, Result};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::TypePtr;

use super::answers::{AnsweredBlock, Flag, OutColumns};
use super::parquet_column::{ParquetColumn, Values};
use super::parquet_schema::{OutColumn, ParquetSchema};
use super::source::RowWriter;
use crate::formats::points::{CoordinateFrame, Precision};

/// Rows of a group, which is in memory until it is written.
const GROUP_ROWS: usize = 1 << 17;

/// Bytes between the writer of the format and the file.
#[derive(Debug, Clone, Default)]
struct Pipe(Arc<Mutex<Vec<u8>>>);

impl Pipe {
    /// Moves the bytes on.
    fn drain(&self, sink: &mut dyn Write) -> io::Result<()> {
        let bytes = mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner));
        sink.write_all(&bytes)
    }
}

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Writer of the answers as a Parquet file.
pub(super) struct ParquetAnswers {
    frame: CoordinateFrame,
    precision: Precision,
    root: TypePtr,
    columns: Vec<OutColumn>,
    optional: Vec<bool>,
    skip: bool,
    pipe: Pipe,
    writer: Option<SerializedFileWriter<Pipe>>,
    /// Rows of the group that is collected.
    group: Vec<ParquetColumn>,
    rows: usize,
}

impl ParquetAnswers {
    /// Creates the writer of answers to points with these columns.
    ///
    /// # Errors
    /// Those of the library for names that are not allowed.
    pub(super) fn new(schema: &ParquetSchema, out: OutColumns) -> Result<Self> {
        let (root, columns) = schema.answered(out)?;
        Ok(Self {
            frame: schema.frame,
            precision: schema.precision,
            optional: schema.optional.clone(),
            group: vec![ParquetColumn::default(); columns.len()],
            root,
            columns,
            skip: out.skip,
            pipe: Pipe::default(),
            writer: None,
            rows: 0,
        })
    }

    /// Writes the group that is collected.
    fn write_group(&mut self) -> Result<()> {
        let Some(writer) = self.writer.as_mut().filter(|_| self.rows > 0) else {
            return Ok(());
        };
        let mut group = writer.next_row_group()?;
        for column in &self.group {
            let Some(mut writer) = group.next_column()? else {
                break;
            };
            column.write(&mut writer)?;
            writer.close()?;
        }
        group.close()?;
        for column in &mut self.group {
            *column = ParquetColumn::default();
        }
        self.rows = 0;
        Ok(())
    }

    fn numbers(&self, numbers: impl Iterator<Item = f64>) -> Values {
        match self.precision {
            Precision::Single => Values::Float(numbers.map(single).collect()),
            Precision::Double => Values::Double(numbers.collect()),
        }
    }
}

impl RowWriter for ParquetAnswers {
    fn begin(&mut self, sink: &mut dyn Write) -> io::Result<()> {
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY);
        let properties = Arc::new(properties.build());
        let writer = SerializedFileWriter::new(self.pipe.clone(), self.root.clone(), properties);
        self.writer = Some(writer.map_err(io_error)?);
        self.pipe.drain(sink)
    }

    fn write(&mut self, answered: &AnsweredBlock<'_>, sink: &mut dyn Write) -> io::Result<()> {
        let AnsweredBlock { block, answers, .. } = *answered;
        let kept: Vec<bool> = answers
            .flags
            .iter()
            .map(|flag| !self.skip || *flag == Flag::None)
            .collect();
        let rows = 0..answers.flags.len();
        for (place, meaning) in self.columns.clone().into_iter().enumerate() {
            let made = match meaning {
                OutColumn::Kept(_) => None,
                OutColumn::Coordinate(which) => {
                    let numbers = rows.clone().map(|row| {
                        let point = answered.point(row, self.frame);
                        let point = point.as_ref().and_then(|point| point.get(which));
                        point.copied().unwrap_or(f64::NAN)
                    });
                    Some(self.numbers(numbers))
                }
                OutColumn::Number(which) => {
                    let number = |row| answered.number(row, which).unwrap_or(f64::NAN);
                    Some(self.numbers(rows.clone().map(number)))
                }
                OutColumn::Flag => {
                    let texts = rows.clone().map(|row| answered.flag_text(row));
                    let texts = texts.map(|text| ByteArray::from(text.as_bytes().to_vec()));
                    Some(Values::Bytes(texts.collect()))
                }
            };
            let is_optional = matches!(meaning, OutColumn::Coordinate(_))
                && self.optional.get(place).copied().unwrap_or_default();
            let made = made.map(|values| ParquetColumn {
                levels: if is_optional {
                    vec![1; rows.len()]
                } else {
                    Vec::new()
                },
                values,
            });
            let source = match (&made, meaning) {
                (Some(made), _) => Some(made),
                (None, OutColumn::Kept(place)) => block.columns.get(place),
                (None, _) => None,
            };
            if let Some((all, more)) = self.group.get_mut(place).zip(source) {
                all.append(more, &kept);
            }
        }
        self.rows += kept.iter().filter(|kept| **kept).count();
        if self.rows >= GROUP_ROWS {
            self.write_group().map_err(io_error)?;
        }
        self.pipe.drain(sink)
    }

    fn end(&mut self, sink: &mut dyn Write) -> io::Result<()> {
        self.write_group().map_err(io_error)?;
        if let Some(writer) = self.writer.take() {
            writer.close().map_err(io_error)?;
        }
        self.pipe.drain(sink)
    }
}

fn io_error(error: ParquetError) -> io::Error {
    io::Error::other(error)
}
