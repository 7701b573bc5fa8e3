//! Kernel of the way back, for points whose x and y lie in separate slices of one length.

use super::form::Form;
use super::last_mut;
use super::vectors::{Vectors, Work};
use crate::Coefficients;
use crate::inverse::LastStep;

/// Measured points and their distortion, each written into a separate slice: x is NaN where the
/// first step is not the last.
pub(super) struct WithDistortion<'a, const FULL: bool> {
    pub(super) form: &'a Coefficients,
    pub(super) last_step: &'a LastStep,
    pub(super) ideal: [&'a [f32]; 2],
    pub(super) measured: [&'a mut [f32]; 2],
    pub(super) distortion: [&'a mut [f32]; 2],
    /// Set to `false` if the first step of a point is not the last.
    pub(super) all_end: &'a mut bool,
}

/// Measured points after the first step, one vector of each component, and those that end there.
struct Measured<V: Vectors> {
    x: V::f32s,
    y: V::f32s,
    dx: V::f32s,
    dy: V::f32s,
    ends: V::m32s,
}

impl<const FULL: bool> Work for WithDistortion<'_, FULL> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let form = Form::<V, FULL>::new(vectors, self.form);
        let last_step = Ends::new(vectors, self.last_step);
        let [ideal_x, ideal_y] = self.ideal;
        let [x, y] = self.measured;
        let [dx, dy] = self.distortion;
        let ends = |ideal_x, ideal_y| last_step.measured(&form, ideal_x, ideal_y);
        let ([.., last_x], [.., last_y]) =
            (V::as_rsimd_f32s(ideal_x).1, V::as_rsimd_f32s(ideal_y).1)
        else {
            // Beyond the slices the lanes are zero, which may be off the sensor no more than any
            // other point: they are not stored, and `x` says which of the others do not end.
            let ideal_x = vectors.partial_load_f32s(ideal_x);
            let measured = ends(ideal_x, vectors.partial_load_f32s(ideal_y));
            vectors.partial_store_f32s(x, measured.x);
            vectors.partial_store_f32s(y, measured.y);
            vectors.partial_store_f32s(dx, measured.dx);
            vectors.partial_store_f32s(dy, measured.dy);
            *self.all_end &= !x.iter().any(|x| x.is_nan());
            return;
        };
        let at_last = ends(*last_x, *last_y);
        let mut all = at_last.ends;
        let from = V::as_simd_f32s(ideal_x).0.iter();
        let from = from.zip(V::as_simd_f32s(ideal_y).0);
        let to = V::as_mut_simd_f32s(x).0.iter_mut();
        let to = to.zip(V::as_mut_simd_f32s(y).0);
        let to = to.zip(V::as_mut_simd_f32s(dx).0);
        let to = to.zip(V::as_mut_simd_f32s(dy).0);
        for ((ideal_x, ideal_y), (((x, y), dx), dy)) in from.zip(to) {
            let measured = ends(*ideal_x, *ideal_y);
            all = vectors.and_m32s(all, measured.ends);
            *x = measured.x;
            *y = measured.y;
            *dx = measured.dx;
            *dy = measured.dy;
        }
        for (slice, at_last) in [
            (x, at_last.x),
            (y, at_last.y),
            (dx, at_last.dx),
            (dy, at_last.dy),
        ] {
            if let Some(place) = last_mut::<V>(slice) {
                *place = at_last;
            }
        }
        *self.all_end &= vectors.first_true_m32s(vectors.not_m32s(all)) >= V::F32_LANES;
    }
}

/// Conditions under which the first step is the last, in every lane.
struct Ends<V: Vectors> {
    vectors: V,
    longest2: V::f32s,
    farthest: [V::f32s; 2],
    nan: V::f32s,
}

impl<V: Vectors> Ends<V> {
    #[inline(always)]
    fn new(vectors: V, last_step: &LastStep) -> Self {
        Self {
            vectors,
            longest2: vectors.splat_f32s(last_step.longest2_mm2),
            farthest: last_step
                .farthest_mm
                .map(|farthest| vectors.splat_f32s(farthest)),
            nan: vectors.splat_f32s(f32::NAN),
        }
    }

    /// Takes the first step and tests whether it is the last.
    #[inline(always)]
    fn measured<const FULL: bool>(
        &self,
        form: &Form<V, FULL>,
        ideal_x: V::f32s,
        ideal_y: V::f32s,
    ) -> Measured<V> {
        let vectors = self.vectors;
        let step = form.first_step(ideal_x, ideal_y);
        let [x, y] = step.measured;
        let [farthest_x, farthest_y] = self.farthest;
        let short = vectors.less_than_or_equal_f32s(step.step2, self.longest2);
        let within_x = vectors.less_than_or_equal_f32s(vectors.abs_f32s(x), farthest_x);
        let within_y = vectors.less_than_or_equal_f32s(vectors.abs_f32s(y), farthest_y);
        let ends = vectors.and_m32s(short, vectors.and_m32s(within_x, within_y));
        let [dx, dy] = step.distortion;
        Measured {
            x: vectors.select_f32s(ends, x, self.nan),
            y,
            dx,
            dy,
            ends,
        }
    }
}
