//! Virtual image against truth, at 30 places of each sub-image.

use fmc_composition::image::Plane;
use fmc_composition::image::matching::{MatchOptions, find};
use fmc_composition::mosaic::registration::{Pair, Registration};
use fmc_composition::rig::Rig;
use fmc_composition::rig::polynomial::normalised;

/// Degree of the polynomial over the frame that registration takes off.
const DEGREE: usize = 3;

/// Places of a composed image that were found in the true one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Places {
    /// Places that were tried.
    pub(super) tried: usize,
    /// Places that were found.
    pub(super) matched: usize,
    /// Cubic from the true to the composed image; `None` where too few places were found.
    pub(super) cubic: Option<Registration>,
}

impl Places {
    /// Finds 30 places of each sub-image, up to `search_px` from where they would be.
    pub(super) fn find(rig: &Rig, composed: &Plane, truth: &Plane, search_px: usize) -> Self {
        let options = MatchOptions {
            half_px: [16, 16],
            search_px,
            affine: true,
            least_correlation: 0.8,
        };
        let mut pairs = Vec::new();
        let mut tried = 0;
        for sub in &rig.sub {
            for number in 0..30_u32 {
                let part = |number: u32, count: u32| (f64::from(number) + 0.5) / f64::from(count);
                let [centre_col, centre_row] = sub.centre_px();
                let pixel = [
                    2.0 * centre_col * part(number % 5, 5),
                    2.0 * centre_row * part(number / 5, 6),
                ];
                let place = sub
                    .nominal(rig.frame)
                    .value(normalised(sub.size_px(), pixel));
                let [Some(col), Some(row)] = place.map(pixel_of) else {
                    continue;
                };
                tried += 1;
                let middle = [f64::from(col), f64::from(row)];
                let near = [col as usize, row as usize];
                if let Some(found) = find(composed, near, truth, middle, &options) {
                    pairs.push(Pair {
                        from_px: middle,
                        to_px: found.place_px,
                    });
                }
            }
        }
        let size = [rig.frame.width_px, rig.frame.height_px];
        Self {
            tried,
            matched: pairs.len(),
            cubic: Registration::unweighted(size, DEGREE, &pairs),
        }
    }

    /// Root mean square of a coordinate after the cubic, px; infinite where too few were found.
    pub(super) fn residual_px(&self) -> f64 {
        let cubic = self.cubic.as_ref();
        cubic.map_or(f64::INFINITY, |cubic| cubic.residual_px)
    }

    /// Returns true if nine in ten places were found.
    pub(super) fn is_complete(&self) -> bool {
        self.tried > 0 && 10 * self.matched >= 9 * self.tried
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place of an image"
)]
fn pixel_of(at: f64) -> Option<u32> {
    (0.0..1e6).contains(&at).then_some(at as u32)
}
