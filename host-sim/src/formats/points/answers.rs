//! Writer of answers, block by block.

use std::io::{self, Write};
use std::mem;
use std::ops::Range;

use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;

use super::source::for_frames;
use super::{Block, CoordinateFrame, PointFormat, Precision, Source, decimal, push_cell};
use crate::failure::Failure;
use crate::formats::npy_header::NpyHeader;

/// The answer to one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// The new coordinate in the sensor frame, mm.
    pub point_mm: [f64; 2],
    /// Distortion measured - ideal, mm.
    pub distortion_mm: [f64; 2],
}

/// Answers to the points of a block, either as numbers or as rows of an array.
#[derive(Debug, Default)]
pub struct BlockAnswers {
    /// The answers as numbers.
    pub numbers: Vec<Answer>,
    /// The rows of an array in single precision: x, y in mm and dx, dy in µm.
    pub(crate) rows: Vec<[[u8; 4]; 4]>,
}

/// Writer of answers, in the order and the frame of the points.
#[derive(Debug)]
pub struct Answers<'a> {
    source: &'a Source,
    camera: &'a CameraFile,
    layout: Layout,
    /// Encoded answers of the first and of the second half of a block.
    bytes: [Vec<u8>; 2],
}

#[derive(Debug, Clone, Copy)]
enum Layout {
    Csv,
    Npy { rows: u64, precision: Precision },
}

impl<'a> Answers<'a> {
    /// Returns the writer of answers to the points of `source`.
    ///
    /// # Errors
    /// [`Failure`] where an array is asked for but the number of points, which its header holds, is
    /// not known.
    pub fn new(
        source: &'a Source,
        camera: &'a CameraFile,
        format: PointFormat,
    ) -> Result<Self, Failure> {
        let layout = match (format, source.count) {
            (PointFormat::Csv, _) => Layout::Csv,
            (PointFormat::Npy, Some(rows)) => Layout::Npy {
                rows,
                precision: source.precision,
            },
            (PointFormat::Parquet, _) => return Err(for_frames()),
            (PointFormat::Npy, None) => {
                return Err(Failure::bad_input(format!(
                    "an answer as npy needs points as npy: its first bytes say how many there are, which {} does not",
                    source.file
                )));
            }
        };
        Ok(Self {
            source,
            camera,
            layout,
            bytes: [Vec::new(), Vec::new()],
        })
    }

    /// Writes the header before the first answer.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn begin(&self, sink: &mut dyn Write) -> io::Result<()> {
        match self.layout {
            Layout::Csv => {
                let [first, second] = self.source.frame.columns();
                writeln!(sink, "id,{first},{second},dx_um,dy_um")
            }
            Layout::Npy { rows, precision } => {
                NpyHeader::write(precision.type_name(), &[rows, 4], sink)
            }
        }
    }

    /// Writes the answers to a block.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(
        &mut self,
        block: &Block,
        answers: &BlockAnswers,
        sink: &mut dyn Write,
    ) -> io::Result<()> {
        if !answers.rows.is_empty() {
            return sink.write_all(answers.rows.as_flattened().as_flattened());
        }
        let answers = answers.numbers.as_slice();
        let [first, second] = &mut self.bytes;
        first.clear();
        second.clear();
        match self.layout {
            Layout::Csv => {
                // Two threads write as fast as the one that reads, for every frame and direction.
                let half = answers.len() / 2;
                let (source, camera) = (self.source, self.camera);
                rayon::join(
                    || push_text(first, source, camera, block, answers, 0..half),
                    || push_text(second, source, camera, block, answers, half..answers.len()),
                );
            }
            Layout::Npy {
                precision: Precision::Single,
                ..
            } => push_numbers(first, answers, |number| single(number).to_le_bytes()),
            Layout::Npy {
                precision: Precision::Double,
                ..
            } => push_numbers(first, answers, f64::to_le_bytes),
        }
        sink.write_all(first)?;
        sink.write_all(second)
    }
}

/// Appends some of the rows of a block.
fn push_text(
    bytes: &mut Vec<u8>,
    source: &Source,
    camera: &CameraFile,
    block: &Block,
    answers: &[Answer],
    rows: Range<usize>,
) {
    // The length changes with every cell: the buffers of two threads are not to share a cache line.
    let mut own = mem::take(bytes);
    let text = &mut own;
    let mut names = block.names().skip(rows.start);
    let mut number = itoa::Buffer::new();
    let answers = (block.before..).zip(answers);
    for (index, answer) in answers.take(rows.end).skip(rows.start) {
        let name = names.next();
        push_cell(
            text,
            name.unwrap_or_else(|| number.format(index).as_bytes()),
        );
        let coordinate = match source.frame {
            CoordinateFrame::Sensor => answer.point_mm,
            CoordinateFrame::Pixel => camera.pixel_from_sensor(answer.point_mm),
        };
        for value in coordinate {
            text.push(b',');
            // Adding zero turns -0 into 0.
            decimal::push::<9>(text, value + 0.0);
        }
        for value in answer.distortion_mm {
            text.push(b',');
            decimal::push::<6>(text, 1000.0 * value + 0.0);
        }
        text.push(b'\n');
    }
    *bytes = own;
}

/// Appends x, y in mm and dx, dy in µm.
fn push_numbers<const BYTES: usize>(
    bytes: &mut Vec<u8>,
    answers: &[Answer],
    number: impl Fn(f64) -> [u8; BYTES],
) {
    bytes.reserve(4 * BYTES * answers.len());
    for answer in answers {
        let [x, y] = answer.point_mm;
        let [dx, dy] = answer.distortion_mm;
        let row = [x, y, 1000.0 * dx, 1000.0 * dy].map(&number);
        bytes.extend_from_slice(row.as_flattened());
    }
}
