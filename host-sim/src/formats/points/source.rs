//! A file of points, read ahead.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread;

use fmc_camera_file::{CameraFile, text_file};

use super::csv_points::CsvPoints;
use super::npy_points::NpyPoints;
use super::{Block, CoordinateFrame, PointFormat, Precision};
use crate::failure::Failure;

/// Number of blocks between the thread that reads and the one that answers.
const AHEAD: usize = 4;

/// A file of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Name of the file in messages.
    pub file: String,
    /// Frame of the points and of the answers.
    pub frame: CoordinateFrame,
    /// Number of points, where the header of the file states it.
    pub count: Option<u64>,
    /// Precision of an array's numbers.
    pub precision: Precision,
    /// Number of bytes to be read: the length of a file that has one, that of an array's rows.
    pub bytes: Option<u64>,
}

/// Points that the file may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Checked {
    /// Points of the sensor, edges included.
    OnSensor,
    /// Any points.
    Finite,
}

/// The points of a file, block by block, in order, read ahead by a thread.
#[derive(Debug)]
pub struct Blocks {
    full: Receiver<Result<Block, Failure>>,
    empty: Sender<Block>,
}

/// Reader of one of the formats.
enum Points {
    Csv(CsvPoints<Box<dyn Read + Send>>),
    Npy(NpyPoints<Box<dyn Read + Send>>),
}

impl Source {
    /// Opens a file, `-` for standard input, reads its header and begins to read its points.
    ///
    /// # Errors
    /// [`Failure`] naming the file and the error in its header.
    pub fn open(
        path: &Path,
        format: PointFormat,
        camera: &CameraFile,
        checked: Checked,
    ) -> Result<(Arc<Self>, Blocks), Failure> {
        if format == PointFormat::Parquet {
            return Err(for_frames());
        }
        let (file, bytes, stream): (_, _, Box<dyn Read + Send>) = if path == Path::new("-") {
            ("standard input".to_owned(), None, Box::new(io::stdin()))
        } else {
            let file = File::open(path).map_err(|error| Failure::reading(path, &error))?;
            let bytes = file.metadata().ok().filter(std::fs::Metadata::is_file);
            let bytes = bytes.map(|metadata| metadata.len());
            (path.display().to_string(), bytes, Box::new(file))
        };
        let (points, frame, count, precision, bytes) = match format {
            PointFormat::Csv => {
                let stream: Box<dyn Read + Send> = Box::new(text_file::of(&file, stream)?);
                let points = CsvPoints::new(&file, stream)?;
                let frame = points.frame();
                (Points::Csv(points), frame, None, Precision::Double, bytes)
            }
            // Parquet is refused above.
            PointFormat::Npy | PointFormat::Parquet => {
                let points = NpyPoints::new(&file, stream)?;
                let (count, precision) = (points.count(), points.precision());
                let bytes = Some(points.bytes());
                (
                    Points::Npy(points),
                    CoordinateFrame::Sensor,
                    Some(count),
                    precision,
                    bytes,
                )
            }
        };
        let source = Arc::new(Self {
            file,
            frame,
            count,
            precision,
            bytes,
        });
        let (full_sender, full) = sync_channel(AHEAD);
        let (empty, empty_receiver) = channel();
        let (shared, camera) = (Arc::clone(&source), camera.clone());
        // The thread is not joined: after an error elsewhere the process ends while the thread may
        // still wait for its input.
        thread::spawn(move || {
            read_ahead(
                points,
                &shared,
                &camera,
                checked,
                &full_sender,
                &empty_receiver,
            );
        });
        Ok((source, Blocks { full, empty }))
    }
}

/// Returns the failure of points in Parquet for one exposure.
pub(super) fn for_frames() -> Failure {
    Failure::bad_input("Parquet is for the points of --records and --frames")
        .with_help("the points of one exposure are CSV or an array of NumPy")
}

impl Blocks {
    /// Returns the next points; `None` behind the last.
    ///
    /// # Errors
    /// [`Failure`] of the first point that cannot be read; those before it have been returned.
    pub fn next_block(&mut self) -> Result<Option<Block>, Failure> {
        match self.full.recv() {
            Ok(block) => block.map(|block| (!block.is_empty()).then_some(block)),
            Err(_) => Err(Failure::device_or_io("the reader of points has ended")),
        }
    }

    /// Returns a block to the reader, to be filled again.
    pub fn reuse(&self, block: Block) {
        // Sending fails if the reader has ended, and then needs no block.
        let _ = self.empty.send(block);
    }
}

fn read_ahead(
    mut points: Points,
    source: &Source,
    camera: &CameraFile,
    checked: Checked,
    full: &SyncSender<Result<Block, Failure>>,
    empty: &Receiver<Block>,
) {
    loop {
        let mut block = empty.try_recv().unwrap_or_default();
        let filled = match &mut points {
            Points::Csv(points) => points.fill(&mut block, camera),
            Points::Npy(points) => points.fill(&mut block),
        };
        // A point off the sensor that comes before an unreadable one is reported first.
        let on_sensor = match checked {
            Checked::OnSensor => block.check_on_sensor(source, camera),
            Checked::Finite => Ok(()),
        };
        let last = block.is_empty();
        let block = on_sensor.and(filled).map(|()| block);
        let ends = last || block.is_err();
        if full.send(block).is_err() || ends {
            return;
        }
    }
}
