//! Agreement of several ways to one number, and the choice of one of them.

use super::channel::CONSISTENT_SAMPLES;
use super::held::{Held, Stamped};
use crate::flight::time::Time;

/// Time for which the value that was trusted last makes one near it more plausible, s.
pub const TRUSTED_S: f32 = 60.0;

/// Time over which the trusted value follows the value in use, s: a value that drifts leaves it.
const FOLLOWS_IN_S: f32 = 10.0;

/// Number of standard deviations of a difference within which two values do not contradict each
/// other, whatever the limit.
pub const CONTRADICTION_SIGMAS: f32 = 2.0;

/// Part of the unexplained variance of a difference that is added to the variance of the value in
/// use: either of the two may have caused it.
pub const SHARE_OF_EXCESS: f32 = 0.5;

/// Number of differences over which the unexplained variance is averaged.
const AVERAGED_DIFFERENCES: f32 = 16.0;

/// Limits by which values are compared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Time of the comparison.
    pub(super) now: Time,
    /// Largest difference of two values that agree, as a part of the one in use.
    pub(super) difference: f32,
    /// Least and largest plausible value.
    pub(super) plausible: [f32; 2],
}

/// The way in use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice {
    pub(super) index: usize,
    /// Its value; the bounds hold the values that contradict it.
    pub(super) held: Held,
    /// The value of a way that contradicts it.
    pub(super) against: Option<f32>,
}

/// Past agreement of several ways to one number.
///
/// # Model
/// The ways are in the order of their rank. Two values contradict each other if they differ by more
/// than the limit and by more than [`CONTRADICTION_SIGMAS`] of their difference. Of two that agree,
/// one that is silent gives way to one that is not. Of two that contradict each other the less
/// plausible gives way: a value that has jumped and has not been confirmed, then one outside the
/// camera's limits, then one far from the value that was trusted last, then one that two others
/// contradict. Rank alone decides only where none of these differs.
///
/// The values of ways that contradict the one in use may be true in its place. Without a
/// contradiction its variance grows by [`SHARE_OF_EXCESS`] of the part of the squared differences
/// that both variances do not explain, at the last sample or in the mean of the last ones. A
/// latency or a constant error that the settings do not state shows there.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Agreement {
    /// Mean of the last values that no way contradicted, continued by the value in use.
    trusted: Option<Stamped>,
    /// Number of values in that mean; it counts from [`CONSISTENT_SAMPLES`] on.
    trusted_values: u8,
    /// Mean of the squared differences that both variances do not explain.
    excess: f32,
    /// The largest of them at the last sample.
    last_excess: f32,
}

impl Agreement {
    pub(super) const NEW: Self = Self {
        trusted: None,
        trusted_values: 0,
        excess: 0.0,
        last_excess: 0.0,
    };

    /// Returns the way to use, if there is one.
    pub(super) fn choose(&self, ways: &[Option<Held>], limits: &Limits) -> Option<Choice> {
        let present = || {
            let numbered = ways.iter().enumerate();
            numbered.filter_map(|(index, way)| Some((index, way.as_ref()?)))
        };
        let (mut index, mut best) = present().next()?;
        for (other_index, other) in present().skip(1) {
            let gives_way = if contradict(best, other, limits) {
                let implausible = |held| self.implausibility(held, ways, limits);
                let [best_is, other_is] = [best, other].map(implausible);
                other_is < best_is || other_is == best_is && is_fresher(other, best)
            } else {
                is_fresher(other, best)
            };
            if gives_way {
                (index, best) = (other_index, other);
            }
        }
        let mut held = *best;
        let mut against = None;
        for (_, other) in present().filter(|(other_index, _)| *other_index != index) {
            if contradict(best, other, limits) {
                held = held.or(other.value);
                against = against.or(Some(other.value));
            }
        }
        let excess = self.excess.max(self.last_excess).max(0.0);
        if against.is_none() {
            held.variance += SHARE_OF_EXCESS * excess;
        }
        Some(Choice {
            index,
            held,
            against,
        })
    }

    /// Learns from the values at a sample and the choice among them.
    pub(super) fn learn(&mut self, ways: &[Option<Held>], choice: &Choice, limits: &Limits) {
        let value = choice.held.value;
        self.last_excess = 0.0;
        if let Some(used) = ways.get(choice.index).copied().flatten() {
            let others = ways.iter().enumerate();
            for (_, other) in others.filter(|(index, _)| *index != choice.index) {
                let Some(other) = other.filter(|other| !contradict(&used, other, limits)) else {
                    continue;
                };
                let unexplained = square(other.value - value) - used.variance - other.variance;
                self.last_excess = self.last_excess.max(unexplained);
                self.excess += (unexplained - self.excess) / AVERAGED_DIFFERENCES;
            }
        }
        let is_trusted = match choice.against {
            None => !choice.held.is_in_doubt,
            Some(_) => self.is_near_trusted(value, limits) == Some(true),
        };
        if is_trusted {
            let follows = |trusted: Stamped| {
                let part = limits.now.seconds_since(trusted.time) / FOLLOWS_IN_S;
                trusted.value + part.clamp(0.0, 1.0) * (value - trusted.value)
            };
            let value = self.trusted.map_or(value, follows);
            self.trusted = Some(Stamped {
                time: limits.now,
                value,
            });
            self.trusted_values = self.trusted_values.saturating_add(1);
        }
    }

    fn implausibility(&self, held: &Held, ways: &[Option<Held>], limits: &Limits) -> u8 {
        let [least, most] = limits.plausible;
        let opponents = ways
            .iter()
            .flatten()
            .filter(|other| contradict(held, other, limits))
            .count();
        8 * u8::from(held.is_in_doubt)
            + 4 * u8::from(!(held.value >= least && held.value <= most))
            + 2 * u8::from(self.is_near_trusted(held.value, limits) == Some(false))
            + u8::from(opponents > 1)
    }

    /// Returns whether a value is near the one that was trusted last; `None` if that is too old.
    fn is_near_trusted(&self, value: f32, limits: &Limits) -> Option<bool> {
        let trusted = self
            .trusted
            .filter(|_| self.trusted_values >= CONSISTENT_SAMPLES)?;
        (limits.now.seconds_since(trusted.time) <= TRUSTED_S)
            .then(|| (value - trusted.value).abs() <= limits.difference * trusted.value.abs())
    }
}

fn contradict(used: &Held, other: &Held, limits: &Limits) -> bool {
    let difference = other.value - used.value;
    let variance = used.variance + other.variance;
    difference.abs() > limits.difference * used.value.abs()
        && square(difference) > CONTRADICTION_SIGMAS * CONTRADICTION_SIGMAS * variance
}

/// Returns `true` for a value that replaces a better one because that is silent.
fn is_fresher(other: &Held, better: &Held) -> bool {
    better.silent && (!other.silent || other.age_s < better.age_s)
}

fn square(value: f32) -> f32 {
    value * value
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(value: f32) -> Held {
        Held {
            value,
            variance: 1e-6,
            change_per_s: 0.0,
            bounds: [value; 2],
            is_in_doubt: false,
            age_s: 0.1,
            silent: false,
        }
    }

    #[test]
    fn way_outside_the_limits_of_the_camera_gives_way_to_one_inside_below_and_above() {
        let limits = Limits {
            now: Time::START,
            difference: 0.1,
            plausible: [0.02, 0.2],
        };
        for (first, second, is_first) in [
            (0.01, 0.1, false),
            (0.3, 0.1, false),
            (0.1, 0.01, true),
            (0.1, 0.3, true),
            // Rank decides between two that are inside, and two that are outside.
            (0.05, 0.1, true),
            (0.01, 0.3, true),
        ] {
            let ways = [Some(held(first)), Some(held(second))];
            let chosen = Agreement::NEW.choose(&ways, &limits).unwrap();
            assert_eq!(chosen.index, usize::from(!is_first), "{chosen:?}");
            let other = if is_first { second } else { first };
            assert_eq!(chosen.against, Some(other));
        }
    }
}
