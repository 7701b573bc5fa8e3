//! A frame on its way from file to file.

use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::Path;

use fmc_camera_file::InputError;
use fmc_raster::{
    ChunkEncoder, Chunks, FramePlan, FrameReader, FrameWriter, Header, Mask, PixelCrc, PlanOptions,
    ReadError, TagOptions, TiffFile, WriteError,
};
use fmc_rectification::Rectification;
use fmc_rectification::streaming::{RowSink, RowSource, StreamError, stream};

use super::progress::Progress;
use super::task::FrameTask;
use crate::failure::Failure;

/// A frame on its way from file to file.
pub(super) struct FrameFlow<'a> {
    pub(super) task: &'a FrameTask,
    pub(super) rectification: &'a Rectification,
    pub(super) header: &'a Header,
    pub(super) layout: &'a PlanOptions,
    pub(super) plan: FramePlan,
    pub(super) tags: TagOptions,
    pub(super) mask: bool,
    pub(super) progress: &'a Progress,
    pub(super) memory_bytes: u64,
    /// The rectified image, as messages name it.
    pub(super) out: &'a Path,
}

/// Facts that are known once all rows have been written.
pub(super) struct FlowResult {
    pub(super) input_crc: u32,
    pub(super) output_crc: u32,
    pub(super) border: u64,
    pub(super) notes: Vec<String>,
}

impl FrameFlow<'_> {
    /// Rectifies the frame.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub(super) fn run<S>(&self, reader: FrameReader, file: &mut File) -> Result<FlowResult, Failure>
    where
        S: fmc_raster::Sample + fmc_rectification::Sample,
    {
        let mut file = BufWriter::new(file);
        let done = self.write::<S, _>(reader, &mut file)?;
        // A full disk may be reported only here.
        file.flush()
            .map_err(|error| write_failure(self.out, WriteError::Io(error)))?;
        Ok(done)
    }

    fn write<S, W>(&self, reader: FrameReader, file: W) -> Result<FlowResult, Failure>
    where
        S: fmc_raster::Sample + fmc_rectification::Sample,
        W: Write + Seek + Send,
    {
        let writing = |error: WriteError| write_failure(self.out, error);
        let tags = reader.metadata().output(&self.tags);
        let size_px = self.rectification.output_size_px();
        let mask_bytes = Mask::bound_bytes(size_px);
        let beside = tags.bound_bytes() + if self.mask { mask_bytes } else { 0 };
        let plan = self.plan.clone().with_bytes_beside(beside);
        let mut notes: Vec<String> = Vec::new();
        if self.header.is_one_strip() {
            notes.push("one strip holds the whole frame; it is read row by row".to_owned());
        }
        let asked = self.layout.chunks.is_some();
        if let (Chunks::Tiles { .. }, Chunks::Strips { rows }, false) =
            (self.header.chunks, plan.chunks(), asked)
        {
            notes.push(format!(
                "its tiles are too large to be held; strips of {rows} rows are written"
            ));
        }
        for dropped in tags.dropped() {
            notes.push(format!("{} is left out: {}", dropped.name, dropped.why));
        }
        let mut tiff = TiffFile::new(file, &plan).map_err(writing)?;
        let mut frame = tiff.frame(&plan, &tags).map_err(writing)?;
        let mut source = Source {
            reader,
            crc: PixelCrc::default(),
        };
        let mut sink = Sink {
            encoder: ChunkEncoder::new(&plan).map_err(writing)?,
            frame: &mut frame,
            crc: PixelCrc::default(),
            mask: self.mask.then(|| Mask::new(size_px)),
            rows: 0,
            width: size_px[0] as usize,
            height: size_px[1] as usize,
            progress: self.progress,
        };
        let bands = usize::from(self.header.samples);
        let border = stream::<S, _, _>(
            self.rectification,
            bands,
            self.memory_bytes,
            &mut source,
            &mut sink,
        )
        .map_err(|error| match error {
            StreamError::Source(error) => read_failure(&self.task.path, error),
            StreamError::Sink(error) => writing(error),
            error @ StreamError::Memory { .. } => {
                Failure::bad_input(format!("{}: --memory: {error}", self.task.name))
            }
            error => Failure::bad_input(format!("{}: {error}", self.task.name)),
        })?;
        let (output_crc, mask) = (sink.crc.value(), sink.mask.take());
        frame.finish().map_err(writing)?;
        if let Some(mask) = mask {
            tiff.mask(&mask).map_err(writing)?;
        }
        Ok(FlowResult {
            input_crc: source.crc.value(),
            output_crc,
            border,
            notes,
        })
    }
}

/// Rows of the recorded frame.
struct Source {
    reader: FrameReader,
    crc: PixelCrc,
}

impl<S: fmc_raster::Sample> RowSource<S> for Source {
    type Error = ReadError;

    fn read(&mut self, row: &mut [S]) -> Result<(), ReadError> {
        self.reader.read_rows(row)?;
        self.crc.update(row);
        Ok(())
    }
}

/// Rows of the rectified image.
struct Sink<'a, 'file, W: Write + Seek> {
    encoder: ChunkEncoder,
    frame: &'a mut FrameWriter<'file, W>,
    crc: PixelCrc,
    mask: Option<Mask>,
    rows: usize,
    width: usize,
    height: usize,
    progress: &'a Progress,
}

impl<S: fmc_raster::Sample, W: Write + Seek + Send> RowSink<S> for Sink<'_, '_, W> {
    type Error = WriteError;

    fn write(&mut self, rows: &[S], mask: &[u8]) -> Result<(), WriteError> {
        self.crc.update(rows);
        let frame = &mut *self.frame;
        self.encoder.encode(rows, &mut |piece| frame.write(piece))?;
        for row in mask.chunks_exact(self.width) {
            if let Some(page) = &mut self.mask {
                page.push_row(row.iter().map(|pixel| *pixel != 0))?;
            }
            self.rows += 1;
        }
        self.progress.within(self.rows, self.height);
        Ok(())
    }
}

/// Returns the failure to read an image: a failing disk is not the image's.
pub(in crate::command) fn read_failure(path: &Path, error: ReadError) -> Failure {
    match error {
        ReadError::Io { source, .. } => InputError::reading(path, &source).into(),
        error => Failure::bad_input(format!("{}: {error}", path.display())),
    }
}

fn write_failure(out: &Path, error: WriteError) -> Failure {
    let name = out.display();
    match error {
        WriteError::Io(error) => Failure::writing(name, &error),
        error => Failure::device_or_io(format!("{name}: {error}")),
    }
}
