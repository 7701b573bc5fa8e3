//! The recorded frame that a description names.

use std::path::Path;

use fmc_raster::{FrameReader, PixelCrc, ReadError, Sample};

use super::sidecar::{FileState, Input};
use super::task::FrameTask;

/// Returns true if the frame of a task is the one that a description names: by name, length and
/// time of change, which the description's file has taken over, or else, as for copies, by the CRCs
/// of description and pixels, for which it is read. Its time is then taken over.
pub(super) fn is_that_of(input: &Input, sidecar: &Path, task: &FrameTask) -> bool {
    let Ok(state) = FileState::of(&task.path) else {
        return false;
    };
    if input.file != task.file_name() || input.bytes != state.bytes {
        return false;
    }
    if state.has_marked(sidecar) {
        return true;
    }
    let is_same = crcs(&task.path).is_ok_and(|[description, pixels]| {
        input.description_crc32 == format!("{description:08x}")
            && input.pixels_crc32 == format!("{pixels:08x}")
    });
    if is_same && FileState::of(&task.path).ok() == Some(state) {
        state.mark(sidecar);
    }
    is_same
}

/// Returns the CRC-32 of a frame's layout and tags, and that of its pixels.
fn crcs(path: &Path) -> Result<[u32; 2], ReadError> {
    let reader = FrameReader::open(path)?;
    let description = reader.description_crc();
    let pixels = match reader.header().bits {
        8 => pixels_crc::<u8>(reader)?,
        _ => pixels_crc::<u16>(reader)?,
    };
    Ok([description, pixels])
}

fn pixels_crc<S: Sample + Default>(mut reader: FrameReader) -> Result<u32, ReadError> {
    let mut crc = PixelCrc::default();
    let mut row = vec![S::default(); reader.header().row_samples()];
    while reader.read_rows(&mut row)? > 0 {
        crc.update(&row);
    }
    Ok(crc.value())
}
