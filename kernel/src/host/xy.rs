//! Points whose x and y lie in slices of their own, all of one length.

use super::form::Form;
use super::head;
use super::vectors::{Vectors, Work};
use crate::Coefficients;

/// Every point replaced by its ideal one.
pub(super) struct InPlace<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) x: &'a mut [f32],
    pub(super) y: &'a mut [f32],
}

impl<const FULL: bool> Work for InPlace<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let (x, x_rest) = V::as_mut_simd_f32s(self.x);
        let (y, y_rest) = V::as_mut_simd_f32s(self.y);
        for (x, y) in x.iter_mut().zip(y) {
            let ideal = form.ideal(*x, *y);
            *x = ideal.x;
            *y = ideal.y;
        }
        if !x_rest.is_empty() {
            let ideal = form.ideal(
                vectors.partial_load_f32s(x_rest),
                vectors.partial_load_f32s(y_rest),
            );
            vectors.partial_store_f32s(x_rest, ideal.x);
            vectors.partial_store_f32s(y_rest, ideal.y);
        }
    }
}

/// Ideal points into other slices.
pub(super) struct Into<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) x: &'a [f32],
    pub(super) y: &'a [f32],
    pub(super) ideal_x: &'a mut [f32],
    pub(super) ideal_y: &'a mut [f32],
    /// Past the caches, where alignment allows it.
    pub(super) stream: bool,
}

impl<const FULL: bool> Work for Into<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let alike = head::<V>(self.ideal_x);
        if !self.stream || alike != head::<V>(self.ideal_y) || alike > self.x.len() {
            return self.stored(vectors, &form);
        }
        let (x_head, x) = self.x.split_at(alike);
        let (y_head, y) = self.y.split_at(alike);
        let (ideal_x_head, ideal_x) = self.ideal_x.split_at_mut(alike);
        let (ideal_y_head, ideal_y) = self.ideal_y.split_at_mut(alike);
        few(vectors, &form, x_head, y_head, ideal_x_head, ideal_y_head);
        let (x, x_rest) = V::as_simd_f32s(x);
        let (y, y_rest) = V::as_simd_f32s(y);
        let (ideal_x, ideal_x_rest) = V::as_mut_simd_f32s(ideal_x);
        let (ideal_y, ideal_y_rest) = V::as_mut_simd_f32s(ideal_y);
        for (((x, y), ideal_x), ideal_y) in x.iter().zip(y).zip(ideal_x).zip(ideal_y) {
            let ideal = form.ideal(*x, *y);
            // SAFETY: behind their heads both slices are aligned, and every place is whole vectors further on; the
            // fence follows the loop.
            unsafe {
                vectors.stream(ideal_x, ideal.x);
                vectors.stream(ideal_y, ideal.y);
            }
        }
        vectors.streamed();
        few(vectors, &form, x_rest, y_rest, ideal_x_rest, ideal_y_rest);
    }
}

impl<const FULL: bool> Into<'_, FULL> {
    #[inline(always)]
    fn stored<V: Vectors>(self, vectors: V, form: &Form<V, FULL>) {
        let (x, x_rest) = V::as_simd_f32s(self.x);
        let (y, y_rest) = V::as_simd_f32s(self.y);
        let (ideal_x, ideal_x_rest) = V::as_mut_simd_f32s(self.ideal_x);
        let (ideal_y, ideal_y_rest) = V::as_mut_simd_f32s(self.ideal_y);
        for (((x, y), ideal_x), ideal_y) in x.iter().zip(y).zip(ideal_x).zip(ideal_y) {
            let ideal = form.ideal(*x, *y);
            *ideal_x = ideal.x;
            *ideal_y = ideal.y;
        }
        few(vectors, form, x_rest, y_rest, ideal_x_rest, ideal_y_rest);
    }
}

/// Fewer points than a vector has lanes.
#[inline(always)]
fn few<V: Vectors, const FULL: bool>(
    vectors: V,
    form: &Form<V, FULL>,
    x: &[f32],
    y: &[f32],
    ideal_x: &mut [f32],
    ideal_y: &mut [f32],
) {
    if x.is_empty() {
        return;
    }
    let ideal = form.ideal(vectors.partial_load_f32s(x), vectors.partial_load_f32s(y));
    vectors.partial_store_f32s(ideal_x, ideal.x);
    vectors.partial_store_f32s(ideal_y, ideal.y);
}

/// Ideal points and the distortion that was subtracted, each into a slice of its own.
pub(super) struct WithDistortion<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) x: &'a [f32],
    pub(super) y: &'a [f32],
    pub(super) ideal_x: &'a mut [f32],
    pub(super) ideal_y: &'a mut [f32],
    pub(super) dx: &'a mut [f32],
    pub(super) dy: &'a mut [f32],
}

impl<const FULL: bool> Work for WithDistortion<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let (x, x_rest) = V::as_simd_f32s(self.x);
        let (y, y_rest) = V::as_simd_f32s(self.y);
        let (ideal_x, ideal_x_rest) = V::as_mut_simd_f32s(self.ideal_x);
        let (ideal_y, ideal_y_rest) = V::as_mut_simd_f32s(self.ideal_y);
        let (dx, dx_rest) = V::as_mut_simd_f32s(self.dx);
        let (dy, dy_rest) = V::as_mut_simd_f32s(self.dy);
        let places = ideal_x.iter_mut().zip(ideal_y).zip(dx).zip(dy);
        for ((x, y), (((ideal_x, ideal_y), dx), dy)) in x.iter().zip(y).zip(places) {
            let ideal = form.ideal(*x, *y);
            *ideal_x = ideal.x;
            *ideal_y = ideal.y;
            *dx = ideal.dx;
            *dy = ideal.dy;
        }
        if !x_rest.is_empty() {
            let ideal = form.ideal(
                vectors.partial_load_f32s(x_rest),
                vectors.partial_load_f32s(y_rest),
            );
            vectors.partial_store_f32s(ideal_x_rest, ideal.x);
            vectors.partial_store_f32s(ideal_y_rest, ideal.y);
            vectors.partial_store_f32s(dx_rest, ideal.dx);
            vectors.partial_store_f32s(dy_rest, ideal.dy);
        }
    }
}
