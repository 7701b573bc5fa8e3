//! Points of a NumPy array: N rows of x and y in the sensor frame, mm.

use std::io::{self, ErrorKind, Read};
use std::path::Path;

use super::Precision;
use super::block::{self, Block};
use crate::failure::Failure;
use crate::formats::npy_header::{self, NpyHeader, NpyHeaderError};

/// The rows of an array behind its header.
pub(super) struct NpyPoints<R> {
    file: String,
    source: R,
    precision: Precision,
    count: u64,
    read: u64,
    bytes: Vec<u8>,
}

impl<R: Read> NpyPoints<R> {
    /// Reads the header; `file` is the name of the file in messages.
    ///
    /// # Errors
    /// [`Failure`] naming the file, and the part of the header that is wrong.
    pub(super) fn new(file: &str, mut source: R) -> Result<Self, Failure> {
        let header = NpyHeader::read(&mut source).map_err(|error| match error {
            NpyHeaderError::Reading(error) => Failure::reading(Path::new(file), &error),
            error => Failure::bad_input(format!("{file} is not an array of NumPy (.npy): {error}")),
        })?;
        let refused = |found: String| {
            Failure::bad_input(format!(
                "{file}: the array is {found}; points are N rows of x_mm, y_mm: shape (N, 2), C order, <f4 or <f8"
            ))
        };
        let precision = match header.description.as_str() {
            "'<f4'" | "\"<f4\"" => Precision::Single,
            "'<f8'" | "\"<f8\"" => Precision::Double,
            other => return Err(refused(format!("of type {}", npy_header::shown(other)))),
        };
        let [count, 2] = *header.shape else {
            let shape = format!("{:?}", header.shape);
            return Err(refused(format!("of shape {}", npy_header::shown(&shape))));
        };
        if header.is_fortran_order && count > 1 {
            return Err(refused("in Fortran order".to_owned()));
        }
        Ok(Self {
            file: file.to_owned(),
            source,
            precision,
            count,
            read: 0,
            bytes: Vec::new(),
        })
    }

    pub(super) const fn count(&self) -> u64 {
        self.count
    }

    pub(super) const fn precision(&self) -> Precision {
        self.precision
    }

    /// Number of bytes of all rows.
    pub(super) const fn bytes(&self) -> u64 {
        self.count.saturating_mul(self.row_bytes())
    }

    const fn row_bytes(&self) -> u64 {
        2 * self.precision.bytes() as u64
    }

    /// Reads the next points into a block; it stays empty at the end.
    ///
    /// # Errors
    /// [`Failure`] for an array that ends too early, or a file that goes on behind it.
    pub(super) fn fill(&mut self, block: &mut Block) -> Result<(), Failure> {
        block.restart(self.read);
        let left = self.count - self.read;
        let rows = usize::try_from(left).map_or(block::POINTS, |left| left.min(block::POINTS));
        match self.precision {
            // They stay as they are until something asks for another precision. Rows of the block
            // before are not zeroed.
            Precision::Single => {
                block.resize_rows(rows);
                let bytes = block.rows.as_flattened_mut().as_flattened_mut();
                if let Err(error) = self.source.read_exact(bytes) {
                    block.rows.clear();
                    return Err(self.failed(&error));
                }
            }
            Precision::Double => {
                self.bytes.resize(rows * 2 * self.precision.bytes(), 0);
                self.source
                    .read_exact(&mut self.bytes)
                    .map_err(|error| self.failed(&error))?;
                let (numbers, _) = self.bytes.as_chunks::<8>();
                let (rows, _) = numbers.as_chunks::<2>();
                block
                    .points_mm
                    .extend(rows.iter().map(|row| row.map(f64::from_le_bytes)));
            }
        }
        self.read += rows as u64;
        block.read_bytes = self.read * self.row_bytes();
        if rows == 0 && !self.is_at_end()? {
            return Err(Failure::bad_input(format!(
                "{}: the file goes on behind the {} rows of its array",
                self.file, self.count
            )));
        }
        Ok(())
    }

    fn is_at_end(&mut self) -> Result<bool, Failure> {
        loop {
            match self.source.read(&mut [0]) {
                Ok(count) => return Ok(count == 0),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.failed(&error)),
            }
        }
    }

    fn failed(&self, error: &io::Error) -> Failure {
        if error.kind() == ErrorKind::UnexpectedEof {
            return Failure::bad_input(format!(
                "{}: the file ends before the {} rows of its array",
                self.file, self.count
            ));
        }
        Failure::reading(Path::new(&self.file), error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_read_are_those_of_all_blocks_when_one_is_filled_again_and_again() {
        let count = 2 * block::POINTS as u64 + 7;
        let mut array = Vec::new();
        NpyHeader::write("<f8", &[count, 2], &mut array).unwrap();
        let rows = io::repeat(0).take(16 * count);
        let mut points = NpyPoints::new("points.npy", array.as_slice().chain(rows)).unwrap();
        let mut block = Block::default();
        for read in [block::POINTS as u64, 2 * block::POINTS as u64, count, count] {
            points.fill(&mut block).unwrap();
            assert_eq!(block.read_bytes, 16 * read);
        }
        assert_eq!(points.bytes(), block.read_bytes);
    }
}
