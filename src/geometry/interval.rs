//! Intervals of numbers, and the range of a cubic over one.

/// A closed interval.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    pub(super) lo: f32,
    pub(super) hi: f32,
}

impl Interval {
    pub(super) fn around_zero(reach: f32) -> Self {
        Self {
            lo: -reach,
            hi: reach,
        }
    }

    /// Returns piece `index` of `pieces` equal ones.
    #[inline(never)]
    pub(super) fn piece(self, index: u8, pieces: u8) -> Self {
        let step = (self.hi - self.lo) / f32::from(pieces);
        Self {
            lo: self.lo + step * f32::from(index),
            hi: self.lo + step * (f32::from(index) + 1.0),
        }
    }

    pub(super) fn middle(self) -> f32 {
        0.5 * (self.lo + self.hi)
    }

    /// Returns true for two numbers whose difference is one.
    pub(super) fn is_finite(self) -> bool {
        (self.hi - self.lo).is_finite()
    }

    /// Returns the interval of two ends in any order. One comparison finds both; a NaN is one of
    /// the ends, or is passed over as by [`f32::min`].
    #[inline]
    fn between(a: f32, b: f32) -> Self {
        if a < b {
            Self { lo: a, hi: b }
        } else {
            Self { lo: b, hi: a }
        }
    }

    pub(super) fn largest(self) -> f32 {
        Self::between(self.lo.abs(), self.hi.abs()).hi
    }

    #[inline(never)]
    pub(super) fn scaled(self, factor: f32) -> Self {
        Self::between(self.lo * factor, self.hi * factor)
    }

    pub(super) fn shifted(self, by: f32) -> Self {
        Self {
            lo: self.lo + by,
            hi: self.hi + by,
        }
    }

    #[inline(never)]
    pub(super) fn squared(self) -> Self {
        let Self { lo, hi: largest } = Self::between(self.lo.abs(), self.hi.abs());
        let smallest = if self.lo > 0.0 || self.hi < 0.0 {
            lo
        } else {
            0.0
        };
        Self {
            lo: smallest * smallest,
            hi: largest * largest,
        }
    }
}

impl core::ops::Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            lo: self.lo + other.lo,
            hi: self.hi + other.hi,
        }
    }
}

impl core::ops::Mul for Interval {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let low = self.scaled(other.lo);
        let high = self.scaled(other.hi);
        Self {
            lo: Self::between(low.lo, high.lo).lo,
            hi: Self::between(low.hi, high.hi).hi,
        }
    }
}

/// Returns the range of `c₀ + c₁R + c₂R² + c₃R³` over an interval, bounded by its Bernstein
/// coefficients: the values of the cubic's blossom at the interval's ends.
pub(super) fn cubic_range(coefficients: [f32; 4], over: Interval) -> Interval {
    let [c0, c1, c2, c3] = coefficients;
    let Interval { lo, hi } = over;
    let mut range = Interval {
        lo: f32::INFINITY,
        hi: f32::NEG_INFINITY,
    };
    // From (lo, lo, lo) to (hi, hi, hi).
    let [mut u, mut v, mut w] = [lo; 3];
    for _ in 0..4 {
        let value =
            c0 + c1 * (u + v + w) / 3.0 + c2 * (u * v + v * w + w * u) / 3.0 + c3 * u * v * w;
        range.lo = lesser(range.lo, value);
        range.hi = greater(range.hi, value);
        (u, v, w) = (v, w, hi);
    }
    range
}

/// Returns the lesser of two numbers, or a NaN if one of them is.
pub(crate) fn lesser(a: f32, b: f32) -> f32 {
    if a.is_nan() || a < b { a } else { b }
}

/// Returns the greater of two numbers, or a NaN if one of them is.
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a.is_nan() || a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bernstein_range_holds_the_cubic_and_touches_its_ends() {
        let cubic = [0.3, -2.0, 1.5, 0.25];
        let range = cubic_range(cubic, Interval { lo: 0.5, hi: 2.0 });
        for i in 0..=100_u8 {
            let r = 0.5 + 1.5 * f32::from(i) / 100.0;
            let value = cubic[0] + r * (cubic[1] + r * (cubic[2] + r * cubic[3]));
            assert!(range.lo - 1e-6 <= value && value <= range.hi + 1e-6);
        }
        let end = 0.3 - 4.0 + 6.0 + 2.0;
        assert!((range.hi - end).abs() < 1e-5);
    }
}
