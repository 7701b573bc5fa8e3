//! Evaluation of the correction over vectors.

use super::vectors::Vectors;
use crate::Coefficients;

/// Coefficients of one frame, each in every lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Form<V: Vectors, const FULL: bool> {
    vectors: V,
    cx: V::f32s,
    cy: V::f32s,
    k0: V::f32s,
    k1: V::f32s,
    k2: V::f32s,
    k3: V::f32s,
    hx: V::f32s,
    hy: V::f32s,
    gx: V::f32s,
    gy: V::f32s,
    b1: V::f32s,
    b2: V::f32s,
    tx: V::f32s,
    ty: V::f32s,
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
        let all = |number| vectors.splat_f32s(number);
        Self {
            vectors,
            cx: all(form.cx),
            cy: all(form.cy),
            k0: all(form.k0),
            k1: all(form.k1),
            k2: all(form.k2),
            k3: all(form.k3),
            hx: all(form.hx),
            hy: all(form.hy),
            gx: all(form.gx),
            gy: all(form.gy),
            b1: all(form.b1),
            b2: all(form.b2),
            tx: all(form.tx),
            ty: all(form.ty),
        }
    }

    /// Performs the operations of [`crate::portable`], one by one and in the same order; none of
    /// them is fused.
    #[inline(always)]
    pub(super) fn ideal(&self, x: V::f32s, y: V::f32s) -> Ideal<V> {
        let plus = |a, b| self.vectors.add_f32s(a, b);
        let minus = |a, b| self.vectors.sub_f32s(a, b);
        let times = |a, b| self.vectors.mul_f32s(a, b);
        let from_centre_x = minus(x, self.cx);
        let from_centre_y = minus(y, self.cy);
        let r2 = plus(
            times(from_centre_x, from_centre_x),
            times(from_centre_y, from_centre_y),
        );
        let cubic = plus(self.k2, times(r2, self.k3));
        let square = plus(self.k1, times(r2, cubic));
        let radial = plus(self.k0, times(r2, square));
        let gain = plus(
            plus(radial, times(self.hx, from_centre_x)),
            times(self.hy, from_centre_y),
        );
        let mut dx = plus(times(from_centre_x, gain), times(self.gx, r2));
        let mut dy = plus(times(from_centre_y, gain), times(self.gy, r2));
        if FULL {
            dx = plus(dx, times(self.b1, from_centre_x));
            dx = plus(plus(dx, times(self.b2, from_centre_y)), self.tx);
            dy = plus(dy, self.ty);
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
