//! Present value of a source or of a way, and its uncertainty.

use super::estimate::{VhEstimate, VhSource};
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
    /// Variance by which the true value changes in a second.
    pub(super) change_per_s: f32,
    /// Difference from the value before a jump that nothing has confirmed; 0 without one.
    pub(super) doubt: f32,
    /// Age of the measurement.
    pub(super) age_s: f32,
    /// `true` if it is older than the period of its source.
    pub(super) silent: bool,
}

impl Held {
    /// Returns this height less that of the terrain.
    pub(super) fn less(&self, terrain: &Self) -> Self {
        Self {
            value: self.value - terrain.value,
            variance: self.variance + terrain.variance,
            change_per_s: self.change_per_s + terrain.change_per_s,
            doubt: self.doubt.abs() + terrain.doubt.abs(),
            ..self.with_age_of(terrain)
        }
    }

    /// Returns this speed over a height: `σ² = (σ_V/H)² + (V·σ_H/H²)²`.
    pub(super) fn over(&self, height: &Self) -> Self {
        let per_height = 1.0 / height.value;
        let vh_per_s = self.value * per_height;
        let [of_speed, of_height] =
            [1.0, vh_per_s * vh_per_s].map(|it| it * per_height * per_height);
        Self {
            value: vh_per_s,
            variance: of_speed * self.variance + of_height * height.variance,
            change_per_s: of_speed * self.change_per_s + of_height * height.change_per_s,
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

/// The V/H in use.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeldVh {
    pub(super) source: VhSource,
    pub(super) held: Held,
}

impl HeldVh {
    /// Returns the V/H with σ and age at its use a time later, s.
    pub(crate) fn estimate(&self, ahead_s: f32) -> VhEstimate {
        let Held {
            value,
            variance,
            change_per_s,
            doubt,
            age_s,
            silent,
        } = self.held;
        VhEstimate {
            vh_per_s: value,
            sigma_per_s: libm::sqrtf(variance + change_per_s * ahead_s + doubt * doubt),
            age_s: age_s + ahead_s,
            source: self.source,
            extrapolated: silent,
        }
    }
}
