//! Rows of pixels, run by run.

#![expect(clippy::cast_possible_wrap, reason = "numbers of taps")]

use super::band::Band;
use super::pixel::{Axis, Places, blend, split, taps_before};
use super::run::{PLACE_BITS, RUN_PX, Run};
use super::sample::Sample;
use super::weights::Weights;

/// A row to resample.
pub(super) struct Row<'a, S> {
    pub(super) weights: Option<&'a Weights>,
    pub(super) source: &'a Band<'a, S>,
    pub(super) runs: &'a [Run],
    pub(super) out: &'a mut [S],
    pub(super) mask: &'a mut [u8],
}

/// Vectors for runs all of whose taps lie in the image.
pub(super) trait Vectors<S: Sample, const C: usize, const N: usize> {
    /// Writes the pixels of a run; returns false where they have to be computed one by one.
    fn run(
        self,
        source: &Band<'_, S>,
        weights: Option<&Weights>,
        run: &Run,
        out: &mut [[S; C]],
    ) -> bool;
}

/// No vectors but those that a compiler finds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plain;

impl<S: Sample, const C: usize, const N: usize> Vectors<S, C, N> for Plain {
    #[inline(always)]
    fn run(self, _: &Band<'_, S>, _: Option<&Weights>, _: &Run, _: &mut [[S; C]]) -> bool {
        false
    }
}

impl<S: Sample> Row<'_, S> {
    /// Resamples the row with N taps and C bands, and returns the number of border pixels.
    #[inline(always)]
    pub(super) fn resample<const C: usize, const N: usize>(
        self,
        vectors: impl Vectors<S, C, N> + Copy,
    ) -> u32 {
        let Self {
            weights,
            source,
            runs,
            out,
            mask,
        } = self;
        let mut pixels = out.as_chunks_mut::<C>().0;
        mask.fill(1);
        let mut mask = mask;
        let mut border = 0;
        for run in runs {
            let count = usize::from(run.count).min(RUN_PX as usize);
            let count = count.min(pixels.len()).min(mask.len());
            let (now, behind) = pixels.split_at_mut(count);
            let (mask_now, mask_behind) = mask.split_at_mut(count);
            (pixels, mask) = (behind, mask_behind);
            if run.border {
                border += clear(now, mask_now);
            } else if is_inside::<S, N>(source, run, count) {
                if !vectors.run(source, weights, run, now) {
                    inner_pixels::<S, C, N>(source, weights, run, now);
                }
            } else {
                border += outer_pixels::<S, C, N>(source, weights, run, now, mask_now);
            }
        }
        border + clear(pixels, mask)
    }
}

/// Makes pixels border and returns their number.
#[inline(always)]
fn clear<S: Sample, const C: usize>(pixels: &mut [[S; C]], mask: &mut [u8]) -> u32 {
    pixels.fill([S::default(); C]);
    mask.fill(0);
    u32::try_from(pixels.len()).unwrap_or(u32::MAX)
}

/// Returns true if all taps of all pixels of a run lie in the image.
#[inline(always)]
fn is_inside<S, const N: usize>(source: &Band<'_, S>, run: &Run, count: usize) -> bool {
    let last = i32::try_from(count).unwrap_or_default() - 1;
    let places = Places::new::<N>(run);
    let (before, after) = (taps_before(N) as i64, (N / 2) as i64);
    let inside = |base: i32, axis: &Axis, side: u32| {
        let (a, b) = (axis.at(0) >> PLACE_BITS, axis.at(last) >> PLACE_BITS);
        let (low, high) = (
            i64::from(base) + i64::from(a.min(b)),
            i64::from(base) + i64::from(a.max(b)),
        );
        (low >= before) & (high + after < i64::from(side))
    };
    let ([width, height], [col, row]) = (source.size_px(), run.base_px);
    inside(col, &places.col, width) & inside(row, &places.row, height)
}

/// Resamples the pixels of a run all of whose taps lie in the image.
#[inline(always)]
fn inner_pixels<S: Sample, const C: usize, const N: usize>(
    source: &Band<'_, S>,
    weights: Option<&Weights>,
    run: &Run,
    pixels: &mut [[S; C]],
) {
    for (number, pixel) in (0..).zip(pixels) {
        let [col, row] = run.place(number);
        let ((col, along), (row, down)) = (split::<N>(col), split::<N>(row));
        let before = taps_before(N) as i64;
        let col = usize::try_from(col - before).unwrap_or(usize::MAX);
        let none = [[S::default(); C]; N];
        let mut taps = [&none; N];
        for (row, taps) in (row - before..).zip(&mut taps) {
            let all = source.row(row).as_chunks::<C>().0;
            if let Some(found) = all.get(col..).and_then(<[[S; C]]>::first_chunk) {
                *taps = found;
            }
        }
        *pixel = blend(taps, [along, down], weights);
    }
}

/// Resamples pixels some of whose taps lie off the image, and returns how many of them are border.
#[inline(never)]
fn outer_pixels<S: Sample, const C: usize, const N: usize>(
    source: &Band<'_, S>,
    weights: Option<&Weights>,
    run: &Run,
    pixels: &mut [[S; C]],
    mask: &mut [u8],
) -> u32 {
    let [width, height] = source.size_px().map(i64::from);
    let mut border = 0;
    for (number, (pixel, mask)) in (0..).zip(pixels.iter_mut().zip(mask)) {
        let place = run.place(number);
        let half = 1 << (PLACE_BITS - 1);
        let is_on = |place: i64, side: i64| (-half..=(side << PLACE_BITS) - half).contains(&place);
        if !(is_on(place[0], width) && is_on(place[1], height)) {
            *pixel = [S::default(); C];
            *mask = 0;
            border += 1;
            continue;
        }
        let nearest = |place: i64, side: i64| place.clamp(0, (side - 1) << PLACE_BITS);
        let (col, along) = split::<N>(nearest(place[0], width));
        let (row, down) = split::<N>(nearest(place[1], height));
        let before = taps_before(N) as i64;
        let mut taps = [[[S::default(); C]; N]; N];
        for (row, taps) in (row - before..).zip(&mut taps) {
            let all = source.row(row.clamp(0, height - 1)).as_chunks::<C>().0;
            for (col, tap) in (col - before..).zip(taps) {
                let col = usize::try_from(col.clamp(0, width - 1)).unwrap_or_default();
                *tap = all.get(col).copied().unwrap_or([S::default(); C]);
            }
        }
        *pixel = blend(taps.each_ref(), [along, down], weights);
    }
    border
}
