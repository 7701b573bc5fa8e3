//! Places of consecutive output pixels in the source image.

/// Bits of the fraction of a pixel in a place.
pub const PLACE_BITS: u32 = 24;

/// Largest number of pixels of a run.
pub const RUN_PX: u32 = 16;

/// Places of up to [`RUN_PX`] consecutive output pixels: that of pixel t lies at
/// `base + (start + t·step)/2²⁴` px, column and row, 0 being the centre of the first pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Run {
    /// Whole pixels from which the places are counted.
    pub base_px: [i32; 2],
    /// Place of the first pixel from the base, 1/2²⁴ px: at least 0 and less than 2²⁴.
    pub start: [i32; 2],
    /// Way from one place to the next, 1/2²⁴ px: at most four pixels.
    pub step: [i32; 2],
    /// Pixels of the run, at most [`RUN_PX`].
    pub count: u8,
    /// `true` for a run of border pixels, of which only the count matters.
    pub border: bool,
}

impl Run {
    /// Returns the place of a pixel, px.
    #[must_use]
    pub fn place_px(&self, pixel: u8) -> [f64; 2] {
        let unit = f64::from(1 << PLACE_BITS);
        let axis = |base: i32, start: i32, step: i32| {
            let way = f64::from(start) + f64::from(step) * f64::from(pixel);
            f64::from(base) + way / unit
        };
        let ([base_col, base_row], [col, row]) = (self.base_px, self.start);
        let [col_step, row_step] = self.step;
        [axis(base_col, col, col_step), axis(base_row, row, row_step)]
    }

    /// Returns the place of a pixel, 1/2²⁴ px from the first pixel of the image.
    #[inline(always)]
    pub(super) fn place(&self, pixel: u32) -> [i64; 2] {
        let [base_col, base_row] = self.base_px.map(|base| i64::from(base) << PLACE_BITS);
        let [col, row] = self.start.map(i64::from);
        let [step_col, step_row] = self.step.map(|step| i64::from(step) * i64::from(pixel));
        [base_col + col + step_col, base_row + row + step_row]
    }
}
