//! Kernels for points as pairs (x, y) in one slice.
//!
//! Two vectors hold the points that one vector of x and one of y hold in [`super::xy`]; the ends
//! overlap as they do there.

use core::ptr;

use super::form::Form;
use super::head;
use super::vectors::{Vectors, Work};
use crate::Coefficients;

/// Replacement of every point by its ideal one.
pub(super) struct InPlace<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) points: &'a mut [[f32; 2]],
}

impl<const FULL: bool> Work for InPlace<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let points = self.points.as_flattened_mut();
        let Some([at_first, at_last]) = ends(&form, points) else {
            let ideal = form.ideal_pairs(few(vectors, points));
            return put_few(vectors, points, ideal);
        };
        let all = twos_mut::<V>(points.split_at_mut(before::<V>(points)).1);
        // Two streams, as in `Into`.
        let half = all.len() / 2;
        let (first, second) = all.split_at_mut(half);
        for (a, b) in first.iter_mut().zip(second.iter_mut()) {
            replace(vectors, &form, a);
            replace(vectors, &form, b);
        }
        for point in second.iter_mut().skip(half) {
            replace(vectors, &form, point);
        }
        put_ends::<V>(points, [at_first, at_last]);
    }
}

#[inline(always)]
pub(super) fn replace<V: Vectors, const FULL: bool>(
    vectors: V,
    form: &Form<V, FULL>,
    points: &mut [V::f32s; 2],
) {
    ask_ahead(vectors, points);
    *points = form.ideal_pairs(*points);
}

/// Ideal points written into another slice of the same length.
pub(super) struct Into<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) points: &'a [[f32; 2]],
    pub(super) ideal: &'a mut [[f32; 2]],
    /// `true` to write past the caches where alignment allows it.
    pub(super) stream: bool,
}

impl<const FULL: bool> Work for Into<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let points = self.points.as_flattened();
        let ideal = self.ideal.as_flattened_mut();
        let Some([at_first, at_last]) = ends(&form, points) else {
            let few = form.ideal_pairs(few(vectors, points));
            return put_few(vectors, ideal, few);
        };
        let before = before::<V>(ideal);
        let aligned = before == head(ideal, 2 * V::ALIGNMENT);
        let from = twos::<V>(points.split_at(before).1);
        let to = twos_mut::<V>(ideal.split_at_mut(before).1);
        if self.stream && aligned {
            // Two streams: the processor prefetches in each of them, and one alone does not keep
            // the memory busy.
            let half = from.len() / 2;
            let (first, second) = from.split_at(half);
            let (to_first, to_second) = to.split_at_mut(half);
            let both = first.iter().zip(to_first.iter_mut());
            for ((a, to_a), (b, to_b)) in both.zip(second.iter().zip(to_second.iter_mut())) {
                // SAFETY: after `before` numbers the slice is aligned, and every place is whole
                // vectors further on; the fence follows the loops.
                unsafe {
                    pass(vectors, &form, a, to_a);
                    pass(vectors, &form, b, to_b);
                }
            }
            // One element is left of an odd count.
            for (point, to) in second.iter().zip(to_second.iter_mut()).skip(half) {
                // SAFETY: as above.
                unsafe { pass(vectors, &form, point, to) }
            }
            vectors.streamed();
        } else {
            for (point, ideal) in from.iter().zip(to) {
                *ideal = form.ideal_pairs(*point);
            }
        }
        put_ends::<V>(ideal, [at_first, at_last]);
    }
}

/// Writes ideal points past the caches.
///
/// # Safety
/// As for [`Vectors::stream`].
#[inline(always)]
pub(super) unsafe fn pass<V: Vectors, const FULL: bool>(
    vectors: V,
    form: &Form<V, FULL>,
    points: &[V::f32s; 2],
    [at_low, at_high]: &mut [V::f32s; 2],
) {
    ask_ahead(vectors, points);
    let [low, high] = form.ideal_pairs(*points);
    // SAFETY: the caller fulfils the conditions.
    unsafe {
        vectors.stream(at_low, low);
        vectors.stream(at_high, high);
    }
}

#[inline(always)]
fn ask_ahead<V: Vectors>(vectors: V, points: &[V::f32s; 2]) {
    let at: *const f32 = ptr::from_ref(points).cast();
    vectors.ask_ahead(at);
    vectors.ask_ahead(at.wrapping_add(V::F32_LANES));
}

/// Counts the numbers, of whole points, before the first two vectors that are aligned as one.
///
/// From there on every two vectors fill whole lines of the cache: a streamed half of a line waits
/// for the other half, and is written without it if several streams wait. A slice aligned to half a
/// point has no such place.
#[inline(always)]
pub(super) fn before<V: Vectors>(numbers: &[f32]) -> usize {
    let before = head(numbers, 2 * V::ALIGNMENT);
    if before.is_multiple_of(2) { before } else { 0 }
}

/// Returns the numbers as elements of two vectors each.
#[inline(always)]
pub(super) fn twos<V: Vectors>(numbers: &[f32]) -> &[[V::f32s; 2]] {
    V::as_simd_f32s(numbers).0.as_chunks().0
}

/// Returns the elements of [`twos`] as mutable.
#[inline(always)]
pub(super) fn twos_mut<V: Vectors>(numbers: &mut [f32]) -> &mut [[V::f32s; 2]] {
    V::as_mut_simd_f32s(numbers).0.as_chunks_mut().0
}

/// Evaluates the first and the last points of two vectors; `None` if there are fewer points.
#[inline(always)]
fn ends<V: Vectors, const FULL: bool>(
    form: &Form<V, FULL>,
    points: &[f32],
) -> Option<[[V::f32s; 2]; 2]> {
    let at_first = twos::<V>(points).first()?;
    let at_last = V::as_rsimd_f32s(points).1.last_chunk()?;
    Some([form.ideal_pairs(*at_first), form.ideal_pairs(*at_last)])
}

/// Writes the first and the last points of two vectors.
#[inline(always)]
fn put_ends<V: Vectors>(points: &mut [f32], [at_first, at_last]: [[V::f32s; 2]; 2]) {
    if let Some(first) = twos_mut::<V>(points).first_mut() {
        *first = at_first;
    }
    if let Some(last) = V::as_mut_rsimd_f32s(points).1.last_chunk_mut() {
        *last = at_last;
    }
}

/// Loads fewer points than two vectors hold.
#[inline(always)]
pub(super) fn few<V: Vectors>(vectors: V, points: &[f32]) -> [V::f32s; 2] {
    let (low, high) = points.split_at(points.len().min(V::F32_LANES));
    [
        vectors.partial_load_f32s(low),
        vectors.partial_load_f32s(high),
    ]
}

/// Writes fewer points than two vectors hold.
#[inline(always)]
pub(super) fn put_few<V: Vectors>(vectors: V, points: &mut [f32], [at_low, at_high]: [V::f32s; 2]) {
    let (low, high) = points.split_at_mut(points.len().min(V::F32_LANES));
    vectors.partial_store_f32s(low, at_low);
    vectors.partial_store_f32s(high, at_high);
}
