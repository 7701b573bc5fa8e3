//! Following error of the stage: a figure for the status, not for a coordinate.

use micromath::F32Ext;

/// Number of readings in the mean: an exponential window of a second and two hundredths at 1 kHz.
pub(crate) const WINDOW: f32 = 1024.0;

/// The mean square of the following error over about a second.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct FollowingErrorRms {
    mean_square_um2: f32,
}

impl FollowingErrorRms {
    /// Returns a mean without readings.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self {
            mean_square_um2: 0.0,
        }
    }

    /// Takes a following error, mm.
    pub(crate) fn push(&mut self, error_mm: f32) {
        let error_um = 1000.0 * error_mm;
        self.mean_square_um2 += (error_um * error_um - self.mean_square_um2) / WINDOW;
    }

    /// Root mean square of the following error, µm.
    ///
    /// # Accuracy
    /// 6 %, asserted below: the square root is `micromath`'s approximate one.
    #[must_use]
    pub(crate) fn rms_um(&self) -> f32 {
        F32Ext::sqrt(self.mean_square_um2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of the approximate square root, as a fraction.
    const ROOT_ERROR: f32 = 0.06;

    #[test]
    fn rms_is_right_within_the_stated_error() {
        for amplitude_um in [0.1_f32, 0.37, 1.0, 2.9, 8.0] {
            let mut following = FollowingErrorRms::default();
            for reading in 0..20_000_u16 {
                let sign = if reading % 2 == 0 { 1.0 } else { -1.0 };
                following.push(sign * 1e-3 * amplitude_um);
            }
            let error = following.rms_um() / amplitude_um - 1.0;
            assert!(error.abs() <= ROOT_ERROR, "{amplitude_um}: {error}");
        }
        assert!(FollowingErrorRms::default().rms_um() < 1e-6);
    }
}
