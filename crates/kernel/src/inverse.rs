//! The way back in plain Rust: from the ideal point to the measured one by one Newton step.
//!
//! The step starts from the radial terms. A bound of the frame says up to which length it may be
//! the last; where it is longer, or leads off the sensor, the caller goes on for that point.

use crate::{Coefficients, Terms};

/// Points for which a step is taken before it is asked whether one of them needs more: they are
/// treated without a branch, side by side.
const SIDE_BY_SIDE: usize = 64;

/// Returns the number of points to go through by [`pairs`] where [`blocks`] ends, of those that are
/// left: all on a core without vectors.
#[inline]
#[must_use]
pub fn block_length(left: usize) -> usize {
    if cfg!(hand_scheduled) {
        left
    } else {
        left.min(SIDE_BY_SIDE)
    }
}

/// Conditions under which the first step is the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LastStep {
    /// Square of the longest step that may be the last, mm².
    pub longest2_mm2: f32,
    /// Largest |x| and |y| of a point of the sensor, mm.
    pub farthest_mm: [f32; 2],
}

impl LastStep {
    /// Returns true for a step of this length to this point; a NaN is neither.
    #[inline]
    #[must_use]
    pub fn ends(&self, step2_mm2: f32, [x, y]: [f32; 2]) -> bool {
        let [farthest_x, farthest_y] = self.farthest_mm;
        let is_short = step2_mm2 <= self.longest2_mm2;
        if cfg!(hand_scheduled) {
            return is_short && x.abs() <= farthest_x && y.abs() <= farthest_y;
        }
        // Without a branch the conditions of several points are tested together.
        is_short & (x.abs() <= farthest_x) & (y.abs() <= farthest_y)
    }
}

impl LastStep {
    /// Performs [`Self::ends`] on the bits of the point's numbers.
    ///
    /// Without their signs, numbers are ordered as their bits are, and a NaN is behind all. In a
    /// loop of a Cortex-M4F or M7 the shift that drops the sign is part of the comparison, while
    /// numbers are stripped of it before and have their flags moved behind: an instruction more.
    #[inline]
    fn ends_by_bits(&self, step2_mm2: f32, [x, y]: [f32; 2]) -> bool {
        let [farthest_x, farthest_y] = self.farthest_mm;
        let is_within = |value: f32, farthest: f32| value.to_bits() << 1 <= farthest.to_bits() << 1;
        step2_mm2 <= self.longest2_mm2 && is_within(x, farthest_x) && is_within(y, farthest_y)
    }
}

/// Terms that displacement and derivatives have in common at a point.
struct Local {
    r2: f32,
    gain: f32,
    /// 2G'(R) of the radial terms.
    slope2: f32,
}

impl Coefficients {
    /// Computes derivative and value by one Horner scheme.
    #[inline]
    fn local(&self, x: f32, y: f32) -> Local {
        let r2 = x * x + y * y;
        let cubic = r2 * self.k3;
        let square = self.k2 + cubic;
        let linear = self.k1 + r2 * square;
        let slope = linear + r2 * (square + cubic);
        Local {
            r2,
            gain: self.k0 + r2 * linear + self.hx * x + self.hy * y,
            slope2: slope + slope,
        }
    }

    #[inline]
    fn local_displacement(&self, terms: Terms, [x, y]: [f32; 2], local: &Local) -> [f32; 2] {
        let Local { r2, gain, .. } = *local;
        let (dx, dy) = (x * gain + self.gx * r2, y * gain + self.gy * r2);
        match terms {
            Terms::Short => [dx, dy],
            Terms::Full => [dx + self.b1 * x + self.b2 * y + self.tx, dy + self.ty],
        }
    }

    /// Returns the displacement at (`x`, `y`) mm from the centre, in the order of operations of
    /// the step.
    #[inline]
    #[must_use]
    pub fn displacement<const FULL: bool>(&self, x: f32, y: f32) -> [f32; 2] {
        self.local_displacement(terms::<FULL>(), [x, y], &self.local(x, y))
    }

    /// Returns the start from the radial terms for the ideal point (`x`, `y`) mm from the centre:
    /// Newton's step along the radius, with `1 + s + s²` for the inverse of 1 - s.
    #[inline]
    #[must_use]
    pub fn start<const FULL: bool>(&self, x: f32, y: f32) -> [f32; 2] {
        self.start_with(terms::<FULL>(), x, y)
    }

    /// Performs [`Self::start`] with terms that are known when it runs.
    #[inline]
    #[must_use]
    pub fn start_with(&self, terms: Terms, x: f32, y: f32) -> [f32; 2] {
        let local = self.local(x, y);
        let [dx, dy] = self.local_displacement(terms, [x, y], &local);
        let slope = local.gain + local.r2 * local.slope2;
        let stretch = 1.0 + (slope + slope * slope);
        [stretch * dx, stretch * dy]
    }

    /// Takes Newton's step from `start` to the displacement of the ideal point (`x`, `y`) mm from
    /// the centre, and returns it with the square of the step's length, mm².
    #[inline]
    #[must_use]
    pub fn stepped<const FULL: bool>(&self, x: f32, y: f32, start: [f32; 2]) -> ([f32; 2], f32) {
        self.stepped_with(terms::<FULL>(), x, y, start)
    }

    /// Performs [`Self::stepped`] with terms that are known when it runs.
    #[inline]
    #[must_use]
    pub fn stepped_with(
        &self,
        terms: Terms,
        x: f32,
        y: f32,
        [start_x, start_y]: [f32; 2],
    ) -> ([f32; 2], f32) {
        let (x, y) = (x + start_x, y + start_y);
        let local = self.local(x, y);
        let [dx, dy] = self.local_displacement(terms, [x, y], &local);
        let residual_x = start_x - dx;
        let residual_y = start_y - dy;
        let (twice_gx, twice_gy) = (self.gx + self.gx, self.gy + self.gy);
        let gain_by_x = local.slope2 * x + self.hx;
        let gain_by_y = local.slope2 * y + self.hy;
        let mut scale_x = 1.0 - local.gain - x * (gain_by_x + twice_gx);
        let scale_y = 1.0 - local.gain - y * (gain_by_y + twice_gy);
        let mut dx_by_y = x * gain_by_y + twice_gx * y;
        let dy_by_x = y * gain_by_x + twice_gy * x;
        if terms == Terms::Full {
            scale_x -= self.b1;
            dx_by_y += self.b2;
        }
        let inverse = 1.0 / (scale_x * scale_y - dx_by_y * dy_by_x);
        let step_x = inverse * (scale_y * residual_x + dx_by_y * residual_y);
        let step_y = inverse * (dy_by_x * residual_x + scale_x * residual_y);
        let next = [start_x - step_x, start_y - step_y];
        (next, step_x * step_x + step_y * step_y)
    }

    /// Returns the measured point of an ideal one after the first step, its distortion, and the
    /// square of the step's length, mm².
    #[expect(
        clippy::inline_always,
        reason = "a call for every point costs as much as a tenth of its loop"
    )]
    #[inline(always)]
    #[must_use]
    pub fn first_step<const FULL: bool>(&self, [x, y]: [f32; 2]) -> FirstStep {
        let (from_centre_x, from_centre_y) = (x - self.cx, y - self.cy);
        let start = self.start::<FULL>(from_centre_x, from_centre_y);
        let ([dx, dy], step2_mm2) = self.stepped::<FULL>(from_centre_x, from_centre_y, start);
        FirstStep {
            measured: [x + dx, y + dy],
            distortion: [dx, dy],
            step2_mm2,
        }
    }
}

/// Returns the terms of a form.
#[inline]
const fn terms<const FULL: bool>() -> Terms {
    if FULL { Terms::Full } else { Terms::Short }
}

/// Result of the first step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstStep {
    /// Point to which it leads, mm.
    pub measured: [f32; 2],
    /// Distortion there, measured - ideal, mm.
    pub distortion: [f32; 2],
    /// Square of its length, mm².
    pub step2_mm2: f32,
}

/// Replaces ideal points (x, y), mm, by their measured ones, a block at a time, as long as the
/// first step is the last for all of a block, and returns the number of points replaced. The points
/// behind are unchanged. A core without vectors gains nothing by it, and none is replaced.
#[inline]
pub fn blocks<const FULL: bool>(
    form: &Coefficients,
    last_step: &LastStep,
    points: &mut [[f32; 2]],
) -> usize {
    if cfg!(hand_scheduled) {
        return 0;
    }
    let mut replaced = 0;
    let (blocks, _) = points.as_chunks_mut::<SIDE_BY_SIDE>();
    let mut measured = [[0.0; 2]; SIDE_BY_SIDE];
    for block in blocks {
        let mut unfinished = 0_u32;
        for (measured, ideal) in measured.iter_mut().zip(&*block) {
            let step = form.first_step::<FULL>(*ideal);
            *measured = step.measured;
            // Joined, not counted: compilers count flags of vectors lane by lane.
            unfinished |= u32::from(!last_step.ends(step.step2_mm2, step.measured));
        }
        if unfinished > 0 {
            break;
        }
        *block = measured;
        replaced += SIDE_BY_SIDE;
    }
    replaced
}

/// Replaces ideal points (x, y), mm, by their measured ones as long as the first step is the last,
/// and returns the number of points replaced, all if it always is. The points behind are unchanged.
#[inline(never)]
pub fn pairs<const FULL: bool>(
    form: &Coefficients,
    last_step: &LastStep,
    points: &mut [[f32; 2]],
) -> usize {
    let mut replaced = 0;
    for point in points {
        let step = form.first_step::<FULL>(*point);
        let is_last = if cfg!(hand_scheduled) {
            last_step.ends_by_bits(step.step2_mm2, step.measured)
        } else {
            last_step.ends(step.step2_mm2, step.measured)
        };
        if !is_last {
            break;
        }
        *point = step.measured;
        replaced += 1;
    }
    replaced
}

#[cfg(test)]
mod tests {
    use super::LastStep;

    #[test]
    fn bits_and_numbers_of_a_point_say_the_same() {
        let edge = 20.03_f32;
        let next = f32::from_bits(edge.to_bits() + 1);
        let before = f32::from_bits(edge.to_bits() - 1);
        let numbers = [
            0.0,
            f32::MIN_POSITIVE / 2.0,
            before,
            edge,
            next,
            f32::INFINITY,
        ];
        for farthest in [0.0, edge] {
            let last_step = LastStep {
                longest2_mm2: 1e-6,
                farthest_mm: [farthest, edge],
            };
            for x in numbers
                .iter()
                .flat_map(|x| [*x, -x])
                .chain([f32::NAN, -f32::NAN])
            {
                for step2_mm2 in [0.0, 1e-6, 1.1e-6, f32::NAN] {
                    for point in [[x, 1.0], [0.0, x], [x, x]] {
                        let ends = last_step.ends(step2_mm2, point);
                        assert_eq!(last_step.ends_by_bits(step2_mm2, point), ends, "{point:?}");
                    }
                }
            }
        }
        let last_step = LastStep {
            longest2_mm2: 1e-6,
            farthest_mm: [edge; 2],
        };
        assert!(last_step.ends_by_bits(1e-6, [-edge, edge]));
        assert!(!last_step.ends_by_bits(1e-6, [next, 0.0]));
    }
}
