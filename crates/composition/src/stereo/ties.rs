//! Ties of two virtual images.

use rayon::prelude::*;

use crate::image::Plane;
use crate::image::matching::{MatchOptions, find};
use crate::mosaic::registration::{Pair, Registration};
use crate::number::{real, whole};

/// Windows along either side of the first image.
const WINDOWS: [usize; 2] = [12, 20];
/// Half of a window, and what is searched, px.
const OPTIONS: MatchOptions = MatchOptions {
    half_px: [20, 20],
    search_px: 12,
    affine: true,
    least_correlation: 0.85,
};

/// Matches two images of one ground: places of the first and of the second image, px. Known pairs,
/// at least six, tell where to search.
#[must_use]
pub fn matched_ties(first: &Plane, second: &Plane, known: &[Pair]) -> Vec<[[f64; 2]; 2]> {
    let size = [first.width(), first.height()];
    // A plane over the pairs is enough; more bends where relief does.
    let degree = if known.len() >= 24 { 2 } else { 1 };
    let Some(expected) = Registration::unweighted(size, degree, known) else {
        return Vec::new();
    };
    let [columns, rows] = WINDOWS;
    let windows = (0..columns * rows).into_par_iter();
    let matched = windows.filter_map(|number| {
        let at = |number: usize, count: usize, side: usize| {
            whole((real(number) + 0.5) / real(count) * real(side))
        };
        let middle = [
            at(number % columns, columns, size[0]),
            at(number / columns, rows, size[1]),
        ];
        let place = middle.map(real);
        let found = find(first, middle, second, expected.at(place), &OPTIONS)?;
        Some([place, found.place_px])
    });
    matched.collect()
}
