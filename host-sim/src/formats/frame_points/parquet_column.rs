//! Values of a column of Parquet, of every physical type.

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::{ByteArray, DataType, FixedLenByteArray, Int96};
use parquet::errors::Result;
use parquet::file::writer::SerializedColumnWriter;

/// Values that follow each other in a column.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct ParquetColumn {
    /// Of an optional column, 1 for each row with a value and 0 for one without; else empty.
    pub(super) levels: Vec<i16>,
    pub(super) values: Values,
}

/// Values by their physical type.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    Bool(Vec<bool>),
    Int32(Vec<i32>),
    Int64(Vec<i64>),
    Int96(Vec<Int96>),
    Float(Vec<f32>),
    Double(Vec<f64>),
    Bytes(Vec<ByteArray>),
    Fixed(Vec<FixedLenByteArray>),
}

impl Default for Values {
    fn default() -> Self {
        Self::Bool(Vec::new())
    }
}

impl ParquetColumn {
    /// Reads up to so many rows of a column.
    ///
    /// # Errors
    /// Those of the reader: a damaged page, or a compression that is not known.
    pub(super) fn read(reader: &mut ColumnReader, is_optional: bool, rows: usize) -> Result<Self> {
        let mut levels = Vec::new();
        let kept = is_optional.then_some(&mut levels);
        let values = match reader {
            ColumnReader::BoolColumnReader(reader) => Values::Bool(of(reader, kept, rows)?),
            ColumnReader::Int32ColumnReader(reader) => Values::Int32(of(reader, kept, rows)?),
            ColumnReader::Int64ColumnReader(reader) => Values::Int64(of(reader, kept, rows)?),
            ColumnReader::Int96ColumnReader(reader) => Values::Int96(of(reader, kept, rows)?),
            ColumnReader::FloatColumnReader(reader) => Values::Float(of(reader, kept, rows)?),
            ColumnReader::DoubleColumnReader(reader) => Values::Double(of(reader, kept, rows)?),
            ColumnReader::ByteArrayColumnReader(reader) => Values::Bytes(of(reader, kept, rows)?),
            ColumnReader::FixedLenByteArrayColumnReader(reader) => {
                Values::Fixed(of(reader, kept, rows)?)
            }
        };
        Ok(Self { levels, values })
    }

    /// Writes the column.
    ///
    /// # Errors
    /// Those of the writer.
    pub(super) fn write(&self, writer: &mut SerializedColumnWriter<'_>) -> Result<()> {
        let levels = (!self.levels.is_empty()).then_some(self.levels.as_slice());
        match (writer.untyped(), &self.values) {
            (ColumnWriter::BoolColumnWriter(writer), Values::Bool(values)) => {
                writer.write_batch(values, levels, None)
            }
            (ColumnWriter::Int32ColumnWriter(writer), Values::Int32(values)) => {
                writer.write_batch(values, levels, None)
            }
            (ColumnWriter::Int64ColumnWriter(writer), Values::Int64(values)) => {
                writer.write_batch(values, levels, None)
            }
            (ColumnWriter::Int96ColumnWriter(writer), Values::Int96(values)) => {
                writer.write_batch(values, levels, None)
            }
            (ColumnWriter::FloatColumnWriter(writer), Values::Float(values)) => {
                writer.write_batch(values, levels, None)
            }
            (ColumnWriter::DoubleColumnWriter(writer), Values::Double(values)) => {
                writer.write_batch(values, levels, None)
            }
            (ColumnWriter::ByteArrayColumnWriter(writer), Values::Bytes(values)) => {
                writer.write_batch(values, levels, None)
            }
            (ColumnWriter::FixedLenByteArrayColumnWriter(writer), Values::Fixed(values)) => {
                writer.write_batch(values, levels, None)
            }
            _ => Ok(0),
        }
        .map(|_| ())
    }

    /// Number of rows, with and without a value.
    pub(super) fn rows(&self) -> usize {
        if self.levels.is_empty() {
            self.count()
        } else {
            self.levels.len()
        }
    }

    /// Returns `true` if every row has a value.
    pub(super) fn is_whole(&self) -> bool {
        self.rows() == self.count()
    }

    fn count(&self) -> usize {
        match &self.values {
            Values::Bool(values) => values.len(),
            Values::Int32(values) => values.len(),
            Values::Int64(values) => values.len(),
            Values::Int96(values) => values.len(),
            Values::Float(values) => values.len(),
            Values::Double(values) => values.len(),
            Values::Bytes(values) => values.len(),
            Values::Fixed(values) => values.len(),
        }
    }

    /// Appends those rows of another part of the column that are kept.
    pub(super) fn append(&mut self, other: &Self, kept: &[bool]) {
        if self.rows() == 0 {
            self.values = other.values.emptied();
        }
        let has_levels = !other.levels.is_empty();
        let with_value = other
            .levels
            .iter()
            .zip(kept)
            .filter(|(level, _)| **level > 0);
        let with_value: Vec<bool> = with_value.map(|(_, kept)| *kept).collect();
        let places = if has_levels { &with_value[..] } else { kept };
        let levels = other.levels.iter().zip(kept).filter(|(_, kept)| **kept);
        self.levels.extend(levels.map(|(level, _)| *level));
        match (&mut self.values, &other.values) {
            (Values::Bool(all), Values::Bool(more)) => append(all, more, places),
            (Values::Int32(all), Values::Int32(more)) => append(all, more, places),
            (Values::Int64(all), Values::Int64(more)) => append(all, more, places),
            (Values::Int96(all), Values::Int96(more)) => append(all, more, places),
            (Values::Float(all), Values::Float(more)) => append(all, more, places),
            (Values::Double(all), Values::Double(more)) => append(all, more, places),
            (Values::Bytes(all), Values::Bytes(more)) => append(all, more, places),
            (Values::Fixed(all), Values::Fixed(more)) => append(all, more, places),
            _ => {}
        }
    }
}

impl Values {
    /// Returns no values of the same type.
    fn emptied(&self) -> Self {
        match self {
            Self::Bool(_) => Self::Bool(Vec::new()),
            Self::Int32(_) => Self::Int32(Vec::new()),
            Self::Int64(_) => Self::Int64(Vec::new()),
            Self::Int96(_) => Self::Int96(Vec::new()),
            Self::Float(_) => Self::Float(Vec::new()),
            Self::Double(_) => Self::Double(Vec::new()),
            Self::Bytes(_) => Self::Bytes(Vec::new()),
            Self::Fixed(_) => Self::Fixed(Vec::new()),
        }
    }
}

fn append<T: Clone>(all: &mut Vec<T>, more: &[T], kept: &[bool]) {
    let more = more.iter().zip(kept).filter(|(_, kept)| **kept);
    all.extend(more.map(|(value, _)| value.clone()));
}

fn of<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    levels: Option<&mut Vec<i16>>,
    rows: usize,
) -> Result<Vec<T::T>> {
    let mut values = Vec::with_capacity(rows);
    let mut left = rows;
    let mut levels = levels;
    while left > 0 {
        let (read, _, _) = reader.read_records(left, levels.as_deref_mut(), None, &mut values)?;
        if read == 0 {
            break;
        }
        left -= read;
    }
    Ok(values)
}
