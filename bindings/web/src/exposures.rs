//! Exposures of an error budget: a grid over the limits of the camera, as `host-sim budget` has it.

/// Number of V/H values.
const SPEEDS: u8 = 10;
/// Number of exposure times.
const TIMES: u8 = 6;

/// Returns V/H, 1/s, and exposure time, s, of every exposure, evenly spaced over both limits, ends
/// included.
pub(crate) fn over_the_limits(
    vh_per_s: [f32; 2],
    exposure_s: [f32; 2],
) -> impl Iterator<Item = (f32, f32)> {
    spread(vh_per_s, SPEEDS)
        .flat_map(move |vh| spread(exposure_s, TIMES).map(move |exposure| (vh, exposure)))
}

fn spread([from, to]: [f32; 2], count: u8) -> impl Iterator<Item = f32> {
    let [from, to] = [f64::from(from), f64::from(to)];
    (0..count)
        .map(move |index| f64::from(index) / f64::from(count - 1))
        // In this form the last number is exactly `to`.
        .map(move |share| single(from * (1.0 - share) + to * share))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "between two numbers of single precision"
)]
const fn single(value: f64) -> f32 {
    value as f32
}
