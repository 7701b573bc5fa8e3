//! A frame's rows from a source that delivers them in order to a sink that takes them in order.

use std::collections::VecDeque;
use std::ops::Range;

use rayon::prelude::*;

use crate::{Rectification, RowError, Sample, SourceBand};

/// Rows of the output that are resampled at once, if the memory suffices.
pub const BAND_ROWS: u32 = 64;

/// Source of the rows of a recorded frame, from the first to the last.
pub trait RowSource<S>: Send {
    /// Error of the source.
    type Error: Send;

    /// Fills a slice with the next row, interleaved samples.
    ///
    /// # Errors
    /// Those of the source; nothing is read after one.
    fn read(&mut self, row: &mut [S]) -> Result<(), Self::Error>;
}

/// Sink of the rows of a rectified frame, from the first to the last.
pub trait RowSink<S>: Send {
    /// Error of the sink.
    type Error: Send;

    /// Takes the next rows, interleaved samples, with their mask: a byte for each pixel, 1, or 0
    /// for border.
    ///
    /// # Errors
    /// Those of the sink; nothing is written after one.
    fn write(&mut self, rows: &[S], mask: &[u8]) -> Result<(), Self::Error>;
}

/// A frame whose rows did not flow to the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StreamError<E, F> {
    /// The source failed.
    #[error(transparent)]
    Source(E),
    /// The sink failed.
    #[error(transparent)]
    Sink(F),
    /// A row was not resampled.
    #[error(transparent)]
    Row(RowError),
    /// The image does not have a number of bands or a size that is resampled.
    #[error("{bands} bands of {width_px} pixels; allowed: 1, 3 or 4 bands of at most 2^30 samples")]
    Image {
        /// Samples per pixel.
        bands: usize,
        /// Width of the recorded frame.
        width_px: u32,
    },
    /// The rows that a row of the output needs do not fit into the memory.
    #[error("the rows of one frame need {needed_bytes} bytes, and {most_bytes} are allowed")]
    Memory {
        /// Bytes of the smallest band and of its source rows.
        needed_bytes: u64,
        /// Largest memory.
        most_bytes: u64,
    },
}

/// Rectifies a frame row by row, in the threads of the current pool of `rayon`: the next rows are
/// read and the last ones written while those between are resampled. Returns the number of border
/// pixels.
///
/// All rows of the source are read, also those that the output does not need. The rows that are
/// written depend on neither threads nor memory.
///
/// # Errors
/// [`StreamError`].
pub fn stream<S: Sample, R: RowSource<S>, W: RowSink<S>>(
    rectification: &Rectification,
    bands: usize,
    most_bytes: u64,
    source: &mut R,
    sink: &mut W,
) -> Result<u64, StreamError<R::Error, W::Error>> {
    let [width_px, height_px] = rectification.sensor_px();
    let plan = BandPlan::within(rectification, bands * size_of::<S>(), most_bytes);
    let plan = plan.map_err(|needed_bytes| StreamError::Memory {
        needed_bytes,
        most_bytes,
    })?;
    let mut reader = Reader {
        source,
        row_samples: width_px as usize * bands,
        next_px: 0,
        spare: Vec::new(),
    };
    let mut held: VecDeque<Vec<S>> = VecDeque::new();
    let [mut now, mut done] = [(); 2].map(|()| OutputRows::<S>::default());
    let mut border = 0;
    let first = plan.steps.first();
    held.extend(reader.advance(first).map_err(StreamError::Source)?);
    let next_steps = plan.steps.iter().skip(1).map(Some).chain([None]);
    for (step, next) in plan.steps.iter().zip(next_steps) {
        while !held.is_empty() && reader.first_of(&held) < step.keep_from {
            reader.spare.extend(held.pop_front());
        }
        let first_px = reader.first_of(&held);
        let rows: Vec<&[S]> = held.iter().map(Vec::as_slice).collect();
        let band = SourceBand::new([width_px, height_px], bands, first_px, &rows)
            .ok_or(StreamError::Image { bands, width_px })?;
        let (read, (resampled, written)) = rayon::join(
            || reader.advance(next),
            || {
                rayon::join(
                    || now.resample(rectification, step.rows.clone(), &band),
                    || done.write(sink),
                )
            },
        );
        written.map_err(StreamError::Sink)?;
        border += resampled.map_err(StreamError::Row)?;
        held.extend(read.map_err(StreamError::Source)?);
        std::mem::swap(&mut now, &mut done);
    }
    done.write(sink).map_err(StreamError::Sink)?;
    reader.pass(height_px).map_err(StreamError::Source)?;
    Ok(border)
}

/// Bands of the output, and the source rows that each needs.
#[derive(Debug, PartialEq, Eq)]
struct BandPlan {
    steps: Vec<Step>,
}

/// A band of the output.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Step {
    /// Rows of the output.
    rows: Range<u32>,
    /// First row of the source that this or a later band needs.
    keep_from: u32,
    /// Row of the source up to which this or an earlier band needs it.
    read_to: u32,
}

impl BandPlan {
    /// Returns the plan with the longest bands that fit, or the bytes that the shortest need.
    fn within(
        rectification: &Rectification,
        pixel_bytes: usize,
        most_bytes: u64,
    ) -> Result<Self, u64> {
        let mut rows = BAND_ROWS;
        loop {
            let plan = Self::new(rectification, rows);
            let needed_bytes = plan.bytes(rectification, pixel_bytes);
            if needed_bytes <= most_bytes {
                return Ok(plan);
            }
            if rows == 1 {
                return Err(needed_bytes);
            }
            rows /= 2;
        }
    }

    fn new(rectification: &Rectification, band_rows: u32) -> Self {
        let [_, height_px] = rectification.output_size_px();
        let mut steps: Vec<Step> = Vec::new();
        let (mut first, mut read_to) = (0, 0);
        while first < height_px {
            let rows = first..first.saturating_add(band_rows).min(height_px);
            first = rows.end;
            let needed = rectification.source_rows(rows.clone());
            let keep_from = if needed.is_empty() {
                u32::MAX
            } else {
                read_to = needed.end.max(read_to);
                needed.start
            };
            steps.push(Step {
                rows,
                keep_from,
                read_to,
            });
        }
        let mut keep_from = read_to;
        for step in steps.iter_mut().rev() {
            keep_from = keep_from.min(step.keep_from);
            step.keep_from = keep_from;
        }
        Self { steps }
    }

    /// Bytes of the source rows that are held and read ahead, and of two bands of the output with
    /// their masks.
    fn bytes(&self, rectification: &Rectification, pixel_bytes: usize) -> u64 {
        let [source_width_px, _] = rectification.sensor_px();
        let [width_px, _] = rectification.output_size_px();
        let next = self.steps.iter().skip(1).chain(self.steps.last());
        let source_rows = self
            .steps
            .iter()
            .zip(next)
            .map(|(step, next)| next.read_to.saturating_sub(step.keep_from));
        let rows = self
            .steps
            .iter()
            .map(|step| step.rows.end - step.rows.start);
        let source = u64::from(source_rows.max().unwrap_or(0)) * u64::from(source_width_px);
        let output = 2 * u64::from(rows.max().unwrap_or(0)) * u64::from(width_px);
        (source + output) * pixel_bytes as u64 + output
    }
}

/// Source of rows, and the buffers of those that are no longer needed.
struct Reader<'a, R, S> {
    source: &'a mut R,
    row_samples: usize,
    next_px: u32,
    spare: Vec<Vec<S>>,
}

impl<S: Sample, R: RowSource<S>> Reader<'_, R, S> {
    /// Returns the number of the first of the rows that have been read last.
    fn first_of(&self, held: &VecDeque<Vec<S>>) -> u32 {
        let count = u32::try_from(held.len()).unwrap_or(u32::MAX);
        self.next_px.saturating_sub(count)
    }

    /// Reads the rows that a band needs and those before did not.
    fn advance(&mut self, step: Option<&Step>) -> Result<Vec<Vec<S>>, R::Error> {
        let Some(step) = step else {
            return Ok(Vec::new());
        };
        let mut rows = Vec::new();
        self.pass(step.keep_from)?;
        while self.next_px < step.read_to {
            let mut row = self.spare.pop().unwrap_or_default();
            self.read(&mut row)?;
            rows.push(row);
        }
        Ok(rows)
    }

    /// Reads rows that no band needs.
    fn pass(&mut self, to_px: u32) -> Result<(), R::Error> {
        let mut row = self.spare.pop().unwrap_or_default();
        while self.next_px < to_px {
            self.read(&mut row)?;
        }
        self.spare.push(row);
        Ok(())
    }

    fn read(&mut self, row: &mut Vec<S>) -> Result<(), R::Error> {
        row.resize(self.row_samples, S::default());
        self.source.read(row)?;
        self.next_px += 1;
        Ok(())
    }
}

/// Rows of the output that have been resampled and not written.
#[derive(Debug, Default)]
struct OutputRows<S> {
    samples: Vec<S>,
    mask: Vec<u8>,
    /// The rows have been written: what the buffers hold is overwritten by the next ones.
    are_written: bool,
}

impl<S: Sample> OutputRows<S> {
    /// Resamples rows, and returns the number of border pixels.
    fn resample(
        &mut self,
        rectification: &Rectification,
        rows: Range<u32>,
        source: &SourceBand<'_, S>,
    ) -> Result<u64, RowError> {
        let [width_px, _] = rectification.output_size_px();
        let (count, width) = ((rows.end - rows.start) as usize, width_px as usize);
        let row_samples = width * source.bands();
        self.samples.resize(count * row_samples, S::default());
        self.mask.resize(count * width, 0);
        self.are_written = false;
        let out = self.samples.par_chunks_exact_mut(row_samples);
        let mask = self.mask.par_chunks_exact_mut(width);
        rows.into_par_iter()
            .zip(out)
            .zip(mask)
            .map(|((row_px, out), mask)| {
                let border = rectification.row(row_px, source, out, mask);
                border.map(u64::from)
            })
            .try_reduce(|| 0, |one, other| Ok(one + other))
    }

    /// Writes the rows that have not been written.
    fn write<W: RowSink<S>>(&mut self, sink: &mut W) -> Result<(), W::Error> {
        if !self.samples.is_empty() && !self.are_written {
            sink.write(&self.samples, &self.mask)?;
        }
        self.are_written = true;
        Ok(())
    }
}
