//! Rows of a mesh, many at a time.

use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::{CorrectionMesh, PixelCorrection};
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};
use fmc_camera::io::link::MAX_POINTS;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use super::{Content, Layout};
use crate::device::{Device, DeviceError};

/// Bytes of the rows that are computed together, unless a row is longer: they fit the second-level
/// cache.
const TOGETHER: usize = 1 << 20;

/// Number of vertices in a request to a camera behind the link.
const PER_REQUEST: u16 = {
    assert!(
        MAX_POINTS <= u16::MAX as usize,
        "a request counts in 16 bits"
    );
    #[expect(clippy::cast_possible_truncation, reason = "it was compared")]
    let most = MAX_POINTS as u16;
    most
};

/// Rows of a mesh in their order.
pub(super) struct Rows<'a> {
    device: &'a mut dyn Device,
    layout: &'a Layout,
    next: u32,
    bytes: Vec<u8>,
    bar: ProgressBar,
}

impl<'a> Rows<'a> {
    pub(super) fn new(device: &'a mut dyn Device, layout: &'a Layout) -> Self {
        let bar = ProgressBar::new(u64::from(layout.vertices[1]));
        if let Ok(style) = ProgressStyle::with_template("mesh {wide_bar} {pos}/{len} rows, {eta}") {
            bar.set_style(style);
        }
        Self {
            device,
            layout,
            next: 0,
            bytes: Vec::new(),
            bar,
        }
    }

    /// Bytes of the rows that were computed last.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Computes the next rows; `false` after the last.
    pub(super) fn advance(&mut self) -> Result<bool, DeviceError> {
        let [columns, rows] = self.layout.vertices;
        if self.next >= rows {
            self.bar.finish_and_clear();
            return Ok(false);
        }
        let row_bytes = columns as usize * self.layout.content.bytes();
        let together = (TOGETHER / row_bytes).clamp(1, (rows - self.next) as usize);
        let first = self.next;
        self.bytes.resize(together * row_bytes, 0);
        match self.device.correction_here() {
            Some(correction) => compute(correction, self.layout, first, &mut self.bytes)?,
            None => {
                for (row, bytes) in (first..).zip(self.bytes.chunks_exact_mut(row_bytes)) {
                    ask(self.device, self.layout, row, bytes)?;
                }
            }
        }
        let computed = u32::try_from(together).unwrap_or(u32::MAX);
        self.next = first.saturating_add(computed);
        self.bar.inc(u64::from(computed));
        Ok(true)
    }
}

impl Content {
    /// Returns the number of bytes of a vertex.
    const fn bytes(self) -> usize {
        match self {
            Self::Sources(format) => format.bytes(),
            Self::Corrections => size_of::<PixelCorrection>(),
        }
    }
}

/// Fetches a row from a camera behind the link.
fn ask(
    device: &mut dyn Device,
    layout: &Layout,
    row: u32,
    mut bytes: &mut [u8],
) -> Result<(), DeviceError> {
    for request in layout.requests(row, PER_REQUEST) {
        let count = usize::from(request.count) * layout.content.bytes();
        let (now, behind) = bytes.split_at_mut(count.min(bytes.len()));
        match layout.content {
            Content::Sources(format) => {
                let words = device.mesh(&request, format)?;
                now.iter_mut().zip(words).for_each(|(to, from)| *to = from);
            }
            Content::Corrections => store(&device.corrections(&request)?, now),
        }
        bytes = behind;
    }
    Ok(())
}

/// Computes rows in this process, in all threads: the bits are those of any camera.
fn compute(
    correction: &FrameCorrection,
    layout: &Layout,
    first: u32,
    bytes: &mut [u8],
) -> Result<(), DeviceError> {
    let row_bytes = layout.vertices[0] as usize * layout.content.bytes();
    let rows = bytes.par_chunks_mut(row_bytes).zip(first..u32::MAX);
    let results: Vec<Result<(), MeshError>> = match layout.content {
        Content::Sources(format) => {
            let mesh = SourceMesh::new(correction, layout.spacing_px);
            // Without blocks the vertices of a request are predicted from one another.
            let most = mesh.block_length().map_or(PER_REQUEST, |_| u16::MAX);
            rows.map(|(bytes, row)| words(&mesh, format, layout.requests(row, most), bytes))
                .collect()
        }
        Content::Corrections => {
            let mesh = CorrectionMesh::new(correction, layout.spacing_px);
            rows.map(|(bytes, row)| corrections(&mesh, layout.requests(row, PER_REQUEST), bytes))
                .collect()
        }
    };
    let first_error = results.into_iter().find_map(Result::err);
    first_error.map_or(Ok(()), |error| Err(DeviceError::Mesh(error)))
}

fn words(
    mesh: &SourceMesh<'_>,
    format: MeshFormat,
    requests: impl Iterator<Item = VertexRow>,
    mut bytes: &mut [u8],
) -> Result<(), MeshError> {
    for request in requests {
        let written = request.write_words(mesh, format, bytes)?.len();
        bytes = bytes.get_mut(written..).unwrap_or_default();
    }
    Ok(())
}

fn corrections(
    mesh: &CorrectionMesh,
    requests: impl Iterator<Item = VertexRow>,
    mut bytes: &mut [u8],
) -> Result<(), MeshError> {
    let mut corrections = [PixelCorrection::default(); MAX_POINTS];
    for request in requests {
        let found = request.corrections(mesh, &mut corrections)?;
        let count = size_of_val(found).min(bytes.len());
        let (now, behind) = bytes.split_at_mut(count);
        store(found, now);
        bytes = behind;
    }
    Ok(())
}

/// Stores corrections as graphics processors read them.
fn store(corrections: &[PixelCorrection], bytes: &mut [u8]) {
    let (numbers, _) = bytes.as_chunks_mut::<4>();
    let corrections = corrections
        .iter()
        .flat_map(|correction| [correction.cols_px, correction.rows_px]);
    for (bytes, number) in numbers.iter_mut().zip(corrections) {
        *bytes = number.to_le_bytes();
    }
}
