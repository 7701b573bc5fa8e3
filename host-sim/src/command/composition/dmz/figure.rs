//! Figure of both ways: before, after, and the difference from truth.

use fmc_composition::image::Plane;
use fmc_composition::rig::Rig;
use fmc_composition::scene::{FULL_SCALE_DN, Scene};
use fmc_report::composition::panels::{self, Panel};

use super::places::Places;
use crate::command::composition::virtual_image::Frames;
use crate::failure::Failure;

/// Factor of the differences.
const FACTOR: f64 = 100.0;
/// Least number of pixels of a panel along its longer side.
const PANEL_PX: usize = 270;
/// Grey values of a difference are multiples of this one, which keeps the file small.
const GREY_STEP: f64 = 8.0;

/// Meaning of the figure.
pub(super) const CAPTION: &str = "First exposure: sub-images as they are recorded, at their nominal places; the virtual image; and its difference from the true image x 100: black and white are -0.5 and +0.5 % of the full scale. Differences are means over the pixels of a dot; one cubic over the frame, which orientations take up, is taken off places, and one straight line off grey values.";
/// Pixels between those that determine the straight line of grey values.
const SAMPLE_PX: usize = 7;

/// A virtual image, and its places in the true one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Composed<'a> {
    pub(super) plane: &'a Plane,
    pub(super) places: &'a Places,
}

/// Draws the figure of the first exposure.
pub(super) fn svg(
    scene: &Scene,
    recorded: &Frames,
    ours: Composed,
    theirs: Option<Composed>,
) -> Result<String, Failure> {
    let frame = scene.rig.frame;
    let dots = Dots::new([frame.width_px, frame.height_px]);
    let mut panels = vec![
        dots.panel(["Before: as recorded,", "at nominal places"], |col, row| {
            nominal_dn(&scene.rig, recorded, [col, row]).map(shade)
        }),
        dots.panel(["After: virtual image,", "heights used"], |col, row| {
            ours.plane
                .at(col, row)
                .filter(|dn| *dn > 0)
                .map(|dn| shade(dn.into()))
        }),
    ];
    let ways = [
        (Some(ours), "heights used, offset and gain"),
        (theirs, "as published: no heights, template"),
    ];
    for (composed, way) in ways {
        let known = composed.and_then(|composed| Some((composed, line(scene, composed)?)));
        if let Some((composed, [offset_dn, slope])) = known {
            panels.push(
                dots.panel(["Difference from truth x 100,", way], |col, row| {
                    let [dn, truth_dn] = pair_dn(scene, composed, [col, row])?;
                    Some(127.5 + FACTOR * shade((dn - offset_dn) / slope - truth_dn))
                }),
            );
        }
    }
    for panel in panels.iter_mut().skip(2) {
        for grey in &mut panel.grey {
            *grey = rounded(f64::from(*grey));
        }
    }
    panels::svg(&panels).map_err(|error| Failure::device_or_io(format!("figure.svg: {error}")))
}

/// Grey value of a DN, 0 to 255.
fn shade(dn: f64) -> f64 {
    255.0 * dn / FULL_SCALE_DN
}

fn rounded(grey: f64) -> u8 {
    let steps = (grey / GREY_STEP).round() * GREY_STEP;
    u8::try_from(fmc_composition::grey(steps).min(255)).unwrap_or(255)
}

/// Sample of the first sub-image that nominally shows a pixel of the virtual image.
fn nominal_dn(rig: &Rig, recorded: &Frames, [col, row]: [usize; 2]) -> Option<f64> {
    let [centre_u, centre_v] = rig.frame.centre_px();
    let number = |value: usize| f64::from(u32::try_from(value).unwrap_or(u32::MAX));
    let mut subs = rig.sub.iter().zip(&recorded.subs);
    subs.find_map(|(sub, plane)| {
        let [centre_col, centre_row] = sub.centre_px();
        let [right, down] = sub.place_px;
        let at = [
            number(col) - centre_u - right + centre_col,
            number(row) - centre_v - down + centre_row,
        ];
        let [at_col, at_row] = at.map(pixel);
        plane.at(at_col?, at_row?).map(f64::from)
    })
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place of an image"
)]
fn pixel(at: f64) -> Option<usize> {
    (-0.5..1e6)
        .contains(&at)
        .then_some(at.round().max(0.0) as usize)
}

/// Returns value and truth at a pixel, DN, places registered by one cubic.
fn pair_dn(scene: &Scene, composed: Composed, [col, row]: [usize; 2]) -> Option<[f64; 2]> {
    let cubic = composed.places.cubic.as_ref()?;
    let dn = composed.plane.at(col, row).filter(|dn| *dn > 0)?;
    let number = |value: usize| f64::from(u32::try_from(value).unwrap_or(u32::MAX));
    let place = cubic.at([number(col), number(row)]);
    Some([f64::from(dn), scene.true_dn(0, place)?])
}

/// Returns offset, DN, and slope of the grey values over the true ones; `None` without content.
fn line(scene: &Scene, composed: Composed) -> Option<[f64; 2]> {
    let [mut count, mut sum, mut sum_truth, mut squares, mut products] = [0.0; 5];
    for row in (0..composed.plane.height()).step_by(SAMPLE_PX) {
        for col in (0..composed.plane.width()).step_by(SAMPLE_PX) {
            if let Some([dn, truth_dn]) = pair_dn(scene, composed, [col, row]) {
                count += 1.0;
                sum += dn;
                sum_truth += truth_dn;
                squares += truth_dn * truth_dn;
                products += truth_dn * dn;
            }
        }
    }
    let slope = (products - sum * sum_truth / count) / (squares - sum_truth * sum_truth / count);
    let is_line = slope.is_finite() && slope > 0.0;
    is_line.then(|| [(sum - slope * sum_truth) / count, slope])
}

/// Squares of pixels that are one dot of a panel.
#[derive(Debug, Clone, Copy)]
struct Dots {
    size_px: [usize; 2],
    step_px: usize,
}

impl Dots {
    fn new(size_px: [usize; 2]) -> Self {
        let longest = size_px.into_iter().fold(0, usize::max);
        Self {
            size_px,
            step_px: (longest / PANEL_PX).max(1),
        }
    }

    /// Makes a panel of the mean grey values of the pixels of every dot; black where none has a
    /// value.
    fn panel(self, title: [&str; 2], grey: impl Fn(usize, usize) -> Option<f64> + Sync) -> Panel {
        let [width, height] = self.size_px.map(|side| side / self.step_px);
        let dots = Plane::of_rows(width, height, |row| {
            let mean = |col: usize| {
                let (mut sum, mut count) = (0.0, 0.0);
                for index in 0..self.step_px * self.step_px {
                    let at_col = col * self.step_px + index % self.step_px;
                    let at_row = row * self.step_px + index / self.step_px;
                    if let Some(grey) = grey(at_col, at_row) {
                        sum += grey;
                        count += 1.0;
                    }
                }
                if count > 0.0 {
                    fmc_composition::grey(sum / count)
                } else {
                    0
                }
            };
            (0..width).map(mean).collect()
        });
        let grey = dots
            .values()
            .iter()
            .map(|grey| u8::try_from(*grey).unwrap_or(255));
        Panel {
            title: title.map(str::to_owned),
            width_px: width,
            grey: grey.collect(),
        }
    }
}
