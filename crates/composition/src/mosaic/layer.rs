//! A sub-image in the virtual image: resampled once.

use fmc_camera_kernel::resampling::{Band, Kernel, PLACE_BITS, Resampler, Run};

use super::geometry::Geometry;
use crate::image::Plane;
use crate::number::{real, whole};
use crate::rig::VirtualSize;

/// Pixels between exact places, between which they are linear: the quadratic rest of a lens of 1 %
/// over 900 px is 0.0005 px.
const STEP_PX: usize = 8;

/// A part of the virtual image; 0 where it has no content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layer {
    /// Column and row of its first pixel in the virtual image.
    pub first_px: [usize; 2],
    /// Its pixels.
    pub plane: Plane,
}

impl Layer {
    /// Resamples a sub-image into the part of the virtual image that it covers; `None` if it covers
    /// none.
    #[must_use]
    pub fn resampled(
        frame: VirtualSize,
        image: &Plane,
        geometry: &Geometry,
        kernel: Kernel,
    ) -> Option<Self> {
        let [first, end] = covered(frame, geometry)?;
        let rows: Vec<&[u16]> = (0..image.height()).map(|row| image.row(row)).collect();
        let size = [
            u32::try_from(image.width()).ok()?,
            u32::try_from(image.height()).ok()?,
        ];
        let band = Band::new(size, 1, 0, &rows)?;
        let resampler = Resampler::new(kernel);
        let width = end[0] - first[0];
        let plane = Plane::of_rows(width, end[1] - first[1], |row| {
            let runs = runs(geometry, first, row, width);
            let (mut out, mut mask) = (vec![0; width], vec![0; width]);
            resampler.row(&band, &runs, &mut out, &mut mask);
            for (value, mask) in out.iter_mut().zip(&mask) {
                // 0 means no content.
                *value = if *mask == 0 { 0 } else { (*value).max(1) };
            }
            out
        });
        Some(Self {
            first_px: first,
            plane,
        })
    }

    /// Returns a grey value of the virtual image; 0 beyond the layer.
    #[must_use]
    pub fn at(&self, col: usize, row: usize) -> u16 {
        let [first_col, first_row] = self.first_px;
        match (col.checked_sub(first_col), row.checked_sub(first_row)) {
            (Some(col), Some(row)) => self.plane.at(col, row).unwrap_or(0),
            _ => 0,
        }
    }

    /// Column and row behind its last pixel.
    #[must_use]
    pub const fn end_px(&self) -> [usize; 2] {
        let [col, row] = self.first_px;
        [col + self.plane.width(), row + self.plane.height()]
    }
}

/// Returns the first pixel, and the one behind the last, of the virtual image that a sub-image
/// covers.
fn covered(frame: VirtualSize, geometry: &Geometry) -> Option<[[usize; 2]; 2]> {
    let [width, height] = geometry.size_px;
    let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let edges = (0..=64).flat_map(|step| {
        let part = real(step) / 64.0;
        let (right, bottom) = (real(width) - 0.5, real(height) - 0.5);
        let (col, row) = (part * real(width) - 0.5, part * real(height) - 0.5);
        [[col, -0.5], [col, bottom], [-0.5, row], [right, row]]
    });
    for pixel in edges {
        for ((least, most), at) in least
            .iter_mut()
            .zip(&mut most)
            .zip(geometry.virtual_px(pixel))
        {
            *least = least.min(at);
            *most = most.max(at);
        }
    }
    let sides = [frame.width_px, frame.height_px];
    let first = least.map(|at| whole(at.floor()));
    let mut end = [0; 2];
    for ((end, most), side) in end.iter_mut().zip(most).zip(sides) {
        *end = (whole(most.ceil()) + 1).min(side);
    }
    (first[0] < end[0] && first[1] < end[1]).then_some([first, end])
}

fn runs(geometry: &Geometry, first: [usize; 2], row: usize, width: usize) -> Vec<Run> {
    let at = |col: usize| geometry.pixel([real(first[0] + col), real(first[1] + row)]);
    let mut runs = Vec::with_capacity(width.div_ceil(STEP_PX));
    let mut start = at(0);
    for col in (0..width).step_by(STEP_PX) {
        let count = STEP_PX.min(width - col);
        let end = at(col + STEP_PX);
        runs.push(match (start, end) {
            (Some(start), Some(end)) => run(start, end, count),
            _ => border(count),
        });
        start = end;
    }
    runs
}

fn border(count: usize) -> Run {
    Run {
        count: u8::try_from(count).unwrap_or(0),
        border: true,
        ..Run::default()
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "places of images, and fractions of a pixel in 24 bits"
)]
fn run(start: [f64; 2], end: [f64; 2], count: usize) -> Run {
    let unit = f64::from(1 << PLACE_BITS);
    let is_far = |at: &f64| at.abs() > 1e8;
    let step = [end[0] - start[0], end[1] - start[1]].map(|way| way / real(STEP_PX));
    if start.iter().chain(&end).any(is_far) || step.iter().any(|way| way.abs() > 4.0) {
        return border(count);
    }
    let base = start.map(f64::floor);
    let fraction = [start[0] - base[0], start[1] - base[1]];
    Run {
        base_px: base.map(|at| at as i32),
        start: fraction.map(|part| ((part * unit) as i32).min((1 << PLACE_BITS) - 1)),
        step: step.map(|way| (way * unit).round() as i32),
        count: u8::try_from(count).unwrap_or(0),
        border: false,
    }
}
