//! Places of output pixels in the source image: vertices in fixed point, between which places are
//! interpolated linearly.

use std::ops::Range;

use fmc_camera_kernel::resampling::{PLACE_BITS, RUN_PX, Run};

pub use crate::fixed_point::VERTEX_BITS;
use crate::fixed_point::{MORE_BITS, fixed, low, nearest, small};
pub use crate::mesh_error::MeshError;
pub use crate::spacing::{LARGEST_ERROR_PX, LARGEST_STRETCH, WIDEST_SPACING_PX};
use crate::spacing::{ROUNDING_PX, error_px, spacing};
use crate::vertices::{Layout, NONE, Places, VertexRow, last_vertex};

/// Pixels of a whole run.
const WHOLE_RUN: u8 = 16;

/// Places of all output pixels of a frame in its source image.
///
/// # Model
/// The source of every s-th pixel on both axes is the library's [`SourceRow`] of the polynomial,
/// refined in double precision with the residual grids, and continued beyond the sensor by the same
/// polynomial and splines. Between them the places are
/// interpolated linearly on both axes, in fixed point.
///
/// # Accuracy
/// [`Self::bound_px`], for every output pixel whose source lies on the sensor.
///
/// [`SourceRow`]: fmc_camera::geometry::mesh::source_row::SourceRow
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    size_px: [u32; 2],
    shift: u32,
    bound_px: f64,
    /// Whole pixels from an output pixel to its source, to which the vertices add.
    offset_px: [i32; 2],
    /// Largest difference of neighbouring vertices whose cell holds points of the sensor.
    steepest: i64,
    rows: Vec<VertexRow>,
    /// For every row of cells, whether all of them have places.
    are_whole: Vec<bool>,
}

impl Mesh {
    pub(crate) fn new(layout: &Layout<'_>) -> Result<Self, MeshError> {
        let sensor = layout.correction.polynomial().sensor();
        let (spacing_px, bounds, margin_mm) =
            spacing(layout.form, sensor).ok_or(MeshError::TooStrong)?;
        let bound_px = error_px(&bounds, sensor, spacing_px);
        let places = Places::new(layout, margin_mm);
        let steepest = (bounds.stretch + 1.0) * f64::from(spacing_px) + 1.0;
        let mut mesh = Self {
            size_px: layout.size_px,
            shift: spacing_px.trailing_zeros(),
            bound_px,
            offset_px: places.offset_px.map(nearest),
            steepest: i64::from(fixed(steepest).unwrap_or(i32::MAX)),
            rows: Vec::new(),
            are_whole: Vec::new(),
        };
        let [_, height] = layout.size_px;
        for row in 0..=last_vertex(height, mesh.shift) {
            let vertices = places.row(layout, row << mesh.shift, mesh.shift)?;
            mesh.rows.push(vertices);
        }
        let pairs = mesh.rows.windows(2);
        mesh.are_whole = pairs.map(|pair| mesh.is_whole(pair)).collect();
        Ok(mesh)
    }

    /// Distance of vertices, pixels.
    #[must_use]
    pub const fn spacing_px(&self) -> u32 {
        1 << self.shift
    }

    /// Upper bound of the distance of an interpolated place from the exact one, pixels.
    ///
    /// # Model
    /// s²/8·(largest |∂²/∂x²| + largest |∂²/∂y²|) of the measured point by the ideal one, over the
    /// sensor and the vertices around it, and the rounding of fixed point.
    #[must_use]
    pub const fn bound_px(&self) -> f64 {
        self.bound_px
    }

    /// Width and height of the output image.
    #[must_use]
    pub const fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Returns the place of an output pixel in the source image as the mesh has it, pixels; `None`
    /// for pixels off the output image, and for border pixels far from the sensor.
    #[must_use]
    pub fn place_px(&self, [col, row]: [u32; 2]) -> Option<[f64; 2]> {
        self.row_px(row).get(col as usize).copied().flatten()
    }

    /// Returns the places of a row of output pixels, as [`Self::place_px`] does.
    #[must_use]
    pub fn row_px(&self, row_px: u32) -> Vec<Option<[f64; 2]>> {
        let mut runs = Vec::new();
        self.runs(row_px, &mut runs);
        let mut places = Vec::new();
        for run in runs {
            for pixel in 0..run.count {
                places.push((!run.border).then(|| run.place_px(pixel)));
            }
        }
        places
    }

    /// Appends the places of a row of output pixels.
    pub(crate) fn runs(&self, row_px: u32, runs: &mut Vec<Run>) {
        let [width, height] = self.size_px;
        let spacing = self.spacing_px();
        let index = (row_px >> self.shift) as usize;
        let above_and_below = (row_px < height)
            .then(|| self.rows.get(index..index + 2))
            .flatten();
        let Some([above, below]) = above_and_below else {
            return border(width, runs);
        };
        let down = i64::from(row_px & (spacing - 1));
        if spacing == RUN_PX && self.are_whole.get(index) == Some(&true) {
            return self.whole_cells([above, below], row_px, runs);
        }
        let first = above.first.max(below.first);
        let mut done = 0;
        let mut last = None;
        let numbers = u32::try_from(first).unwrap_or(u32::MAX)..;
        for (number, (above, below)) in numbers.zip(above.from(first).iter().zip(below.from(first)))
        {
            let vertex = self.interpolated([*above, *below], down);
            if let (Some(from), Some(to)) = (last, vertex) {
                let start_px = (number - 1) << self.shift;
                if self.is_steep(from, to) || start_px >= width {
                    last = vertex;
                    continue;
                }
                border(start_px - done, runs);
                done = (start_px + spacing).min(width);
                self.cell([start_px, row_px], done - start_px, [from, to], runs);
            }
            last = vertex;
        }
        border(width - done, runs);
    }

    /// Returns true if all cells between two rows of vertices have places.
    fn is_whole(&self, rows: &[VertexRow]) -> bool {
        let [width, _] = self.size_px;
        let count = last_vertex(width, self.shift) as usize + 1;
        let is_near = |a: &[i32; 2], b: &[i32; 2]| {
            let way = |a: i32, b: i32| (i64::from(a) - i64::from(b)).abs();
            way(a[0], b[0]).max(way(a[1], b[1])) <= self.steepest
        };
        let is_complete = |row: &VertexRow| {
            let pairs = row.vertices.windows(2);
            let is_moderate = |place: &i32| place.unsigned_abs() < 1 << 30;
            row.vertices.len() == count
                && row.vertices.iter().flatten().all(is_moderate)
                && pairs
                    .map(<[_]>::as_ref)
                    .all(|pair| matches!(pair, [a, b] if is_near(a, b)))
        };
        let [above, below] = rows else {
            return false;
        };
        let mut pairs = above.vertices.iter().zip(&below.vertices);
        is_complete(above)
            && is_complete(below)
            && pairs.all(|(above, below)| is_near(above, below))
    }

    /// Appends the places of a row of pixels all of whose cells have places and are one run wide.
    ///
    /// With sixteen pixels to a cell, the way along a cell in 1/2²⁰ px is that of a pixel in 1/2²⁴
    /// px.
    fn whole_cells(&self, [above, below]: [&VertexRow; 2], row_px: u32, runs: &mut Vec<Run>) {
        let down = low(i64::from(row_px & (self.spacing_px() - 1)));
        let between = |above: i32, below: i32| above + (((below - above) * down + 8) >> 4);
        let mut vertices = above.vertices.iter().zip(&below.vertices);
        let Some((above, below)) = vertices.next() else {
            return;
        };
        let mut from = [between(above[0], below[0]), between(above[1], below[1])];
        let [offset_col, offset_row] = self.offset_px;
        let base_row = offset_row.wrapping_add(low(i64::from(row_px)));
        let first = runs.len();
        let mut base_col = offset_col;
        runs.extend(vertices.map(|(above, below)| {
            let to = [between(above[0], below[0]), between(above[1], below[1])];
            let run = Run {
                base_px: [
                    base_col.wrapping_add(from[0] >> VERTEX_BITS),
                    base_row.wrapping_add(from[1] >> VERTEX_BITS),
                ],
                start: from.map(|place| (place & ((1 << VERTEX_BITS) - 1)) << MORE_BITS),
                step: [to[0] - from[0] + (1 << PLACE_BITS), to[1] - from[1]],
                count: WHOLE_RUN,
                border: false,
            };
            from = to;
            base_col = base_col.wrapping_add(i32::from(WHOLE_RUN));
            run
        }));
        // The last cell may reach beyond the image.
        let [width, _] = self.size_px;
        let behind = low(i64::from(width % RUN_PX));
        if let (Some(last), Ok(behind @ 1..)) = (
            runs.get_mut(first..).and_then(<[_]>::last_mut),
            u8::try_from(behind),
        ) {
            last.count = behind;
        }
    }

    /// Returns the displacement between a vertex and the one below it, 1/2²⁴ px.
    fn interpolated(&self, [above, below]: [[i32; 2]; 2], down: i64) -> Option<[i64; 2]> {
        if above == NONE || below == NONE {
            return None;
        }
        let between = |above: i32, below: i32| {
            let (above, below) = (i64::from(above), i64::from(below));
            let change = below - above;
            let place = (above << MORE_BITS) + (((change * down) << MORE_BITS) >> self.shift);
            (change.abs() <= self.steepest).then_some(place)
        };
        Some([between(above[0], below[0])?, between(above[1], below[1])?])
    }

    fn is_steep(&self, from: [i64; 2], to: [i64; 2]) -> bool {
        let limit = self.steepest << MORE_BITS;
        (to[0] - from[0]).abs() > limit || (to[1] - from[1]).abs() > limit
    }

    /// Appends the places of a row of pixels within a cell.
    fn cell(&self, place_px: [u32; 2], count: u32, [from, to]: [[i64; 2]; 2], runs: &mut Vec<Run>) {
        let change = [to[0] - from[0], to[1] - from[1]];
        let half = (1 << self.shift) >> 1;
        let step = change.map(|change| (change + half) >> self.shift);
        let [col_px, row_px] = place_px.map(i64::from);
        let mut along = 0;
        while along < count {
            let run = (count - along).min(RUN_PX);
            let place = |from: i64, change: i64| from + ((change * i64::from(along)) >> self.shift);
            let place = [place(from[0], change[0]), place(from[1], change[1])];
            let [col_base, row_base] = place.map(|place| place >> PLACE_BITS);
            let [offset_col, offset_row] = self.offset_px.map(i64::from);
            runs.push(Run {
                base_px: [
                    small(col_base + offset_col + col_px + i64::from(along)),
                    small(row_base + offset_row + row_px),
                ],
                start: place.map(|place| small(place & ((1 << PLACE_BITS) - 1))),
                step: [small(step[0] + (1 << PLACE_BITS)), small(step[1])],
                count: u8::try_from(run).unwrap_or_default(),
                border: false,
            });
            along += run;
        }
    }

    /// Returns the rows between which the places of some output rows lie, pixels; `None` if all of
    /// their pixels are border.
    pub(crate) fn places_of_rows(&self, rows: Range<u32>) -> Option<[f64; 2]> {
        let [_, height] = self.size_px;
        let rows = rows.start..rows.end.min(height);
        let last = rows.end.checked_sub(1).filter(|last| *last >= rows.start)?;
        let mut found: Option<[f64; 2]> = None;
        let mut row = rows.start;
        loop {
            if let Some([low, high]) = self.places_of_row(row) {
                found = Some(found.map_or([low, high], |[lowest, highest]| {
                    [lowest.min(low), highest.max(high)]
                }));
            }
            if row == last {
                return found;
            }
            // Between vertices the limits are linear; they jump where a row has no vertices.
            row = ((row | (self.spacing_px() - 1)) + 1).min(last).max(row + 1);
        }
    }

    fn places_of_row(&self, row_px: u32) -> Option<[f64; 2]> {
        let index = (row_px >> self.shift) as usize;
        let [above, below] = self.rows.get(index..index + 2)? else {
            return None;
        };
        let ([low_above, high_above], [low_below, high_below]) = (above.rows?, below.rows?);
        let down = f64::from(row_px & (self.spacing_px() - 1)) / f64::from(self.spacing_px());
        let [_, offset_row] = self.offset_px;
        let between = |above: i32, below: i32| {
            let (above, below) = (f64::from(above), f64::from(below));
            let displacement = above + (below - above) * down;
            let unit = f64::from(1 << VERTEX_BITS);
            f64::from(row_px) + f64::from(offset_row) + displacement / unit
        };
        Some([
            between(low_above, low_below) - ROUNDING_PX,
            between(high_above, high_below) + ROUNDING_PX,
        ])
    }
}

/// Appends border pixels.
fn border(count: u32, runs: &mut Vec<Run>) {
    let mut left = count;
    while left > 0 {
        let run = left.min(RUN_PX);
        runs.push(Run {
            count: u8::try_from(run).unwrap_or_default(),
            border: true,
            ..Run::default()
        });
        left -= run;
    }
}
