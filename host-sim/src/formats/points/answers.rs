//! Answers, block by block.

use std::io::{self, Write};

use npyz::{DType, WriterBuilder as _};

use super::{Block, Frame, PointFormat, Precision, Source, decimal};
use crate::failure::Failure;
use crate::formats::camera_file::CameraFile;
use crate::formats::number::single;

/// The answer to one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// The new coordinate in the sensor frame, mm.
    pub point_mm: [f64; 2],
    /// Distortion measured - ideal, mm.
    pub distortion_mm: [f64; 2],
}

/// The writer of answers, in the order and the frame of the points.
#[derive(Debug)]
pub struct Answers<'a> {
    source: &'a Source,
    camera: &'a CameraFile,
    layout: Layout,
    /// The answers of a block, as they are written.
    bytes: Vec<u8>,
}

#[derive(Debug, Clone, Copy)]
enum Layout {
    Csv,
    Npy { rows: u64, precision: Precision },
}

impl<'a> Answers<'a> {
    /// Answers to the points of `source`.
    ///
    /// # Errors
    /// [`Failure`] of an array asked for where nobody knows its length, which stands first in it.
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
            bytes: Vec::new(),
        })
    }

    /// Writes what stands before the first answer.
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
                let number = precision.type_name().parse().map_err(io::Error::other)?;
                npyz::WriteOptions::new_header_only()
                    .dtype(DType::Plain(number))
                    .shape(&[rows, 4])
                    .writer(sink)
                    .write_header_only()?;
                Ok(())
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
        answers: &[Answer],
        sink: &mut dyn Write,
    ) -> io::Result<()> {
        self.bytes.clear();
        match self.layout {
            Layout::Csv => self.push_text(block, answers),
            Layout::Npy {
                precision: Precision::Single,
                ..
            } => push_numbers(&mut self.bytes, answers, |number| {
                single(number).to_le_bytes()
            }),
            Layout::Npy {
                precision: Precision::Double,
                ..
            } => push_numbers(&mut self.bytes, answers, f64::to_le_bytes),
        }
        sink.write_all(&self.bytes)
    }

    fn push_text(&mut self, block: &Block, answers: &[Answer]) {
        let text = &mut self.bytes;
        let mut names = block.names();
        let mut number = itoa::Buffer::new();
        for (index, answer) in (block.before..).zip(answers) {
            push_name(text, names.next().unwrap_or_else(|| number.format(index)));
            let coordinate = match self.source.frame {
                Frame::Sensor => answer.point_mm,
                Frame::Pixel => self.camera.pixel_from_sensor(answer.point_mm),
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
    }
}

/// x, y in mm, dx, dy in µm.
fn push_numbers<const BYTES: usize>(
    bytes: &mut Vec<u8>,
    answers: &[Answer],
    number: impl Fn(f64) -> [u8; BYTES],
) {
    bytes.reserve(4 * BYTES * answers.len());
    for answer in answers {
        let [x, y] = answer.point_mm;
        let [dx, dy] = answer.distortion_mm;
        for value in [x, y, 1000.0 * dx, 1000.0 * dy] {
            bytes.extend_from_slice(&number(value));
        }
    }
}

/// A field of CSV, in quotes where it needs them; it holds no line break, as no name does.
fn push_name(text: &mut Vec<u8>, name: &str) {
    if !name.bytes().any(|byte| matches!(byte, b',' | b'"')) {
        text.extend_from_slice(name.as_bytes());
        return;
    }
    text.push(b'"');
    text.extend_from_slice(name.replace('"', "\"\"").as_bytes());
    text.push(b'"');
}
