//! A file of points of many frames.

use std::fmt;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use fmc_camera_file::{CameraFile, text_file};

use super::answers::{AnsweredBlock, OutColumns};
use super::block::FrameBlock;
use super::csv_header::IdColumn;
use super::csv_rows::{CsvAnswers, CsvRows};
use super::frame_key::FrameFinder;
use super::npy_rows::{NpyAnswers, NpyRows};
use super::parquet_answers::ParquetAnswers;
use super::parquet_rows::{self, ParquetRows};
use super::read_ahead::FrameBlocks;
use crate::failure::Failure;
use crate::formats::points::{CoordinateFrame, PointFormat};

/// Reader of one of the formats.
pub(super) trait RowReader: Send {
    /// Reads the next points into a block; it stays empty at the end.
    ///
    /// # Errors
    /// [`Failure`] naming file, place, column and value; the points before it are in the block.
    fn fill(&mut self, block: &mut FrameBlock, camera: &CameraFile) -> Result<(), Failure>;
}

/// Writer of answers in one of the formats.
pub trait RowWriter {
    /// Writes what comes before the first answer.
    ///
    /// # Errors
    /// Those of the sink.
    fn begin(&mut self, sink: &mut dyn Write) -> io::Result<()>;

    /// Writes the answers to a block.
    ///
    /// # Errors
    /// Those of the sink.
    fn write(&mut self, answered: &AnsweredBlock<'_>, sink: &mut dyn Write) -> io::Result<()>;

    /// Writes what comes behind the last answer.
    ///
    /// # Errors
    /// Those of the sink.
    fn end(&mut self, sink: &mut dyn Write) -> io::Result<()>;
}

/// A file of points of many frames, opened.
pub struct FrameSource {
    /// Name of the file in messages.
    pub file: String,
    /// Frame of the points and of the answers.
    pub frame: CoordinateFrame,
    /// Column of the names of the points, if it is CSV with one.
    pub ids: Option<IdColumn>,
    /// Number of bytes to be read, where it is known.
    pub bytes: Option<u64>,
    /// Reader of its points.
    pub blocks: FrameBlocks,
    /// Writer of the answers, in the format of the points.
    pub writer: Box<dyn RowWriter>,
}

impl fmt::Debug for FrameSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FrameSource")
            .field("file", &self.file)
            .field("frame", &self.frame)
            .finish_non_exhaustive()
    }
}

impl FrameSource {
    /// Opens a file, `-` for standard input, reads its header and begins to read its points.
    ///
    /// # Errors
    /// [`Failure`] naming the file and the error in its header.
    pub fn open(
        path: &Path,
        format: PointFormat,
        camera: &CameraFile,
        finder: FrameFinder,
        out: OutColumns,
    ) -> Result<Self, Failure> {
        if format == PointFormat::Parquet {
            return Self::parquet(path, camera, finder, out);
        }
        let (file, bytes, stream): (_, _, Box<dyn Read + Send>) = if path == Path::new("-") {
            ("standard input".to_owned(), None, Box::new(io::stdin()))
        } else {
            let file = File::open(path).map_err(|error| Failure::reading(path, &error))?;
            let bytes = file.metadata().ok().filter(std::fs::Metadata::is_file);
            let bytes = bytes.map(|metadata| metadata.len());
            (path.display().to_string(), bytes, Box::new(file))
        };
        let mut ids = None;
        let (reader, writer, frame): (Box<dyn RowReader>, Box<dyn RowWriter>, _) = match format {
            PointFormat::Csv => {
                let stream: Box<dyn Read + Send> = Box::new(text_file::of(&file, stream)?);
                let rows = CsvRows::new(&file, stream, finder)?;
                let writer = CsvAnswers::new(rows.header(), out);
                let frame = rows.header().frame;
                ids = rows.header().ids();
                (Box::new(rows), Box::new(writer), frame)
            }
            // Opened above.
            PointFormat::Npy | PointFormat::Parquet => {
                let rows = NpyRows::new(&file, stream, finder)?;
                if out.skip {
                    return Err(Failure::bad_input(format!(
                        "--off-sensor skip: the header of an array states the number of its rows before the first of \
                         them; flag them in {file}, or give the points as CSV"
                    )));
                }
                let writer = NpyAnswers::new(rows.layout(), rows.count(), out)
                    .map_err(|fault| Failure::bad_input(format!("{file}: the array {fault}")))?;
                let frame = rows.layout().frame;
                (Box::new(rows), Box::new(writer), frame)
            }
        };
        Ok(Self {
            frame,
            ids,
            bytes,
            blocks: FrameBlocks::of(reader, camera),
            writer,
            file,
        })
    }

    /// Opens a Parquet file, whose description is at its end.
    fn parquet(
        path: &Path,
        camera: &CameraFile,
        finder: FrameFinder,
        out: OutColumns,
    ) -> Result<Self, Failure> {
        if path == Path::new("-") {
            return Err(Failure::bad_input(
                "a file of Parquet cannot be read from standard input: its description is at its end",
            ));
        }
        let name = path.display().to_string();
        let file = File::open(path).map_err(|error| Failure::reading(path, &error))?;
        let bytes = file.metadata().ok().map(|metadata| metadata.len());
        let rows = ParquetRows::new(&name, file, finder)?;
        let writer = ParquetAnswers::new(rows.schema(), out)
            .map_err(|error| parquet_rows::failure(&name, &error))?;
        Ok(Self {
            frame: rows.schema().frame,
            ids: None,
            bytes,
            blocks: FrameBlocks::of(Box::new(rows), camera),
            writer: Box::new(writer),
            file: name,
        })
    }
}
