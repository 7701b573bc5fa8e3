//! Numbers for which a program's formula is evaluated: a value, a value with its slope, and all
//! values of an interval.

use std::ops::{Add, Div, Mul, Sub};

/// A number that a formula can be evaluated with.
pub(crate) trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Returns a number without slope or width.
    fn constant(value: f64) -> Self;

    /// Returns sine and cosine of a constant angle, rad.
    fn sin_cos(self) -> (Self, Self);

    /// Returns the square, which is never negative.
    fn squared(self) -> Self {
        self * self
    }
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
}

/// A value with its derivative along one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sloped<S> {
    pub(crate) value: S,
    pub(crate) slope: S,
}

impl<S: Scalar> Sloped<S> {
    /// Returns the number with a slope of 1.
    pub(crate) fn variable(value: S) -> Self {
        Self {
            value,
            slope: S::constant(1.0),
        }
    }

    /// Returns the number with a slope of 0.
    pub(crate) fn fixed(value: S) -> Self {
        Self {
            value,
            slope: S::constant(0.0),
        }
    }
}

impl<S: Scalar> Add for Sloped<S> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

impl<S: Scalar> Sub for Sloped<S> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            slope: self.slope - other.slope,
        }
    }
}

impl<S: Scalar> Mul for Sloped<S> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl<S: Scalar> Div for Sloped<S> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self {
            value,
            slope: (self.slope - value * other.slope) / other.value,
        }
    }
}

impl<S: Scalar> Scalar for Sloped<S> {
    fn constant(value: f64) -> Self {
        Self::fixed(S::constant(value))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        let minus_sine = S::constant(0.0) - sine;
        (
            Self {
                value: sine,
                slope: cosine * self.slope,
            },
            Self {
                value: cosine,
                slope: minus_sine * self.slope,
            },
        )
    }

    fn squared(self) -> Self {
        Self {
            value: self.value.squared(),
            slope: S::constant(2.0) * self.value * self.slope,
        }
    }
}

/// All numbers from `least` to `most`. Rounding of the ends, 1e-16 of them, is not covered: the
/// margins that are shown with intervals are a thousandth and more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub(crate) least: f64,
    pub(crate) most: f64,
}

impl Interval {
    pub(crate) const fn new(least: f64, most: f64) -> Self {
        Self { least, most }
    }

    fn around(values: [f64; 4]) -> Self {
        // A NaN must not vanish in a minimum.
        if values.iter().any(|value| value.is_nan()) {
            return Self::new(f64::NEG_INFINITY, f64::INFINITY);
        }
        Self {
            least: values.into_iter().fold(f64::INFINITY, f64::min),
            most: values.into_iter().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.least + other.least, self.most + other.most)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.least - other.most, self.most - other.least)
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::around([
            self.least * other.least,
            self.least * other.most,
            self.most * other.least,
            self.most * other.most,
        ])
    }
}

impl Div for Interval {
    type Output = Self;

    /// Everything, where the divisor may be zero.
    fn div(self, other: Self) -> Self {
        if other.least <= 0.0 && other.most >= 0.0 {
            return Self::new(f64::NEG_INFINITY, f64::INFINITY);
        }
        Self::around([
            self.least / other.least,
            self.least / other.most,
            self.most / other.least,
            self.most / other.most,
        ])
    }
}

impl Scalar for Interval {
    fn constant(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Sine and cosine of the middle: angles are constants.
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = (0.5 * (self.least + self.most)).sin_cos();
        (Self::constant(sine), Self::constant(cosine))
    }

    fn squared(self) -> Self {
        let (a, b) = (self.least * self.least, self.most * self.most);
        let least = if self.least <= 0.0 && self.most >= 0.0 {
            0.0
        } else {
            a.min(b)
        };
        Self::new(least, a.max(b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slope_of_a_quotient_is_the_limit_of_differences() {
        let f = |x: Sloped<f64>| x.squared() / (Sloped::constant(1.0) + x);
        let at = |x: f64| f(Sloped::variable(x));
        let difference = (at(0.7 + 1e-6).value - at(0.7 - 1e-6).value) / 2e-6;
        assert!((at(0.7).slope - difference).abs() < 1e-9);
        let (sine, cosine) = Sloped::variable(0.3).sin_cos();
        assert!((sine.slope - cosine.value).abs() < 1e-15);
        assert!((cosine.slope + sine.value).abs() < 1e-15);
    }

    #[test]
    fn interval_holds_every_value_of_its_members() {
        let (a, b) = (Interval::new(-1.0, 2.0), Interval::new(3.0, 4.0));
        assert_eq!(a * b, Interval::new(-4.0, 8.0));
        assert_eq!(a / b, Interval::new(-1.0 / 3.0, 2.0 / 3.0));
        assert_eq!(a - b, Interval::new(-5.0, -1.0));
        assert_eq!(a.squared(), Interval::new(0.0, 4.0));
        assert!((b / a).most.is_infinite());
    }
}
