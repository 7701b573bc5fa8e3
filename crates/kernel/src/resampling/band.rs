//! Rows of a source image that are in memory.

/// Numbers of bands that are resampled.
pub const BANDS: [usize; 3] = [1, 3, 4];

/// Rows of a source image that are in memory, one slice of interleaved samples each.
#[derive(Debug, Clone, Copy)]
pub struct Band<'a, S> {
    size_px: [u32; 2],
    bands: usize,
    first_row_px: u32,
    rows: &'a [&'a [S]],
}

impl<'a, S> Band<'a, S> {
    /// Returns rows of an image of `size_px` (width, height), from `first_row_px` on; `None` unless
    /// the number of bands is one of [`BANDS`], every row has the samples of the
    /// image's width, the image is not empty and its sides are within 2³⁰ samples.
    #[must_use]
    pub fn new(
        size_px: [u32; 2],
        bands: usize,
        first_row_px: u32,
        rows: &'a [&'a [S]],
    ) -> Option<Self> {
        let [width, height] = size_px;
        let samples = usize::try_from(width).ok()?.checked_mul(bands)?;
        let fits = samples <= 1 << 30 && height <= 1 << 30 && first_row_px <= height;
        let valid = fits
            && samples > 0
            && height > 0
            && BANDS.contains(&bands)
            && rows.iter().all(|row| row.len() == samples);
        valid.then_some(Self {
            size_px,
            bands,
            first_row_px,
            rows,
        })
    }

    /// Width and height of the image.
    #[must_use]
    pub const fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Samples per pixel.
    #[must_use]
    pub const fn bands(&self) -> usize {
        self.bands
    }

    /// Samples of every row.
    #[inline(always)]
    pub(super) fn samples_of_row(&self) -> usize {
        // The product fits, as was found when the band was made.
        self.size_px[0] as usize * self.bands
    }

    /// Rows of the image that are in memory.
    #[must_use]
    pub fn rows_px(&self) -> core::ops::Range<u32> {
        let count = u32::try_from(self.rows.len()).unwrap_or(u32::MAX);
        self.first_row_px..self.first_row_px.saturating_add(count)
    }

    /// Returns a row of the image; empty if it is not in memory.
    #[inline(always)]
    pub(super) fn row(&self, row_px: i64) -> &'a [S] {
        let index = row_px - i64::from(self.first_row_px);
        let index = usize::try_from(index).unwrap_or(usize::MAX);
        self.rows.get(index).copied().unwrap_or_default()
    }

    /// Returns consecutive rows of the image; `None` unless all are in memory.
    #[inline(always)]
    pub(super) fn rows<const N: usize>(&self, first_px: i32) -> Option<&'a [&'a [S]; N]> {
        let index = i64::from(first_px) - i64::from(self.first_row_px);
        let index = usize::try_from(index).ok()?;
        self.rows.get(index..)?.first_chunk()
    }
}
