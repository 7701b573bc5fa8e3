//! Points of many frames in an array of NumPy.

use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;

use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;

use super::answers::{AnsweredBlock, Flag, OutColumns};
use super::block::{self, FrameBlock};
use super::frame_key::FrameFinder;
use super::npy_layout::{KeyType, NpyLayout, NpyOutLayout};
use super::source::{RowReader, RowWriter};
use crate::failure::Failure;
use crate::formats::npy_header::{NpyHeader, NpyHeaderError};
use crate::formats::points::{CoordinateFrame, Precision};

/// The rows of an array behind its header.
pub(super) struct NpyRows<R> {
    file: String,
    source: R,
    layout: NpyLayout,
    finder: FrameFinder,
    count: u64,
    read: u64,
    /// Bytes of the last row's frame, and that frame.
    last: (Vec<u8>, Option<u32>),
}

impl<R: Read> NpyRows<R> {
    /// Reads the header; `file` is the name of the file in messages.
    ///
    /// # Errors
    /// [`Failure`] naming the file, and the part of the header that is wrong.
    pub(super) fn new(file: &str, mut source: R, finder: FrameFinder) -> Result<Self, Failure> {
        let header = NpyHeader::read(&mut source).map_err(|error| match error {
            NpyHeaderError::Reading(error) => Failure::reading(Path::new(file), &error),
            error => Failure::bad_input(format!("{file} is not an array of NumPy (.npy): {error}")),
        })?;
        let (layout, count) = NpyLayout::of(&header, finder.has_images()).map_err(|fault| {
            Failure::bad_input(format!("{file}: the array {fault}")).with_help(
                "points of frames are N rows of sequence, x_mm, y_mm: shape (N, 3), C order, <f4 or <f8; or a \
                 structured array with fields sequence, frame or image, and x_mm, y_mm or col_px, row_px",
            )
        })?;
        Ok(Self {
            file: file.to_owned(),
            source,
            layout,
            finder,
            count,
            read: 0,
            last: (Vec::new(), None),
        })
    }

    pub(super) const fn layout(&self) -> &NpyLayout {
        &self.layout
    }

    pub(super) const fn count(&self) -> u64 {
        self.count
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

    fn is_at_end(&mut self) -> Result<bool, Failure> {
        loop {
            match self.source.read(&mut [0]) {
                Ok(count) => return Ok(count == 0),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.failed(&error)),
            }
        }
    }
}

impl<R: Read + Send> RowReader for NpyRows<R> {
    fn fill(&mut self, block: &mut FrameBlock, camera: &CameraFile) -> Result<(), Failure> {
        block.restart(self.read);
        let left = self.count - self.read;
        let rows = usize::try_from(left).map_or(block::POINTS, |left| left.min(block::POINTS));
        block.rows.resize(rows * self.layout.row_bytes, 0);
        self.source
            .read_exact(&mut block.rows)
            .map_err(|error| self.failed(&error))?;
        let layout = &self.layout;
        let key_ends = layout.key_offset..layout.key_offset + layout.key_bytes;
        let mut wrong = None;
        for row in block.rows.chunks_exact(layout.row_bytes) {
            let key = row.get(key_ends.clone()).unwrap_or_default();
            let frame = match self.last {
                (ref last, Some(frame)) if last == key => frame,
                _ => match find(&self.finder, layout, key) {
                    Ok(frame) => {
                        self.last = (key.to_vec(), Some(frame));
                        frame
                    }
                    Err(fault) => {
                        wrong = Some(fault);
                        break;
                    }
                },
            };
            let coordinate = layout
                .coordinates
                .map(|offset| number(row, offset, layout.precision));
            block.points_mm.push(match layout.frame {
                CoordinateFrame::Sensor => coordinate,
                CoordinateFrame::Pixel => camera.sensor_from_pixel(coordinate),
            });
            block.frames.push(frame);
        }
        self.read += block.points_mm.len() as u64;
        block.read_bytes = self.read * layout.row_bytes as u64;
        if let Some(fault) = wrong {
            return Err(Failure::bad_input(format!(
                "{}, row {}: {fault}",
                self.file, self.read
            )));
        }
        if rows == 0 && !self.is_at_end()? {
            return Err(Failure::bad_input(format!(
                "{}: the file goes on behind the {} rows of its array",
                self.file, self.count
            )));
        }
        Ok(())
    }
}

/// Returns the frame that a field names.
fn find(finder: &FrameFinder, layout: &NpyLayout, key: &[u8]) -> Result<u32, String> {
    let column = layout.key;
    match layout.key_type {
        KeyType::Unsigned => {
            let mut bytes = [0; 8];
            bytes.iter_mut().zip(key).for_each(|(to, from)| *to = *from);
            let number = u64::from_le_bytes(bytes);
            finder.find_number(column, i64::try_from(number).unwrap_or(i64::MAX))
        }
        KeyType::Signed => {
            let is_negative = key.last().is_some_and(|byte| *byte > 127);
            let mut bytes = [if is_negative { 255 } else { 0 }; 8];
            bytes.iter_mut().zip(key).for_each(|(to, from)| *to = *from);
            finder.find_number(column, i64::from_le_bytes(bytes))
        }
        KeyType::Float => {
            let precision = if key.len() == 4 {
                Precision::Single
            } else {
                Precision::Double
            };
            let value = number(key, 0, precision);
            // Exact: a whole number of 32 bits.
            let sequence = (0.0..=f64::from(u32::MAX)).contains(&value).then(|| {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "within the range of the type"
                )]
                let whole = value as i64;
                whole
            });
            match sequence {
                Some(whole) if value.fract().abs() <= 0.0 => finder.find_number(column, whole),
                _ => Err(format!(
                    "{} = {value} is not a whole number from 0 to {}",
                    column.name(),
                    u32::MAX
                )),
            }
        }
        KeyType::Bytes => {
            let length = key
                .iter()
                .rposition(|byte| *byte != 0)
                .map_or(0, |last| last + 1);
            finder.find(column, key.get(..length).unwrap_or_default())
        }
        KeyType::Unicode => {
            let (characters, _) = key.as_chunks::<4>();
            let text: Option<String> = characters
                .iter()
                .map(|code| u32::from_le_bytes(*code))
                .take_while(|code| *code != 0)
                .map(char::from_u32)
                .collect();
            let text = text.ok_or_else(|| format!("{} is not text", column.name()))?;
            finder.find(column, text.as_bytes())
        }
    }
}

/// Returns a number of a row.
fn number(row: &[u8], offset: usize, precision: Precision) -> f64 {
    let bytes = row.get(offset..).unwrap_or_default();
    let number = match precision {
        Precision::Single => bytes
            .first_chunk()
            .map(|one| f64::from(f32::from_le_bytes(*one))),
        Precision::Double => bytes.first_chunk().map(|one| f64::from_le_bytes(*one)),
    };
    number.unwrap_or(f64::NAN)
}

/// Writes a number into a row.
fn put(row: &mut [u8], offset: usize, precision: Precision, value: f64) {
    let bytes = row.get_mut(offset..).unwrap_or_default();
    match precision {
        Precision::Single => {
            if let Some(place) = bytes.first_chunk_mut() {
                *place = single(value).to_le_bytes();
            }
        }
        Precision::Double => {
            if let Some(place) = bytes.first_chunk_mut() {
                *place = value.to_le_bytes();
            }
        }
    }
}

/// Writer of the answers as an array.
pub(super) struct NpyAnswers {
    layout: NpyLayout,
    out: NpyOutLayout,
    count: u64,
    bytes: Vec<u8>,
}

impl NpyAnswers {
    /// Creates the writer of answers to the rows of an array.
    ///
    /// # Errors
    /// A description of a field that has the name of an answer's, and another type.
    pub(super) fn new(layout: &NpyLayout, count: u64, out: OutColumns) -> Result<Self, String> {
        Ok(Self {
            out: layout.answered(out)?,
            layout: layout.clone(),
            count,
            bytes: Vec::new(),
        })
    }
}

impl RowWriter for NpyAnswers {
    fn begin(&mut self, sink: &mut dyn Write) -> io::Result<()> {
        match &self.out.description {
            Some(description) => NpyHeader::write_described(description, &[self.count], sink),
            None => NpyHeader::write(self.layout.precision.type_name(), &[self.count, 4], sink),
        }
    }

    fn write(&mut self, answered: &AnsweredBlock<'_>, sink: &mut dyn Write) -> io::Result<()> {
        let AnsweredBlock {
            block,
            answers,
            camera,
            ..
        } = *answered;
        let Self {
            layout, out, bytes, ..
        } = self;
        let precision = layout.precision;
        bytes.resize(out.row_bytes * answers.answers.len(), 0);
        let coordinates = if out.description.is_some() {
            let kept = block.rows.chunks_exact(layout.row_bytes);
            for (row, kept) in bytes.chunks_exact_mut(out.row_bytes).zip(kept) {
                if let Some(start) = row.get_mut(..kept.len()) {
                    start.copy_from_slice(kept);
                }
            }
            layout.coordinates
        } else {
            [0, precision.bytes()]
        };
        let rows = bytes.chunks_exact_mut(out.row_bytes);
        let all = answers.answers.iter().zip(&answers.flags);
        for (index, (row, (answer, flag))) in rows.zip(all).enumerate() {
            let is_answered = *flag == Flag::None;
            let value = |value: f64| if is_answered { value } else { f64::NAN };
            let point = match layout.frame {
                CoordinateFrame::Sensor => answer.point_mm,
                CoordinateFrame::Pixel => camera.pixel_from_sensor(answer.point_mm),
            };
            for (offset, coordinate) in coordinates.into_iter().zip(point) {
                put(row, offset, precision, value(coordinate));
            }
            let distortion = answer.distortion_mm;
            let sigma = answers.sigma_mm.get(index).into_iter().flatten();
            let numbers = distortion.iter().chain(sigma);
            for (offset, number) in out.numbers.iter().zip(numbers) {
                put(row, *offset, precision, value(1000.0 * number));
            }
            if let Some(place) = out.flag.and_then(|offset| row.get_mut(offset)) {
                *place = flag.number();
            }
        }
        sink.write_all(bytes)
    }

    fn end(&mut self, _: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }
}
