//! Noise of a source's value and its change in time, measured by its own samples.

use super::held::Stamped;
use super::settings::ChannelSettings;

/// Least time between two samples by whose difference the change in time is measured, s: about the
/// age at which a value is used.
const CHANGE_OVER_S: f32 = 0.4;

/// Longest time between two samples that are compared, s; the source was silent between others.
const COMPARED_WITHIN_S: f32 = 3.0;

/// Number of differences that the noise of the settings counts as.
const PRIOR_DIFFERENCES: f32 = 3.0;

/// Number of measured differences by which the change of the settings counts half.
const FADES_BY: f32 = 2.0;

/// Student's n/(n - 2) is by how much the variance of a normal error is larger whose own variance n
/// differences have measured: to first order in 1/n, the mean of n counts as n + 2.
const STUDENT: f32 = 2.0;

/// Number of differences over which noise and change are averaged.
const AVERAGED_DIFFERENCES: f32 = 24.0;

/// Number of differences from which on the settings count no less.
const MOST_DIFFERENCES: f32 = 400.0;

/// Number of differences from which on the measured change shows how far a value may go.
const SHOWN_BY: f32 = 4.0;

/// Least change in time, as a part of that of the settings.
const LEAST_CHANGE: f32 = 0.05;

/// Noise and change in time of one source.
///
/// # Model
/// A sample is the true value with a noise of variance r; the true value is a random walk, whose
/// variance grows by q per second, as gusts change a speed and the ground changes a height. The
/// difference of two samples that are T apart has the variance `2r + q·T`. Differences of
/// neighbouring samples measure r, those of samples [`CHANGE_OVER_S`] apart measure q. Each is a
/// mean over [`AVERAGED_DIFFERENCES`], which begins with the settings.
///
/// The setting `sigma` is what a maker states; it counts as [`PRIOR_DIFFERENCES`] in r, and r is at
/// least its square, since differences do not show a constant error. The change q₀ of the settings
/// is a first guess of the air, which is a hundred times as calm on one day as on another. It
/// counts as `w = 1/(1 + n/2)` differences beside n measured ones of the mean m, so that what is
/// left of it falls with n²:
///
/// ```text
/// q = (w·q₀ + (n + 2)·m) / (w + n)
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Variability {
    /// Sample with which the next one after [`CHANGE_OVER_S`] is compared.
    reference: Option<Stamped>,
    /// q, and the number of differences in it.
    change_per_s: f32,
    changes: f32,
    /// r, and the number of differences in it.
    noise: f32,
    noises: f32,
    /// r and q with the settings in them.
    variances: [f32; 2],
}

impl Variability {
    pub(super) const NEW: Self = Self {
        reference: None,
        change_per_s: 0.0,
        changes: 0.0,
        noise: 0.0,
        noises: 0.0,
        variances: [0.0; 2],
    };

    /// r and q.
    pub(super) const fn variances(&self) -> [f32; 2] {
        self.variances
    }

    /// Begins with the settings, at a first sample.
    pub(super) fn begin(&mut self, settings: &ChannelSettings) {
        if self.changes == 0.0 && self.noises == 0.0 {
            self.variances = [self.noise(settings), self.change_per_s(settings)];
        }
    }

    /// Takes a sample that follows the last one without a jump.
    pub(super) fn take(&mut self, settings: &ChannelSettings, last: Stamped, sample: Stamped) {
        let elapsed_s = sample.time.seconds_since(last.time);
        if !(elapsed_s > 0.0 && elapsed_s <= COMPARED_WITHIN_S) {
            self.reference = Some(sample);
            return;
        }
        if elapsed_s < 0.5 * CHANGE_OVER_S {
            let [_, change_per_s] = self.variances;
            let expected = change_per_s * elapsed_s;
            let found = 0.5 * (square(sample.value - last.value) - expected);
            average(&mut self.noise, found, &mut self.noises);
            self.variances = [self.noise(settings), self.change_per_s(settings)];
        }
        let reference = *self.reference.get_or_insert(last);
        let elapsed_s = sample.time.seconds_since(reference.time);
        if elapsed_s < CHANGE_OVER_S {
            return;
        }
        self.reference = Some(sample);
        if elapsed_s <= COMPARED_WITHIN_S {
            let difference = square(sample.value - reference.value);
            let [noise, _] = self.variances;
            let found = (difference - 2.0 * noise) / elapsed_s;
            average(&mut self.change_per_s, found, &mut self.changes);
            self.variances = [self.noise(settings), self.change_per_s(settings)];
        }
    }

    /// Forgets the sample that the next one would be compared with: the value has jumped.
    pub(super) const fn interrupt(&mut self) {
        self.reference = None;
    }

    /// Variance by which the value changes in a second, that of the settings until the samples have
    /// shown another.
    pub(super) fn shown_change_per_s(&self, settings: &ChannelSettings) -> f32 {
        if self.changes < SHOWN_BY {
            square(settings.change_per_sqrt_s)
        } else {
            self.change_per_s.max(0.0)
        }
    }

    fn noise(&self, settings: &ChannelSettings) -> f32 {
        let stated = square(settings.sigma);
        let measured = PRIOR_DIFFERENCES * stated + self.noises * self.noise;
        stated.max(measured / (PRIOR_DIFFERENCES + self.noises))
    }

    fn change_per_s(&self, settings: &ChannelSettings) -> f32 {
        let stated = square(settings.change_per_sqrt_s);
        let least = LEAST_CHANGE * LEAST_CHANGE * stated;
        let count = self.changes;
        let guess = FADES_BY / (FADES_BY + count);
        let measured = (count + STUDENT) * self.change_per_s;
        least.max((guess * stated + measured) / (guess + count))
    }
}

/// Takes another number into a mean.
fn average(mean: &mut f32, found: f32, count: &mut f32) {
    *count = (*count + 1.0).min(MOST_DIFFERENCES);
    *mean += (found - *mean) / count.min(AVERAGED_DIFFERENCES);
}

fn square(value: f32) -> f32 {
    value * value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::time::Time;
    use crate::flight::vh::VhSettings;

    fn at(ms: u64, value: f32) -> Stamped {
        Stamped {
            time: Time::from_us(1000 * ms),
            value,
        }
    }

    #[test]
    fn samples_of_one_time_or_after_a_silence_are_not_compared() {
        let settings = VhSettings::DEFAULT.ground_speed;
        for after in [at(1000, 70.0), at(4001, 70.0)] {
            let mut variability = Variability::NEW;
            variability.begin(&settings);
            let before = variability.variances().map(f32::to_bits);
            variability.take(&settings, at(1000, 60.0), after);
            assert_eq!(variability.variances().map(f32::to_bits), before);
            assert_eq!(variability.reference, Some(after));
        }
        let mut variability = Variability::NEW;
        variability.begin(&settings);
        let [noise, _] = variability.variances();
        variability.take(&settings, at(1000, 60.0), at(1100, 70.0));
        assert!(variability.variances()[0] > noise);
    }
}
