//! The kernel in plain Rust: what every other one is held against.
//!
//! Loops of independent points, so that a compiler with vectors to fill can fill them, and inlined, so that the vectors are
//! those of the program that calls.

use crate::Coefficients;

/// [`crate::short_pairs`].
#[inline]
pub fn short_pairs(coefficients: &Coefficients, points: &mut [[f32; 2]]) {
    for point in points {
        *point = ideal::<false>(coefficients, *point);
    }
}

/// [`crate::full_pairs`].
#[inline]
pub fn full_pairs(coefficients: &Coefficients, points: &mut [[f32; 2]]) {
    for point in points {
        *point = ideal::<true>(coefficients, *point);
    }
}

/// [`crate::short_xy`].
#[inline]
pub fn short_xy(coefficients: &Coefficients, x_mm: &mut [f32], y_mm: &mut [f32]) {
    for (x, y) in x_mm.iter_mut().zip(y_mm) {
        [*x, *y] = ideal::<false>(coefficients, [*x, *y]);
    }
}

/// [`crate::full_xy`].
#[inline]
pub fn full_xy(coefficients: &Coefficients, x_mm: &mut [f32], y_mm: &mut [f32]) {
    for (x, y) in x_mm.iter_mut().zip(y_mm) {
        [*x, *y] = ideal::<true>(coefficients, [*x, *y]);
    }
}

/// The ideal point of a measured one: the distortion first, then one subtraction, so that a coordinate is rounded once.
///
/// # Model
/// That of [`Coefficients`], its sums from left to right.
#[inline]
fn ideal<const FULL: bool>(form: &Coefficients, [x, y]: [f32; 2]) -> [f32; 2] {
    let from_centre_x = x - form.cx;
    let from_centre_y = y - form.cy;
    let r2 = from_centre_x * from_centre_x + from_centre_y * from_centre_y;
    let radial = form.k0 + r2 * (form.k1 + r2 * (form.k2 + r2 * form.k3));
    let gain = radial + form.hx * from_centre_x + form.hy * from_centre_y;
    let mut dx = from_centre_x * gain + form.gx * r2;
    let mut dy = from_centre_y * gain + form.gy * r2;
    if FULL {
        dx = dx + form.b1 * from_centre_x + form.b2 * from_centre_y + form.tx;
        dy += form.ty;
    }
    [x - dx, y - dy]
}
