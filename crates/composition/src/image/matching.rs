//! Places of the same content in two images, by least squares.

use fmc_camera_kernel::resampling::{Kernel, MAX_TAPS, weights};
use nalgebra::{SMatrix, SVector};

use super::plane::Plane;
use crate::number::{real, whole};

/// Unknowns: shift, the affine rest, gain and offset.
const UNKNOWNS: usize = 8;
/// Largest number of rounds, which end when the shift changes by less than [`CLOSE_PX`].
const ROUNDS: usize = 25;
const CLOSE_PX: f64 = 1e-4;
/// Pixels of a window that the search by correlation looks at along a side, at most.
const SEARCH_SAMPLES: usize = 24;
/// Largest way from the start of the search that least squares may go, px.
const LARGEST_WAY_PX: f64 = 3.0;
/// Distance that there and back again may differ, px.
const BACK_PX: f64 = 0.25;

/// Choices of a match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchOptions {
    /// Columns and rows on each side of the middle pixel of a window.
    pub half_px: [usize; 2],
    /// Pixels around the expected place that are searched.
    pub search_px: usize,
    /// The content may be sheared and enlarged.
    pub affine: bool,
    /// Least correlation.
    pub least_correlation: f64,
}

/// Place of a window's content in another image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Column and row of the middle of the window, px.
    pub place_px: [f64; 2],
    /// Coefficient of correlation.
    pub correlation: f64,
    /// σ of a coordinate as the residuals have it, px.
    pub sigma_px: f64,
}

/// Finds the content of a window of one image in another one, and back again.
///
/// # Model
/// Normalised cross-correlation for the start; then least-squares matching (Ackermann 1984):
/// `b(A·x + d) = g·a(x) + o` with six-point interpolation of b, Gauss and Newton. It is accepted if
/// it correlates, and if the way back from the place that was found ends within a quarter of a
/// pixel.
///
/// `None` where the window leaves an image or its content (0), has no texture, or is not accepted.
#[must_use]
pub fn find(
    a: &Plane,
    middle: [usize; 2],
    b: &Plane,
    near_px: [f64; 2],
    options: &MatchOptions,
) -> Option<Match> {
    let there = one_way(a, middle, b, near_px, options)?;
    let pixel = there.place_px.map(|at| whole(at + 0.5));
    let expected = [0, 1].map(|axis| {
        let pick = |list: [f64; 2]| list.get(axis).copied().unwrap_or_default();
        let at = middle.get(axis).copied().unwrap_or_default();
        real(at) + real(pixel.get(axis).copied().unwrap_or_default()) - pick(there.place_px)
    });
    let back = one_way(
        b,
        pixel,
        a,
        expected,
        &MatchOptions {
            search_px: 1,
            ..*options
        },
    )?;
    let way = [
        back.place_px[0] - expected[0],
        back.place_px[1] - expected[1],
    ];
    (way[0].hypot(way[1]) <= BACK_PX).then_some(there)
}

fn one_way(
    a: &Plane,
    middle: [usize; 2],
    b: &Plane,
    near_px: [f64; 2],
    options: &MatchOptions,
) -> Option<Match> {
    let window = Window::of(a, middle, options.half_px)?;
    let start = window.search(b, near_px, options)?;
    let found = window.least_squares(b, start, options.affine)?;
    (found.correlation >= options.least_correlation).then_some(found)
}

/// Grey values of a window about its middle, normalised to mean 0 and root mean square 1.
struct Window {
    half_px: [usize; 2],
    values: Vec<f64>,
}

impl Window {
    fn of(a: &Plane, [col, row]: [usize; 2], half_px: [usize; 2]) -> Option<Self> {
        let [half_cols, half_rows] = half_px;
        let (first_col, first_row) = (col.checked_sub(half_cols)?, row.checked_sub(half_rows)?);
        let mut values = Vec::with_capacity((2 * half_cols + 1) * (2 * half_rows + 1));
        for row in first_row..=row + half_rows {
            let samples = a.row(row).get(first_col..=col + half_cols)?;
            if samples.contains(&0) {
                return None;
            }
            values.extend(samples.iter().copied().map(f64::from));
        }
        normalise(&mut values)?;
        Some(Self { half_px, values })
    }

    /// Pixels of the window from its middle, with their values.
    fn pixels(&self) -> impl Iterator<Item = ([f64; 2], f64)> {
        let [half_cols, half_rows] = self.half_px;
        let width = 2 * half_cols + 1;
        self.values.iter().enumerate().map(move |(index, value)| {
            let x = real(index % width) - real(half_cols);
            let y = real(index / width) - real(half_rows);
            ([x, y], *value)
        })
    }

    /// Returns the whole place in b that correlates best.
    fn search(&self, b: &Plane, near_px: [f64; 2], options: &MatchOptions) -> Option<[f64; 2]> {
        let [half_cols, half_rows] = self.half_px;
        let steps = self
            .half_px
            .map(|half| (2 * half + 1).div_ceil(SEARCH_SAMPLES));
        let width = 2 * half_cols + 1;
        let sampled = |index: &usize| {
            (index % width).is_multiple_of(steps[0]) && (index / width).is_multiple_of(steps[1])
        };
        let chosen: Vec<usize> = (0..self.values.len()).filter(sampled).collect();
        let mut template: Vec<f64> = chosen
            .iter()
            .filter_map(|index| self.values.get(*index).copied())
            .collect();
        normalise(&mut template)?;
        let reach = real(options.search_px);
        let first = near_px.map(|at| (at + 0.5).floor() - reach);
        let mut best: Option<(f64, [f64; 2])> = None;
        let mut values = Vec::with_capacity(chosen.len());
        let shifts = 2 * options.search_px + 1;
        for shift in 0..shifts * shifts {
            let place = [
                first[0] + real(shift % shifts),
                first[1] + real(shift / shifts),
            ];
            let (left, top) = (place[0] - real(half_cols), place[1] - real(half_rows));
            if left < 0.0 || top < 0.0 {
                continue;
            }
            let (left, top) = (whole(left), whole(top));
            values.clear();
            values.extend(chosen.iter().filter_map(|index| {
                let value = b.at(left + index % width, top + index / width)?;
                (value > 0).then(|| f64::from(value))
            }));
            if values.len() < chosen.len() || normalise(&mut values).is_none() {
                continue;
            }
            let correlation = crate::rig::polynomial::dot(&template, &values) / real(chosen.len());
            if best.is_none_or(|(most, _)| correlation > most) {
                best = Some((correlation, place));
            }
        }
        best.map(|(_, place)| place)
    }

    fn least_squares(&self, b: &Plane, start: [f64; 2], affine: bool) -> Option<Match> {
        let mut shift = start;
        // A - 1, by column then row.
        let mut shear = [0.0; 4];
        let count = real(self.values.len());
        let mut values = vec![[0.0; 3]; self.values.len()];
        for _ in 0..ROUNDS {
            let mut sums = [0.0; 2];
            for (([x, y], _), slot) in self.pixels().zip(&mut values) {
                let place = [
                    shift[0] + x + shear[0] * x + shear[1] * y,
                    shift[1] + y + shear[2] * x + shear[3] * y,
                ];
                *slot = sample(b, place)?;
                sums = [sums[0] + slot[0], sums[1] + slot[0] * slot[0]];
            }
            let mean = sums[0] / count;
            let deviation = (sums[1] / count - mean * mean).max(0.0).sqrt();
            if deviation < 1e-6 {
                return None;
            }
            let mut normals = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
            let mut right = SVector::<f64, UNKNOWNS>::zeros();
            let (mut squares, mut products) = (0.0, 0.0);
            for (([x, y], a), [value, by_col, by_row]) in self.pixels().zip(&values) {
                let [value, by_col, by_row] = [
                    (value - mean) / deviation,
                    by_col / deviation,
                    by_row / deviation,
                ];
                let row = if affine {
                    let design = [
                        by_col,
                        by_row,
                        by_col * x,
                        by_col * y,
                        by_row * x,
                        by_row * y,
                    ];
                    [
                        design[0], design[1], design[2], design[3], design[4], design[5], a, 1.0,
                    ]
                } else {
                    [by_col, by_row, 0.0, 0.0, 0.0, 0.0, a, 1.0]
                };
                let row = SVector::from(row);
                normals += row * row.transpose();
                right += row * (a - value);
                squares += (a - value) * (a - value);
                products += a * value;
            }
            if !affine {
                for unknown in 2..6 {
                    if let Some(slot) = normals.get_mut((unknown, unknown)) {
                        *slot = 1.0;
                    }
                }
            }
            let inverse = normals.cholesky()?.inverse();
            let way = inverse * right;
            let [[right_px, down_px, ..]] = way.data.0;
            shift = [shift[0] + right_px, shift[1] + down_px];
            for (slot, way) in shear.iter_mut().zip(way.iter().skip(2)) {
                *slot += way;
            }
            if (shift[0] - start[0]).hypot(shift[1] - start[1]) > LARGEST_WAY_PX {
                return None;
            }
            if right_px.hypot(down_px) < CLOSE_PX {
                let variance = (squares - way.dot(&right)).max(0.0) / (count - real(UNKNOWNS));
                let cofactor = inverse.diagonal().rows(0, 2).max();
                return Some(Match {
                    place_px: shift,
                    correlation: products / count,
                    sigma_px: (variance * cofactor).sqrt(),
                });
            }
        }
        None
    }
}

/// Brings values to mean 0 and root mean square 1; `None` without contrast.
fn normalise(values: &mut [f64]) -> Option<()> {
    let count = real(values.len().max(1));
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let deviation = (squares / count).sqrt();
    if deviation < 1e-6 {
        return None;
    }
    for value in values {
        *value = (*value - mean) / deviation;
    }
    Some(())
}

/// Returns value and derivatives to the right and downwards at a place, by six points; `None` where
/// a tap has no content.
fn sample(b: &Plane, [col, row]: [f64; 2]) -> Option<[f64; 3]> {
    const BEFORE: usize = MAX_TAPS / 2 - 1;
    if !(col >= real(BEFORE) && row >= real(BEFORE)) {
        return None;
    }
    let (first_col, first_row) = (whole(col) - BEFORE, whole(row) - BEFORE);
    let along = weights(Kernel::Keys6, col.fract());
    let down = weights(Kernel::Keys6, row.fract());
    let (by_along, by_down) = (slopes(col.fract()), slopes(row.fract()));
    let mut sums = [0.0; 3];
    for (line, (weight, slope)) in (first_row..).zip(down.iter().zip(by_down)) {
        let taps = b.row(line).get(first_col..first_col + MAX_TAPS)?;
        let (mut value, mut by_col) = (0.0, 0.0);
        for (tap, (weight, slope)) in taps.iter().zip(along.iter().zip(by_along)) {
            if *tap == 0 {
                return None;
            }
            value += weight * f64::from(*tap);
            by_col += slope * f64::from(*tap);
        }
        sums = [
            sums[0] + weight * value,
            sums[1] + weight * by_col,
            sums[2] + slope * value,
        ];
    }
    Some(sums)
}

/// Returns the derivatives of the weights by the fraction, by differences.
fn slopes(fraction: f64) -> [f64; MAX_TAPS] {
    const STEP: f64 = 1e-4;
    let (low, high) = ((fraction - STEP).max(0.0), (fraction + STEP).min(1.0));
    let (before, after) = (weights(Kernel::Keys6, low), weights(Kernel::Keys6, high));
    let mut slopes = [0.0; MAX_TAPS];
    for (slot, (a, b)) in slopes.iter_mut().zip(before.iter().zip(after)) {
        *slot = (b - a) / (high - low);
    }
    slopes
}
