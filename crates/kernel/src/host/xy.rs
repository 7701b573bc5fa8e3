//! Kernels for points whose x and y lie in separate slices of one length.
//!
//! The first and the last vector of a slice are evaluated in addition to the aligned ones in
//! between, with which they overlap: the same points give the same bits twice, and no vector has to
//! be filled in part.

use core::ptr;

use super::form::{Form, Ideal};
use super::vectors::{Vectors, Work};
use super::{head, last, last_mut};
use crate::Coefficients;

/// Replacement of every point by its ideal one.
pub(super) struct InPlace<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) x: &'a mut [f32],
    pub(super) y: &'a mut [f32],
}

impl<const FULL: bool> Work for InPlace<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let (x, y) = (self.x, self.y);
        let Some([at_first, at_last]) = ends(&form, x, y) else {
            let ideal = form.ideal(vectors.partial_load_f32s(x), vectors.partial_load_f32s(y));
            vectors.partial_store_f32s(x, ideal.x);
            vectors.partial_store_f32s(y, ideal.y);
            return;
        };
        let before = head(x, V::ALIGNMENT);
        let x_places = V::as_mut_simd_f32s(x.split_at_mut(before).1).0;
        let y_places = V::as_mut_simd_f32s(y.split_at_mut(before).1).0;
        for (x, y) in x_places.iter_mut().zip(y_places) {
            vectors.ask_ahead(ptr::from_ref(x).cast());
            vectors.ask_ahead(ptr::from_ref(y).cast());
            let ideal = form.ideal(*x, *y);
            *x = ideal.x;
            *y = ideal.y;
        }
        put_ends::<V>(x, [at_first.x, at_last.x]);
        put_ends::<V>(y, [at_first.y, at_last.y]);
    }
}

/// Ideal points written into other slices.
pub(super) struct Into<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) x: &'a [f32],
    pub(super) y: &'a [f32],
    pub(super) ideal_x: &'a mut [f32],
    pub(super) ideal_y: &'a mut [f32],
    /// `true` to write past the caches where alignment allows it.
    pub(super) stream: bool,
}

impl<const FULL: bool> Work for Into<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let (ideal_x, ideal_y) = (self.ideal_x, self.ideal_y);
        let Some([at_first, at_last]) = ends(&form, self.x, self.y) else {
            let x = vectors.partial_load_f32s(self.x);
            let y = vectors.partial_load_f32s(self.y);
            let ideal = form.ideal(x, y);
            vectors.partial_store_f32s(ideal_x, ideal.x);
            vectors.partial_store_f32s(ideal_y, ideal.y);
            return;
        };
        let before = head(ideal_x, V::ALIGNMENT);
        let alike = before == head(ideal_y, V::ALIGNMENT);
        let from = V::as_simd_f32s(self.x.split_at(before).1).0.iter();
        let from = from.zip(V::as_simd_f32s(self.y.split_at(before).1).0);
        let to = V::as_mut_simd_f32s(ideal_x.split_at_mut(before).1).0;
        let to = to
            .iter_mut()
            .zip(V::as_mut_simd_f32s(ideal_y.split_at_mut(before).1).0);
        if self.stream && alike {
            for ((x, y), (ideal_x, ideal_y)) in from.zip(to) {
                vectors.ask_ahead(ptr::from_ref(x).cast());
                vectors.ask_ahead(ptr::from_ref(y).cast());
                let ideal = form.ideal(*x, *y);
                // SAFETY: after `before` numbers both slices are aligned, and every place is whole
                // vectors further on; the fence follows the loop.
                unsafe {
                    vectors.stream(ideal_x, ideal.x);
                    vectors.stream(ideal_y, ideal.y);
                }
            }
            vectors.streamed();
        } else {
            for ((x, y), (ideal_x, ideal_y)) in from.zip(to) {
                let ideal = form.ideal(*x, *y);
                *ideal_x = ideal.x;
                *ideal_y = ideal.y;
            }
        }
        put_ends::<V>(ideal_x, [at_first.x, at_last.x]);
        put_ends::<V>(ideal_y, [at_first.y, at_last.y]);
    }
}

/// Ideal points and the distortion that was subtracted, each written into a separate slice.
pub(super) struct WithDistortion<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) x: &'a [f32],
    pub(super) y: &'a [f32],
    pub(super) ideal: [&'a mut [f32]; 2],
    pub(super) distortion: [&'a mut [f32]; 2],
}

impl<const FULL: bool> Work for WithDistortion<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let [ideal_x, ideal_y] = self.ideal;
        let [dx, dy] = self.distortion;
        let Some([_, at_last]) = ends(&form, self.x, self.y) else {
            let x = vectors.partial_load_f32s(self.x);
            let y = vectors.partial_load_f32s(self.y);
            let ideal = form.ideal(x, y);
            vectors.partial_store_f32s(ideal_x, ideal.x);
            vectors.partial_store_f32s(ideal_y, ideal.y);
            vectors.partial_store_f32s(dx, ideal.dx);
            vectors.partial_store_f32s(dy, ideal.dy);
            return;
        };
        let from = V::as_simd_f32s(self.x).0.iter();
        let from = from.zip(V::as_simd_f32s(self.y).0);
        let to = V::as_mut_simd_f32s(ideal_x).0.iter_mut();
        let to = to.zip(V::as_mut_simd_f32s(ideal_y).0);
        let to = to.zip(V::as_mut_simd_f32s(dx).0);
        let to = to.zip(V::as_mut_simd_f32s(dy).0);
        for ((x, y), (((ideal_x, ideal_y), dx), dy)) in from.zip(to) {
            let ideal = form.ideal(*x, *y);
            *ideal_x = ideal.x;
            *ideal_y = ideal.y;
            *dx = ideal.dx;
            *dy = ideal.dy;
        }
        put(last_mut::<V>(ideal_x), at_last.x);
        put(last_mut::<V>(ideal_y), at_last.y);
        put(last_mut::<V>(dx), at_last.dx);
        put(last_mut::<V>(dy), at_last.dy);
    }
}

/// Evaluates the first and the last vector of points; `None` if there are fewer points than a
/// vector has lanes.
#[inline(always)]
fn ends<V: Vectors, const FULL: bool>(
    form: &Form<V, FULL>,
    x: &[f32],
    y: &[f32],
) -> Option<[Ideal<V>; 2]> {
    let first = form.ideal(
        *V::as_simd_f32s(x).0.first()?,
        *V::as_simd_f32s(y).0.first()?,
    );
    Some([first, form.ideal(*last::<V>(x)?, *last::<V>(y)?)])
}

/// Writes the first and the last vector of a slice.
#[inline(always)]
fn put_ends<V: Vectors>(slice: &mut [f32], [at_first, at_last]: [V::f32s; 2]) {
    put(V::as_mut_simd_f32s(slice).0.first_mut(), at_first);
    put(last_mut::<V>(slice), at_last);
}

#[inline(always)]
fn put<T>(place: Option<&mut T>, value: T) {
    if let Some(place) = place {
        *place = value;
    }
}
