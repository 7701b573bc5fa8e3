//! Difference of two images, band of rows by band of rows.

use std::collections::VecDeque;
use std::path::Path;

use fmc_raster::{FrameReader, Header, Sample};
use fmc_rectification::comparison::{
    BLOCK_PX, BlockShift, GreyDifference, Plane, ShiftSummary, shifts,
};

use crate::command::rectify::frame_flow::read_failure;
use crate::failure::Failure;

/// Blocks above each other that are read at once.
const BLOCKS_AT_ONCE: usize = 8;

/// Differences of two images.
#[derive(Debug, Default)]
pub(in crate::command) struct ImageDifference {
    pub(in crate::command) size_px: [u32; 2],
    pub(in crate::command) grey: GreyDifference,
    pub(in crate::command) shifts: ShiftSummary,
    /// Pixels with content in one of the images alone.
    pub(in crate::command) one_sided: u64,
    /// Shift of the second image in every block of the first.
    pub(in crate::command) blocks: Vec<BlockShift>,
}

/// Compares two images, but for `edge` pixels along their edges and along what has no content.
///
/// # Errors
/// [`Failure`] naming the file, for one that is not read, or of another size or other bands.
pub(in crate::command) fn of(
    first: &Path,
    second: &Path,
    edge: usize,
) -> Result<ImageDifference, Failure> {
    let [mut first, mut second] = [Image::open(first)?, Image::open(second)?];
    second.check_like(&first)?;
    match first.reader.header().bits {
        8 => compare::<u8>(&mut first, &mut second, edge),
        _ => compare::<u16>(&mut first, &mut second, edge),
    }
}

struct Image<'a> {
    path: &'a Path,
    reader: FrameReader,
}

impl<'a> Image<'a> {
    fn open(path: &'a Path) -> Result<Self, Failure> {
        let reader = FrameReader::open(path).map_err(|error| read_failure(path, error))?;
        Ok(Self { path, reader })
    }

    fn check_like(&self, other: &Self) -> Result<(), Failure> {
        let facts = |header: &Header| {
            let Header {
                width_px,
                height_px,
                samples,
                bits,
                ..
            } = *header;
            format!("{width_px} x {height_px} px, {samples} x {bits} bits")
        };
        let [own, others] = [self, other].map(|image| facts(image.reader.header()));
        if own == others {
            return Ok(());
        }
        Err(Failure::bad_input(format!(
            "{}: {own}; allowed: {others}, as {}",
            self.path.display(),
            other.path.display()
        )))
    }

    fn row<S: Sample>(&mut self, row: &mut [S]) -> Result<(), Failure> {
        self.reader
            .read_rows(row)
            .map_err(|error| read_failure(self.path, error))?;
        Ok(())
    }
}

fn compare<S: Sample + Into<f32>>(
    first: &mut Image<'_>,
    second: &mut Image<'_>,
    edge: usize,
) -> Result<ImageDifference, Failure> {
    let header = first.reader.header().clone();
    let size_px = [header.width_px, header.height_px];
    of_rows::<S>(size_px, header.samples.into(), edge, |[a, b]| {
        first.row(a)?;
        second.row(b)
    })
}

/// Compares two images whose rows `next` fills in, but for `edge` pixels along their edges and
/// along what has no content.
///
/// # Errors
/// Those of `next`.
pub(in crate::command) fn of_rows<S: Sample + Into<f32>>(
    size_px: [u32; 2],
    bands: usize,
    edge: usize,
    mut next: impl FnMut(&mut [Vec<S>; 2]) -> Result<(), Failure>,
) -> Result<ImageDifference, Failure> {
    let [width, height] = size_px.map(|side| side as usize);
    let mut found = ImageDifference {
        size_px,
        ..ImageDifference::default()
    };
    let mut inside = Inside::new(width, edge);
    let mut waiting: VecDeque<[Vec<S>; 2]> = VecDeque::new();
    let mut blocks = BlockRows::default();
    // The rows behind the last one have no content.
    for row in 0..height + edge {
        if row < height {
            let mut pair = [(); 2].map(|()| vec![S::zeroed(); width * bands]);
            next(&mut pair)?;
            let [a, b] = pair.each_ref().map(|row| content(row, bands));
            let different = a.iter().zip(&b).filter(|(a, b)| a != b).count();
            found.one_sided += different as u64;
            inside.add([a, b]);
            waiting.push_back(pair);
        } else {
            inside.add([(); 2].map(|()| vec![false; width]));
        }
        let Some(pair) = (row >= edge).then(|| waiting.pop_front()).flatten() else {
            continue;
        };
        blocks.add(&pair, bands, &inside.mask, &mut found.grey);
        if blocks.mask.len() == width * BLOCK_PX * BLOCKS_AT_ONCE {
            blocks.end(width, &mut found);
        }
    }
    blocks.end(width, &mut found);
    Ok(found)
}

/// Returns which pixels of a row have content.
fn content<S: Sample>(row: &[S], bands: usize) -> Vec<bool> {
    let zero = S::zeroed();
    let pixels = row.chunks_exact(bands);
    pixels
        .map(|pixel| pixel.iter().any(|sample| *sample != zero))
        .collect()
}

/// Pixels farther than an edge from all that has no content.
struct Inside {
    edge: usize,
    /// Rows with content up to the last one, of every column.
    rows: Vec<usize>,
    /// Mask of the row that lies an edge before the last one, 1 for a pixel that counts.
    mask: Vec<u8>,
}

impl Inside {
    fn new(width: usize, edge: usize) -> Self {
        Self {
            edge,
            rows: vec![0; width],
            mask: vec![0; width],
        }
    }

    /// Adds the content of the next row of both images.
    fn add(&mut self, [a, b]: [Vec<bool>; 2]) {
        let side = 2 * self.edge + 1;
        for ((rows, a), b) in self.rows.iter_mut().zip(a).zip(b) {
            *rows = if a && b { *rows + 1 } else { 0 };
        }
        self.mask.fill(0);
        let mut columns = 0;
        for (column, rows) in self.rows.iter().enumerate() {
            columns = if *rows >= side { columns + 1 } else { 0 };
            let centre = column.checked_sub(self.edge).filter(|_| columns >= side);
            if let Some(mask) = centre.and_then(|centre| self.mask.get_mut(centre)) {
                *mask = 1;
            }
        }
    }
}

/// Rows of blocks, in which shifts are looked for at once.
#[derive(Default)]
struct BlockRows {
    /// Means of the bands.
    means: [Vec<f32>; 2],
    mask: Vec<u8>,
    /// Number of the first row.
    first: usize,
}

impl BlockRows {
    fn add<S: Sample + Into<f32>>(
        &mut self,
        pair: &[Vec<S>; 2],
        bands: usize,
        mask: &[u8],
        grey: &mut GreyDifference,
    ) {
        let count = f32::from(u16::try_from(bands).unwrap_or(1));
        for (means, row) in self.means.iter_mut().zip(pair) {
            means.extend(row.chunks_exact(bands).map(|pixel| {
                let sum: f32 = pixel.iter().map(|sample| (*sample).into()).sum();
                sum / count
            }));
        }
        self.mask.extend(mask);
        let [a, b] = pair;
        let pixels = a.chunks_exact(bands).zip(b.chunks_exact(bands));
        for ((a, b), _) in pixels.zip(mask).filter(|(_, mask)| **mask != 0) {
            for (a, b) in a.iter().zip(b) {
                let [a, b]: [f32; 2] = [(*a).into(), (*b).into()];
                grey.add(a.into(), b.into());
            }
        }
    }

    /// Finds the shifts of the rows, and forgets them.
    fn end(&mut self, width: usize, found: &mut ImageDifference) {
        let [a, b] = &self.means;
        let planes = [a, b].map(|means| Plane::new(width, means, Some(&self.mask)));
        if let [Some(a), Some(b)] = planes {
            for mut block in shifts(&a, &b) {
                found.shifts.add(&block);
                let [_, row] = &mut block.first_px;
                *row += self.first;
                found.blocks.push(block);
            }
        }
        self.first += self.mask.len() / width;
        self.means.iter_mut().for_each(Vec::clear);
        self.mask.clear();
    }
}
