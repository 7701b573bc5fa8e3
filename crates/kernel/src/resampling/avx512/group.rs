//! Pixels that are computed together.

/// Samples of a load.
pub(super) const LOADED: usize = 32;

/// Returns true for the numbers of bands and taps whose sixteen pixels are one group: the weights
/// then lie where they are needed, and a row is loaded twice instead of four times.
pub(super) const fn is_by_bands(bands: usize, taps: usize) -> bool {
    bands == 3 && taps == 2
}

/// Pixels of a group.
pub(super) const fn group_px(bands: usize, taps: usize) -> i32 {
    if bands == 1 || is_by_bands(bands, taps) {
        16
    } else {
        4
    }
}

/// Samples from a group's first tap on that are loaded.
pub(super) const fn loaded(bands: usize, taps: usize) -> usize {
    let wide = bands > 1 && bands * (4 + taps) > LOADED;
    if wide || is_by_bands(bands, taps) {
        2 * LOADED
    } else {
        LOADED
    }
}
