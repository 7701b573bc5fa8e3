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
        let [dx, dy] = self.displacement([from_centre_x, from_centre_y], gain, r2);
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

/// Results of the first Newton step, one vector of each component.
pub(super) struct FirstStep<V: Vectors> {
    pub(super) measured: [V::f32s; 2],
    pub(super) distortion: [V::f32s; 2],
    /// Square of the step's length.
    pub(super) step2: V::f32s,
}

/// Terms that displacement and derivatives have in common.
struct Local<V: Vectors> {
    gain: V::f32s,
    slope2: V::f32s,
    r2: V::f32s,
    displacement: [V::f32s; 2],
}

impl<V: Vectors, const FULL: bool> Form<V, FULL> {
    /// Performs the operations of [`Coefficients::first_step`], one by one and in the same order.
    #[inline(always)]
    pub(super) fn first_step(&self, x: V::f32s, y: V::f32s) -> FirstStep<V> {
        let plus = |a, b| self.vectors.add_f32s(a, b);
        let minus = |a, b| self.vectors.sub_f32s(a, b);
        let times = |a, b| self.vectors.mul_f32s(a, b);
        let form = &self.numbers;
        let one = self.vectors.splat_f32s(1.0);
        let (ideal_x, ideal_y) = (x, y);
        let (x, y) = (minus(x, form.cx), minus(y, form.cy));
        // The start from the radial terms.
        let local = self.local(x, y);
        let slope = plus(local.gain, times(local.r2, local.slope2));
        let stretch = plus(one, plus(slope, times(slope, slope)));
        let [start_x, start_y] = local.displacement.map(|d| times(stretch, d));
        // Newton's step.
        let (x, y) = (plus(x, start_x), plus(y, start_y));
        let local = self.local(x, y);
        let [dx, dy] = local.displacement;
        let (residual_x, residual_y) = (minus(start_x, dx), minus(start_y, dy));
        let (twice_gx, twice_gy) = (plus(form.gx, form.gx), plus(form.gy, form.gy));
        let gain_by_x = plus(times(local.slope2, x), form.hx);
        let gain_by_y = plus(times(local.slope2, y), form.hy);
        let scale = minus(one, local.gain);
        let mut scale_x = minus(scale, times(x, plus(gain_by_x, twice_gx)));
        let scale_y = minus(scale, times(y, plus(gain_by_y, twice_gy)));
        let mut dx_by_y = plus(times(x, gain_by_y), times(twice_gx, y));
        let dy_by_x = plus(times(y, gain_by_x), times(twice_gy, x));
        if FULL {
            scale_x = minus(scale_x, form.b1);
            dx_by_y = plus(dx_by_y, form.b2);
        }
        let determinant = minus(times(scale_x, scale_y), times(dx_by_y, dy_by_x));
        let inverse = self.vectors.div_f32s(one, determinant);
        let along = plus(times(scale_y, residual_x), times(dx_by_y, residual_y));
        let across = plus(times(dy_by_x, residual_x), times(scale_x, residual_y));
        let (step_x, step_y) = (times(inverse, along), times(inverse, across));
        let distortion = [minus(start_x, step_x), minus(start_y, step_y)];
        let [dx, dy] = distortion;
        FirstStep {
            measured: [plus(ideal_x, dx), plus(ideal_y, dy)],
            distortion,
            step2: plus(times(step_x, step_x), times(step_y, step_y)),
        }
    }

    /// Returns the displacement at a point counted from the centre, with G and R there.
    #[inline(always)]
    fn displacement(&self, [x, y]: [V::f32s; 2], gain: V::f32s, r2: V::f32s) -> [V::f32s; 2] {
        let plus = |a, b| self.vectors.add_f32s(a, b);
        let times = |a, b| self.vectors.mul_f32s(a, b);
        let form = &self.numbers;
        let mut dx = plus(times(x, gain), times(form.gx, r2));
        let mut dy = plus(times(y, gain), times(form.gy, r2));
        if FULL {
            dx = plus(dx, times(form.b1, x));
            dx = plus(plus(dx, times(form.b2, y)), form.tx);
            dy = plus(dy, form.ty);
        }
        [dx, dy]
    }

    #[inline(always)]
    fn local(&self, x: V::f32s, y: V::f32s) -> Local<V> {
        let plus = |a, b| self.vectors.add_f32s(a, b);
        let times = |a, b| self.vectors.mul_f32s(a, b);
        let form = &self.numbers;
        let r2 = plus(times(x, x), times(y, y));
        let cubic = times(r2, form.k3);
        let square = plus(form.k2, cubic);
        let linear = plus(form.k1, times(r2, square));
        let slope = plus(linear, times(r2, plus(square, cubic)));
        let radial = plus(form.k0, times(r2, linear));
        let gain = plus(plus(radial, times(form.hx, x)), times(form.hy, y));
        Local {
            gain,
            slope2: plus(slope, slope),
            r2,
            displacement: self.displacement([x, y], gain, r2),
        }
    }
}
