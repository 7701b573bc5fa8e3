//! Conversions between counts, pixels and real numbers; mean square and median.

use statrs::statistics::{Data, Median as _};

/// Returns a count as a real number.
#[expect(clippy::cast_precision_loss, reason = "a number of pixels or points")]
#[must_use]
pub const fn real(count: usize) -> f64 {
    count as f64
}

/// Returns the nearest grey value of 16 bits.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number from 0 to 65535"
)]
#[must_use]
pub fn grey(value: f64) -> u16 {
    value.round().clamp(0.0, 65_535.0) as u16
}

/// Returns the number in single precision.
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounded to single precision"
)]
#[must_use]
pub(crate) const fn single(value: f64) -> f32 {
    value as f32
}

/// Returns a real number rounded down to a count; 0 for negative ones.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounded down, negative ones are 0"
)]
#[must_use]
pub(crate) fn whole(value: f64) -> usize {
    value.floor().max(0.0) as usize
}

/// Root of the mean square; `None` of nothing.
#[must_use]
pub fn rms(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    for value in values {
        sum += value * value;
        count += 1;
    }
    (count > 0).then(|| (sum / real(count)).sqrt())
}

/// Median; `None` of nothing.
#[must_use]
pub fn median(values: Vec<f64>) -> Option<f64> {
    (!values.is_empty()).then(|| Data::new(values).median())
}
