//! Registration of the virtual image to green.

use rayon::prelude::*;

use super::registration::Pair;
use crate::image::Plane;
use crate::image::matching::{MatchOptions, find};
use crate::number::{grey, real, whole};
use crate::rig::{Green, Rig};

/// Windows along each side of the frame.
const WINDOWS: usize = 20;
/// Half of a window, green px, at most, and as part of a side.
const HALF_PX: usize = 32;
const HALF_PART: usize = 24;
/// Green px that are searched.
const SEARCH_PX: usize = 4;
/// Samples along a side of a green pixel.
const SAMPLES: usize = 4;
/// Least correlation of two bands.
const LEAST_CORRELATION: f64 = 0.5;

/// Pairs of the virtual image and green.
#[derive(Debug, Clone, PartialEq)]
pub struct GreenMatch {
    /// From the image to the virtual image that green defines.
    pub pairs: Vec<Pair>,
    /// Windows that were tried.
    pub windows: usize,
    /// Pixels of the virtual image in one of green.
    pub ratio: f64,
}

/// Matches an image in the geometry of the virtual one with green, freed of its distortion.
///
/// The image is averaged over the pixels of green, in the geometry in which green recorded them:
/// both have one pixel size, and green is not resampled. `None` without contrast or content in
/// green's windows.
#[must_use]
pub fn green_pairs(
    rig: &Rig,
    green: &Green,
    recorded: &Plane,
    image: &Plane,
) -> Option<GreenMatch> {
    let f_px = rig.principal_distance_px();
    let ratio = f_px * green.pixel_um / (1e3 * green.principal_distance_mm);
    let [centre_u, centre_v] = rig.frame.centre_px();
    let place = |pixel: [f64; 2]| {
        let [right, down] = green.direction(pixel);
        [centre_u + f_px * right, centre_v + f_px * down]
    };
    let averaged = Plane::of_rows(green.width_px, green.height_px, |row| {
        let pixels = (0..green.width_px).map(|col| {
            let (mut sum, samples) = (0.0, SAMPLES * SAMPLES);
            for sample in 0..samples {
                let part = |number: usize| (real(number) + 0.5) / real(SAMPLES) - 0.5;
                let pixel = [
                    real(col) + part(sample % SAMPLES),
                    real(row) + part(sample / SAMPLES),
                ];
                match bilinear(image, place(pixel)) {
                    Some(value) => sum += value,
                    None => return 0,
                }
            }
            grey(sum / real(samples)).max(1)
        });
        pixels.collect()
    });
    let half = HALF_PX
        .min(green.width_px.min(green.height_px) / HALF_PART)
        .max(8);
    let options = MatchOptions {
        half_px: [half; 2],
        search_px: SEARCH_PX,
        affine: false,
        least_correlation: LEAST_CORRELATION,
    };
    let windows = WINDOWS * WINDOWS;
    let margin = half + SEARCH_PX + 8;
    let middle = |number: usize, side: usize| {
        let room = real(side.saturating_sub(2 * margin));
        margin + whole(room * real(number) / real(WINDOWS - 1))
    };
    let pairs: Vec<Pair> = (0..windows)
        .into_par_iter()
        .filter_map(|number| {
            let pixel = [
                middle(number % WINDOWS, green.width_px),
                middle(number / WINDOWS, green.height_px),
            ];
            let near = pixel.map(real);
            let found = find(recorded, pixel, &averaged, near, &options)?;
            Some(Pair {
                from_px: place(found.place_px),
                to_px: place(near),
            })
        })
        .collect();
    (!pairs.is_empty()).then_some(GreenMatch {
        pairs,
        windows,
        ratio,
    })
}

/// Returns the value between four pixels; `None` where one has no content.
fn bilinear(image: &Plane, [col, row]: [f64; 2]) -> Option<f64> {
    if col < 0.0 || row < 0.0 {
        return None;
    }
    let (first_col, first_row) = (whole(col), whole(row));
    let value = |by_col: usize, by_row: usize| {
        let value = image.at(first_col + by_col, first_row + by_row)?;
        (value > 0).then(|| f64::from(value))
    };
    let (x, y) = (col.fract(), row.fract());
    let upper = value(0, 0)? * (1.0 - x) + value(1, 0)? * x;
    let lower = value(0, 1)? * (1.0 - x) + value(1, 1)? * x;
    Some(upper * (1.0 - y) + lower * y)
}
