//! Images written row by row.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;

use fmc_output::part::Part;
use fmc_raster::{
    ByteOrder, ChunkEncoder, Chunks, Compression, FramePlan, Header, Metadata, PlanOptions, Sample,
    TagOptions, TiffFile, WriteError,
};
use rayon::prelude::*;

use crate::failure::Failure;

/// Rows of a strip, which are computed at once.
const STRIP_ROWS: u32 = 16;

/// Size and samples of an image.
#[derive(Debug, Clone, Copy)]
pub(in crate::command) struct Format {
    pub(in crate::command) size_px: [u32; 2],
    pub(in crate::command) bands: u8,
    pub(in crate::command) bits: u8,
}

/// Writes an image without compression, whose rows are computed in several threads.
///
/// # Errors
/// [`Failure`] naming the file, which appears only when it is complete.
pub(in crate::command) fn write(
    path: &Path,
    format: Format,
    row: impl Fn(u32) -> Vec<f64> + Sync,
) -> Result<(), Failure> {
    let failed = |error: WriteError| match error {
        WriteError::Io(error) => Failure::writing(path.display(), &error),
        error => Failure::device_or_io(format!("{}: {error}", path.display())),
    };
    let io = |error| Failure::writing(path.display(), &error);
    let plan =
        plan(format).map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
    let mut part = Part::create(path.to_path_buf()).map_err(io)?;
    let mut file = BufWriter::new(part.file_mut());
    if format.bits == 8 {
        rows::<u8>(&plan, format, &mut file, row, eight_bits).map_err(failed)?;
    } else {
        rows::<u16>(&plan, format, &mut file, row, sixteen_bits).map_err(failed)?;
    }
    file.flush().map_err(io)?;
    drop(file);
    part.complete().map_err(io)
}

fn plan(format: Format) -> Result<FramePlan, fmc_raster::PlanError> {
    let [width_px, height_px] = format.size_px;
    let header = Header {
        width_px,
        height_px,
        samples: u16::from(format.bands),
        bits: u16::from(format.bits),
        photometric: if format.bands == 1 { 1 } else { 2 },
        extra_samples: vec![0; usize::from(format.bands == 4)],
        compression: Compression::None,
        predictor: false,
        chunks: Chunks::Strips {
            rows: STRIP_ROWS.min(height_px),
        },
        planar: false,
        byte_order: ByteOrder::native(),
        big: false,
    };
    FramePlan::new(&header, format.size_px, &PlanOptions::default())
}

fn rows<S: Sample>(
    plan: &FramePlan,
    format: Format,
    file: &mut BufWriter<&mut File>,
    row: impl Fn(u32) -> Vec<f64> + Sync,
    sample: impl Fn(f64) -> S + Sync,
) -> Result<(), WriteError> {
    let tags = Metadata::default().output(&TagOptions::default());
    let mut tiff = TiffFile::new(file, plan)?;
    let mut frame = tiff.frame(plan, &tags)?;
    let mut encoder = ChunkEncoder::new(plan)?;
    let [_, height_px] = format.size_px;
    for first in (0..height_px).step_by(STRIP_ROWS as usize) {
        let strip: Vec<S> = (first..height_px.min(first + STRIP_ROWS))
            .into_par_iter()
            .flat_map_iter(|number| row(number).into_iter().map(&sample))
            .collect();
        encoder.encode(&strip, &mut |piece| frame.write(piece))?;
    }
    frame.finish()
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number from 0 to 255"
)]
fn eight_bits(value: f64) -> u8 {
    value as u8
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number from 0 to 65535"
)]
pub(super) fn sixteen_bits(value: f64) -> u16 {
    value as u16
}
