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
    /// σ², without the other values that may be true.
    pub(super) variance: f32,
    /// Variance by which the true value changes in a second.
    pub(super) change_per_s: f32,
    /// Least and largest value that may be true: this one, the one before a jump that nothing has
    /// confirmed, and those of ways that contradict it.
    pub(super) bounds: [f32; 2],
    /// `true` if nothing has confirmed the value since it has jumped.
    pub(super) is_in_doubt: bool,
    /// Age of the measurement.
    pub(super) age_s: f32,
    /// `true` if it is older than the period of its source.
    pub(super) silent: bool,
}

impl Held {
    /// Returns this height less that of the terrain; a height is at least `least_m`.
    pub(super) fn less(&self, terrain: &Self, least_m: f32) -> Self {
        let [least, most] = self.bounds;
        let [terrain_least, terrain_most] = terrain.bounds;
        Self {
            value: self.value - terrain.value,
            variance: self.variance + terrain.variance,
            change_per_s: self.change_per_s + terrain.change_per_s,
            bounds: [least - terrain_most, most - terrain_least].map(|it| it.max(least_m)),
            ..self.with_state_of(terrain)
        }
    }

    /// Returns this speed over a height: `σ² = (σ_V/H)² + (V·σ_H/H²)²`.
    pub(super) fn over(&self, height: &Self) -> Self {
        let per_height = 1.0 / height.value;
        let vh_per_s = self.value * per_height;
        let [of_speed, of_height] =
            [1.0, vh_per_s * vh_per_s].map(|it| it * per_height * per_height);
        let [slowest, fastest] = self.bounds;
        let [lowest, highest] = height.bounds;
        Self {
            value: vh_per_s,
            variance: of_speed * self.variance + of_height * height.variance,
            change_per_s: of_speed * self.change_per_s + of_height * height.change_per_s,
            bounds: [slowest / highest, fastest / lowest],
            ..self.with_state_of(height)
        }
    }

    /// Returns the value when another may be true in its place.
    pub(super) const fn or(self, other: f32) -> Self {
        let [least, most] = self.bounds;
        Self {
            bounds: [least.min(other), most.max(other)],
            ..self
        }
    }

    /// Returns the value with the age of the older of two, in doubt if one of them is.
    const fn with_state_of(&self, other: &Self) -> Self {
        Self {
            is_in_doubt: self.is_in_doubt || other.is_in_doubt,
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
            bounds: [least, most],
            is_in_doubt: _,
            age_s,
            silent,
        } = self.held;
        let off = (value - least).max(most - value);
        VhEstimate {
            vh_per_s: value,
            sigma_per_s: fmc_camera_kernel::sqrt(variance + change_per_s * ahead_s + off * off),
            age_s: age_s + ahead_s,
            source: self.source,
            extrapolated: silent,
        }
    }
}
