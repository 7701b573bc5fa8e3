//! Steps at the seams: what two layers make of the same content.

use rayon::prelude::*;

use super::layer::Layer;
use crate::image::matching::{Match, MatchOptions, find};
use crate::number::{median, real, rms};

/// Half of a window, px, where the overlap has room for it.
const HALF_PX: usize = 24;
/// Least half of a window, px.
const LEAST_HALF_PX: usize = 5;
/// Pixels that the search and six-point interpolation take on each side.
const SEARCH_PX: usize = 3;
const TAPS_PX: usize = 3;
/// Places along an overlap: at least 12.
const PLACES: usize = 24;
/// Least correlation of two sub-images of one lens and one band.
const LEAST_CORRELATION: f64 = 0.6;
/// Deviation, in robust standard deviations, of an outlier.
const OUTLIER: f64 = 4.0;

/// Steps between two layers.
#[derive(Debug, Clone, PartialEq)]
pub struct SeamStep {
    /// Numbers of the layers.
    pub layers: [usize; 2],
    /// Windows that were tried.
    pub windows: usize,
    /// Places in the virtual image, of the first and of the second layer, px.
    pub ties: Vec<[[f64; 2]; 2]>,
    /// Root mean square of a coordinate's step, px; `None` where nothing was matched.
    pub step_px: Option<f64>,
    /// Mean grey value of the second layer less that of the first one, part of their mean.
    pub grey_part: f64,
}

/// Matches the layers of a rig where they overlap along an edge.
#[must_use]
pub fn steps(layers: &[Layer]) -> Vec<SeamStep> {
    let mut found = Vec::new();
    for (first, a) in layers.iter().enumerate() {
        for (second, b) in layers.iter().enumerate().skip(first + 1) {
            let mut low = [0; 2];
            let mut sides = [0; 2];
            let starts = a.first_px.into_iter().zip(b.first_px);
            let ends = a.end_px().into_iter().zip(b.end_px());
            for ((low, side), ((a0, b0), (a1, b1))) in
                low.iter_mut().zip(&mut sides).zip(starts.zip(ends))
            {
                *low = a0.max(b0);
                *side = a1.min(b1).saturating_sub(*low);
            }
            // Neighbours that touch at a corner have no seam: along an edge at least half of the
            // smaller one overlaps.
            let [width, height] = sides;
            let is_edge = 2 * width >= a.plane.width().min(b.plane.width())
                || 2 * height >= a.plane.height().min(b.plane.height());
            if is_edge && width.min(height) > 0 {
                found.push(step(a, b, [first, second], low, sides));
            }
        }
    }
    found
}

fn step(a: &Layer, b: &Layer, layers: [usize; 2], low: [usize; 2], sides: [usize; 2]) -> SeamStep {
    let narrow = sides[0].min(sides[1]);
    // Layers are turned a little: the rectangle is wider than what both cover.
    let room = (narrow / 2).saturating_sub(SEARCH_PX + TAPS_PX + 3);
    let half = room.clamp(LEAST_HALF_PX, HALF_PX);
    let options = MatchOptions {
        half_px: sides.map(|side| {
            if side == narrow {
                half
            } else {
                HALF_PX.max(half)
            }
        }),
        search_px: SEARCH_PX,
        affine: false,
        least_correlation: LEAST_CORRELATION,
    };
    let matched: Vec<Option<[[f64; 2]; 2]>> = (0..PLACES)
        .into_par_iter()
        .map(|number| {
            let mut middle = [0; 2];
            for ((middle, low), side) in middle.iter_mut().zip(low).zip(sides) {
                let part = if side == narrow {
                    0.5
                } else {
                    (real(number) + 0.5) / real(PLACES)
                };
                *middle = low + crate::number::whole(part * real(side));
            }
            let in_layer = |layer: &Layer| {
                let [first_col, first_row] = layer.first_px;
                [
                    middle[0].checked_sub(first_col),
                    middle[1].checked_sub(first_row),
                ]
            };
            let ([Some(a_col), Some(a_row)], [Some(b_col), Some(b_row)]) =
                (in_layer(a), in_layer(b))
            else {
                return None;
            };
            let near = [real(b_col), real(b_row)];
            let Match { place_px, .. } = find(&a.plane, [a_col, a_row], &b.plane, near, &options)?;
            let [first_col, first_row] = b.first_px;
            Some([
                [real(middle[0]), real(middle[1])],
                [place_px[0] + real(first_col), place_px[1] + real(first_row)],
            ])
        })
        .collect();
    let ties = without_outliers(matched.into_iter().flatten().collect());
    let ways = ties
        .iter()
        .flat_map(|[one, other]| [other[0] - one[0], other[1] - one[1]]);
    SeamStep {
        layers,
        windows: PLACES,
        step_px: rms(ways),
        grey_part: grey_part(a, b, low, sides),
        ties,
    }
}

/// Removes ties whose step differs from the median by more than four robust deviations.
fn without_outliers(ties: Vec<[[f64; 2]; 2]>) -> Vec<[[f64; 2]; 2]> {
    let way = |tie: &[[f64; 2]; 2]| [tie[1][0] - tie[0][0], tie[1][1] - tie[0][1]];
    let of_axis =
        |axis: fn([f64; 2]) -> f64| median(ties.iter().map(|tie| axis(way(tie))).collect());
    let (Some(right), Some(down)) = (of_axis(|way| way[0]), of_axis(|way| way[1])) else {
        return ties;
    };
    let distance = |tie: &[[f64; 2]; 2]| (way(tie)[0] - right).hypot(way(tie)[1] - down);
    let limit = median(ties.iter().map(distance).collect()).unwrap_or(0.0) / 1.177 * OUTLIER;
    let limit = limit.max(0.1);
    ties.iter()
        .copied()
        .filter(|tie| distance(tie) <= limit)
        .collect()
}

fn grey_part(a: &Layer, b: &Layer, low: [usize; 2], sides: [usize; 2]) -> f64 {
    let (mut difference, mut sum) = (0.0, 0.0);
    for row in low[1]..low[1] + sides[1] {
        for col in low[0]..low[0] + sides[0] {
            let (of_a, of_b) = (a.at(col, row), b.at(col, row));
            if of_a > 0 && of_b > 0 {
                difference += f64::from(of_b) - f64::from(of_a);
                sum += 0.5 * (f64::from(of_a) + f64::from(of_b));
            }
        }
    }
    if sum > 0.0 { difference / sum } else { 0.0 }
}
