//! Points as pairs (x, y) in one slice.

use super::form::Form;
use super::head;
use super::vectors::{Vectors, Work};
use crate::Coefficients;

/// Every point replaced by its ideal one.
pub(super) struct InPlace<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) points: &'a mut [[f32; 2]],
}

impl<const FULL: bool> Work for InPlace<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let points = self.points.as_flattened_mut();
        let (points, rest) = points.split_at_mut(whole::<V>(points.len()));
        let (points, _) = V::as_mut_simd_f32s(points);
        for point in points.as_chunks_mut().0 {
            *point = form.ideal_pairs(*point);
        }
        if !rest.is_empty() {
            let (low, high) = rest.split_at_mut(rest.len().min(V::F32_LANES));
            let [ideal_low, ideal_high] = form.ideal_pairs([
                vectors.partial_load_f32s(low),
                vectors.partial_load_f32s(high),
            ]);
            vectors.partial_store_f32s(low, ideal_low);
            vectors.partial_store_f32s(high, ideal_high);
        }
    }
}

/// Ideal points into another slice of the same length.
pub(super) struct Into<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) points: &'a [[f32; 2]],
    pub(super) ideal: &'a mut [[f32; 2]],
    /// Past the caches, where alignment allows it.
    pub(super) stream: bool,
}

impl<const FULL: bool> Work for Into<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let points = self.points.as_flattened();
        let ideal = self.ideal.as_flattened_mut();
        let before = head::<V>(ideal);
        // A head of half points, as of a slice aligned to f32 alone, leads to no alignment.
        let stream = self.stream && before.is_multiple_of(2) && before <= points.len();
        let (points_head, points) = points.split_at(if stream { before } else { 0 });
        let (ideal_head, ideal) = ideal.split_at_mut(if stream { before } else { 0 });
        few(vectors, &form, points_head, ideal_head);
        let (points, points_rest) = points.split_at(whole::<V>(points.len()));
        let (ideal, ideal_rest) = ideal.split_at_mut(whole::<V>(ideal.len()));
        let (points, _) = V::as_simd_f32s(points);
        let (ideal, _) = V::as_mut_simd_f32s(ideal);
        let both = points
            .as_chunks()
            .0
            .iter()
            .zip(ideal.as_chunks_mut::<2>().0);
        if stream {
            for (point, [ideal_low, ideal_high]) in both {
                let [low, high] = form.ideal_pairs(*point);
                // SAFETY: behind its head the slice is aligned, and every place is whole vectors further on; the
                // fence follows the loop.
                unsafe {
                    vectors.stream(ideal_low, low);
                    vectors.stream(ideal_high, high);
                }
            }
            vectors.streamed();
        } else {
            for (point, ideal) in both {
                *ideal = form.ideal_pairs(*point);
            }
        }
        few(vectors, &form, points_rest, ideal_rest);
    }
}

/// Fewer points than two vectors hold.
#[inline(always)]
fn few<V: Vectors, const FULL: bool>(
    vectors: V,
    form: &Form<V, FULL>,
    points: &[f32],
    ideal: &mut [f32],
) {
    if points.is_empty() {
        return;
    }
    let (low, high) = points.split_at(points.len().min(V::F32_LANES));
    let [ideal_low, ideal_high] = form.ideal_pairs([
        vectors.partial_load_f32s(low),
        vectors.partial_load_f32s(high),
    ]);
    let (low, high) = ideal.split_at_mut(low.len());
    vectors.partial_store_f32s(low, ideal_low);
    vectors.partial_store_f32s(high, ideal_high);
}

/// How many of so many numbers fill pairs of vectors.
#[inline(always)]
const fn whole<V: Vectors>(numbers: usize) -> usize {
    numbers - numbers % (2 * V::F32_LANES)
}
