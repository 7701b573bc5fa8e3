//! Colours and sizes that the figures of a mission share.

use plotters::prelude::RGBColor;

use crate::wording;

/// Colour of the camera's values.
pub(super) const CAMERA: RGBColor = RGBColor(0, 114, 178);
/// Colour of true values.
pub(super) const TRUTH: RGBColor = RGBColor(0, 140, 100);
/// Colour of limits, faults and refusals.
pub(super) const ALARM: RGBColor = RGBColor(205, 60, 40);
/// Colour of set points.
pub(super) const WANTED: RGBColor = RGBColor(190, 130, 0);
/// Colour of the line of equal values.
pub(super) const OUTLINE_LINE: RGBColor = RGBColor(110, 118, 130);
/// Width of the column of labels left of a chart.
pub(super) const LABELS: u32 = 92;

/// Returns a range around values, larger than theirs by a part of its width and never empty.
pub(super) fn around(values: impl Iterator<Item = f64>, least_width: f64) -> [f64; 2] {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high {
        return [-0.5 * least_width, 0.5 * least_width];
    }
    let middle = 0.5 * (low + high);
    let half = 0.5 * f64::max(1.15 * (high - low), least_width);
    [middle - half, middle + half]
}

/// Writes a number at an axis; a number that rounds to zero has no sign.
pub(super) fn tick(value: f64, decimals: usize) -> String {
    let text = wording::decimals(value, decimals);
    if text == "-0" { "0".to_owned() } else { text }
}
