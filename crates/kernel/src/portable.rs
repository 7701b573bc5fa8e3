//! Kernel in plain Rust, with which all others are compared.
//!
//! Its loops treat independent points, so that a compiler can put them into vectors.

use crate::{Coefficients, Terms};

/// Points that fill a vector. For a multiple of this number the compiler needs no mask.
const VECTOR: usize = 4;

/// Performs [`crate::short_pairs`].
pub fn short_pairs(coefficients: &Coefficients, points: &mut [[f32; 2]]) {
    for point in points {
        *point = short(coefficients, *point);
    }
}

/// Performs [`crate::full_pairs`].
pub fn full_pairs(coefficients: &Coefficients, points: &mut [[f32; 2]]) {
    for point in points {
        *point = full(coefficients, *point);
    }
}

/// Performs one of both on the few points behind the blocks of a kernel.
#[cfg(hand_scheduled)]
#[inline(never)]
pub(crate) fn rest(coefficients: &Coefficients, terms: Terms, points: &mut [[f32; 2]]) {
    for point in points {
        *point = ideal(coefficients, terms, *point);
    }
}

/// Performs [`crate::short_xy`].
pub fn short_xy(coefficients: &Coefficients, x_mm: &mut [f32], y_mm: &mut [f32]) {
    xy::<false>(coefficients, x_mm, y_mm);
}

/// Performs [`crate::full_xy`].
pub fn full_xy(coefficients: &Coefficients, x_mm: &mut [f32], y_mm: &mut [f32]) {
    xy::<true>(coefficients, x_mm, y_mm);
}

/// Corrects separate x and y: whole vectors first, then the rest.
#[inline]
fn xy<const FULL: bool>(form: &Coefficients, x: &mut [f32], y: &mut [f32]) {
    let ideal = |point| {
        if FULL {
            full(form, point)
        } else {
            short(form, point)
        }
    };
    let points = x.len().min(y.len());
    let x = x.get_mut(..points).unwrap_or_default();
    let y = y.get_mut(..points).unwrap_or_default();
    let (x_vectors, x_rest) = x.as_chunks_mut::<VECTOR>();
    let (y_vectors, y_rest) = y.as_chunks_mut::<VECTOR>();
    let (x_vectors, y_vectors) = (x_vectors.as_flattened_mut(), y_vectors.as_flattened_mut());
    for (x, y) in x_vectors.iter_mut().zip(y_vectors) {
        [*x, *y] = ideal([*x, *y]);
    }
    for (x, y) in x_rest.iter_mut().zip(y_rest) {
        [*x, *y] = ideal([*x, *y]);
    }
}

/// Returns the ideal point of a measured one, without b₁, b₂, tx and ty.
#[inline]
#[must_use]
pub fn short(coefficients: &Coefficients, point: [f32; 2]) -> [f32; 2] {
    ideal(coefficients, Terms::Short, point)
}

/// Returns the ideal point of a measured one, with all terms.
#[inline]
#[must_use]
pub fn full(coefficients: &Coefficients, point: [f32; 2]) -> [f32; 2] {
    ideal(coefficients, Terms::Full, point)
}

/// Returns the ideal point of a measured one: computes the distortion and subtracts it once, so
/// that a coordinate is rounded once.
///
/// # Model
/// That of [`Coefficients`], with sums from left to right.
#[inline]
fn ideal(form: &Coefficients, terms: Terms, [x, y]: [f32; 2]) -> [f32; 2] {
    let from_centre_x = x - form.cx;
    let from_centre_y = y - form.cy;
    let r2 = from_centre_x * from_centre_x + from_centre_y * from_centre_y;
    let radial = form.k0 + r2 * (form.k1 + r2 * (form.k2 + r2 * form.k3));
    let gain = radial + form.hx * from_centre_x + form.hy * from_centre_y;
    let mut dx = from_centre_x * gain + form.gx * r2;
    let mut dy = from_centre_y * gain + form.gy * r2;
    if terms == Terms::Full {
        dx = dx + form.b1 * from_centre_x + form.b2 * from_centre_y + form.tx;
        dy += form.ty;
    }
    [x - dx, y - dy]
}
