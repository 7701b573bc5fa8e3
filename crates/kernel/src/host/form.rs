//! Evaluation of the correction over vectors.

use super::vectors::Vectors;
use crate::Coefficients;

/// Coefficients of one frame, each in every lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Form<V: Vectors, const FULL: bool> {
    vectors: V,
    numbers: Coefficients<V::f32s>,
}

/// Ideal points and distortion, one vector of each component.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ideal<V: Vectors> {
    pub(super) x: V::f32s,
    pub(super) y: V::f32s,
    pub(super) dx: V::f32s,
    pub(super) dy: V::f32s,
}

impl<V: Vectors, const FULL: bool> Form<V, FULL> {
    #[inline(always)]
    pub(super) fn new(vectors: V, form: &Coefficients) -> Self {
        Self {
            vectors,
            numbers: form.map(|number| vectors.splat_f32s(number)),
        }
    }

    /// Performs the operations of [`crate::portable`], one by one and in the same order; none of
    /// them is fused.
    #[inline(always)]
    pub(super) fn ideal(&self, x: V::f32s, y: V::f32s) -> Ideal<V> {
        let plus = |a, b| self.vectors.add_f32s(a, b);
        let minus = |a, b| self.vectors.sub_f32s(a, b);
        let times = |a, b| self.vectors.mul_f32s(a, b);
        let form = &self.numbers;
        let from_centre_x = minus(x, form.cx);
        let from_centre_y = minus(y, form.cy);
        let r2 = plus(
            times(from_centre_x, from_centre_x),
            times(from_centre_y, from_centre_y),
        );
        let cubic = plus(form.k2, times(r2, form.k3));
        let square = plus(form.k1, times(r2, cubic));
        let radial = plus(form.k0, times(r2, square));
        let gain = plus(
            plus(radial, times(form.hx, from_centre_x)),
            times(form.hy, from_centre_y),
        );
        let mut dx = plus(times(from_centre_x, gain), times(form.gx, r2));
        let mut dy = plus(times(from_centre_y, gain), times(form.gy, r2));
        if FULL {
            dx = plus(dx, times(form.b1, from_centre_x));
            dx = plus(plus(dx, times(form.b2, from_centre_y)), form.tx);
            dy = plus(dy, form.ty);
        }
        Ideal {
            x: minus(x, dx),
            y: minus(y, dy),
            dx,
            dy,
        }
    }
}

impl<V: Vectors, const FULL: bool> Form<V, FULL> {
    /// Performs [`Self::ideal`] for points that lie as pairs (x, y) in two vectors.
    #[inline(always)]
    pub(super) fn ideal_pairs(&self, points: [V::f32s; 2]) -> [V::f32s; 2] {
        let [x, y] = self.vectors.parted(points);
        let Ideal { x, y, .. } = self.ideal(x, y);
        self.vectors.joined([x, y])
    }
}
