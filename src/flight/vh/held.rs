//! Present value of a source or of a way, and its uncertainty.

use crate::flight::time::Time;

/// A sample at its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stamped {
    pub(super) time: Time,
    pub(super) value: f32,
}

/// Present value and its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Held {
    pub(super) value: f32,
    /// σ², without the doubt.
    pub(super) variance: f32,
    /// Difference from the value before a jump that nothing has confirmed; 0 without one.
    pub(super) doubt: f32,
    /// Age of the measurement.
    pub(super) age_s: f32,
    /// `true` if it is older than the period of its source.
    pub(super) silent: bool,
}

impl Held {
    /// σ, with the doubt.
    pub(super) fn sigma(&self) -> f32 {
        libm::sqrtf(self.variance + self.doubt * self.doubt)
    }

    /// Returns this height less that of the terrain.
    pub(super) fn less(&self, terrain: &Self) -> Self {
        Self {
            value: self.value - terrain.value,
            variance: self.variance + terrain.variance,
            doubt: self.doubt.abs() + terrain.doubt.abs(),
            ..self.with_age_of(terrain)
        }
    }

    /// Returns this speed over a height: `σ² = (σ_V/H)² + (V·σ_H/H²)²`.
    pub(super) fn over(&self, height: &Self) -> Self {
        let per_height = 1.0 / height.value;
        let vh_per_s = self.value * per_height;
        let of_height = vh_per_s * vh_per_s;
        Self {
            value: vh_per_s,
            variance: per_height * per_height * (self.variance + of_height * height.variance),
            doubt: per_height * (self.doubt.abs() + vh_per_s * height.doubt.abs()),
            ..self.with_age_of(height)
        }
    }

    /// Returns the value with the age of the older of two.
    const fn with_age_of(&self, other: &Self) -> Self {
        Self {
            age_s: self.age_s.max(other.age_s),
            silent: self.silent || other.silent,
            ..*self
        }
    }
}
