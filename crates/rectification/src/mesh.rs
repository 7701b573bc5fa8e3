//! Places of output pixels in the source image: vertices in fixed point, between which places are
//! interpolated linearly.

use std::ops::Range;

use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::source_row::SourceRow;
use fmc_camera::geometry::sensor::{Sensor, SensorPoint};
use fmc_camera_kernel::resampling::{PLACE_BITS, RUN_PX, Run};

use crate::bound::SourceBounds;
use crate::form::Form;

/// Largest error of a place by interpolation, pixels, that decides on the spacing.
pub const LARGEST_ERROR_PX: f64 = 0.001;
/// Largest distance of vertices, pixels.
pub const WIDEST_SPACING_PX: u32 = 256;
/// Bits of the fraction of a pixel in a vertex.
pub const VERTEX_BITS: u32 = 20;
/// Largest stretch of the way from ideal to measured points.
pub const LARGEST_STRETCH: f64 = 3.5;

/// Rounding of a place in fixed point, pixels: of the vertices by half of 1/2²⁰ px, and of the
/// interpolation by a few 1/2²⁴ px, on both axes.
const ROUNDING_PX: f64 = 1.5 / (1 << VERTEX_BITS) as f64;

/// Share by which the stretch around the sensor may be above the one on it.
const STRETCH_AROUND: f64 = 1.5;

/// Bits that a place has more than a vertex.
const MORE_BITS: u32 = PLACE_BITS - VERTEX_BITS;

/// Pixels of a whole run.
const WHOLE_RUN: u8 = 16;

/// A vertex without a source.
const NONE: [i32; 2] = [i32::MIN; 2];

/// A map that cannot be stated as a mesh.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// Not even neighbouring pixels can be interpolated, or the map folds at the sensor's edge.
    #[error(
        "the distortion is too strong for a mesh: no spacing keeps its places within {LARGEST_ERROR_PX} px"
    )]
    TooStrong,
    /// A source lies too far from its output pixel.
    #[error("a source lies {displacement_px:.0} px from its output pixel, beyond {} px", 1 << (31 - VERTEX_BITS))]
    TooFar {
        /// Distance along an axis, pixels, less the constant part.
        displacement_px: f64,
    },
}

/// Places of all output pixels of a frame in its source image.
///
/// # Model
/// The source of every s-th pixel on both axes is the library's
/// [`SourceRow`], refined in double precision and continued beyond the sensor by the same
/// polynomial. Between them the places are interpolated linearly on both axes, in fixed point.
///
/// # Accuracy
/// [`Self::bound_px`], for every output pixel whose source lies on the sensor.
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

/// A row of vertices, without those at its ends that have no source.
#[derive(Debug, Clone, PartialEq, Default)]
struct VertexRow {
    first: usize,
    vertices: Vec<[i32; 2]>,
    /// Least and largest displacement of its rows.
    rows: Option<[i32; 2]>,
}

impl VertexRow {
    /// Returns the vertices from a number on, which is not before the first.
    fn from(&self, number: usize) -> &[[i32; 2]] {
        self.vertices.get(number - self.first..).unwrap_or_default()
    }
}

/// What a mesh is made of.
pub(crate) struct Layout<'a> {
    pub(crate) correction: &'a FrameCorrection,
    pub(crate) form: &'a Form,
    /// The point of the sensor frame in the middle of the output.
    pub(crate) middle: SensorPoint,
    pub(crate) size_px: [u32; 2],
}

impl Mesh {
    pub(crate) fn new(layout: &Layout<'_>) -> Result<Self, MeshError> {
        let sensor = layout.correction.sensor();
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
            row.vertices.len() == count
                && !row.vertices.contains(&NONE)
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
    fn whole_cells(&self, [above, below]: [&VertexRow; 2], row_px: u32, runs: &mut Vec<Run>) {
        let down = i64::from(row_px & (self.spacing_px() - 1));
        let pairs = above.vertices.iter().zip(&below.vertices);
        let places: Vec<[i64; 2]> = pairs
            .map(|(above, below)| {
                let between = |above: i32, below: i32| {
                    let change = i64::from(below) - i64::from(above);
                    (i64::from(above) << MORE_BITS) + (((change * down) << MORE_BITS) >> self.shift)
                };
                [between(above[0], below[0]), between(above[1], below[1])]
            })
            .collect();
        let half = (1 << self.shift) >> 1;
        let [offset_col, offset_row] = self.offset_px;
        let base_row = offset_row.wrapping_add(low(i64::from(row_px)));
        let first = runs.len();
        let numbers = (offset_col..).step_by(RUN_PX as usize);
        let cells = places.iter().zip(places.iter().skip(1)).zip(numbers);
        runs.extend(cells.map(|((from, to), base_col)| {
            let step =
                [to[0] - from[0], to[1] - from[1]].map(|change| (change + half) >> self.shift);
            Run {
                base_px: [
                    base_col.wrapping_add(low(from[0] >> PLACE_BITS)),
                    base_row.wrapping_add(low(from[1] >> PLACE_BITS)),
                ],
                start: from.map(|place| low(place) & ((1 << PLACE_BITS) - 1)),
                step: [low(step[0]).wrapping_add(1 << PLACE_BITS), low(step[1])],
                count: WHOLE_RUN,
                border: false,
            }
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

/// Ideal places of vertices, and the sources among which they are looked for.
struct Places {
    pixel_mm: f64,
    middle_mm: [f64; 2],
    /// Half of the output's sides less one, pixels.
    centre_px: [f64; 2],
    offset_px: [f64; 2],
    /// What the offset leaves of the way from an output pixel to its source, without distortion.
    rest_px: [f64; 2],
    /// Farthest |x| and |y| of a source.
    farthest_mm: [f64; 2],
    /// Least and largest ideal x and y of such a source.
    ideal_mm: [[f64; 2]; 2],
}

impl Places {
    fn new(layout: &Layout<'_>, margin_mm: f64) -> Self {
        let sensor = layout.correction.sensor();
        let pixel_mm = f64::from(sensor.pixel_mm());
        let sensor_px = [sensor.width_px(), sensor.height_px()].map(f64::from);
        let [width, height] = layout.size_px.map(f64::from);
        let middle_mm = [layout.middle.x_mm, layout.middle.y_mm].map(f64::from);
        let way_px = [
            0.5 * (sensor_px[0] - width) + middle_mm[0] / pixel_mm,
            0.5 * (sensor_px[1] - height) - middle_mm[1] / pixel_mm,
        ];
        let offset_px = way_px.map(f64::round);
        let half_mm = sensor_px.map(|side| 0.5 * side * pixel_mm);
        Self {
            pixel_mm,
            middle_mm,
            centre_px: [0.5 * (width - 1.0), 0.5 * (height - 1.0)],
            offset_px,
            rest_px: [way_px[0] - offset_px[0], way_px[1] - offset_px[1]],
            farthest_mm: half_mm.map(|half| half + margin_mm),
            ideal_mm: ideal_limits(layout.form, half_mm, margin_mm),
        }
    }

    /// Returns a row of vertices.
    fn row(&self, layout: &Layout<'_>, row_px: u32, shift: u32) -> Result<VertexRow, MeshError> {
        let [width, _] = layout.size_px;
        let y = (self.centre_px[1] - f64::from(row_px)) * self.pixel_mm + self.middle_mm[1];
        let mut found = VertexRow::default();
        let mut sources = SourceRow::new(layout.correction);
        let mut end = 0;
        for number in 0..=last_vertex(width, shift) {
            let col_px = f64::from(number << shift);
            let x = (col_px - self.centre_px[0]) * self.pixel_mm + self.middle_mm[0];
            let Some(vertex) = self.vertex(layout, &mut sources, [x, y])? else {
                if !found.vertices.is_empty() {
                    found.vertices.push(NONE);
                }
                continue;
            };
            if found.vertices.is_empty() {
                found.first = number as usize;
            }
            let [_, row] = vertex;
            let [low, high] = found.rows.unwrap_or([row; 2]);
            found.rows = Some([low.min(row), high.max(row)]);
            found.vertices.push(vertex);
            end = found.vertices.len();
        }
        found.vertices.truncate(end);
        Ok(found)
    }

    /// Returns the displacement of a vertex, 1/2²⁰ px; `None` where its source is far from the
    /// sensor or there is none.
    fn vertex(
        &self,
        layout: &Layout<'_>,
        sources: &mut SourceRow<'_>,
        ideal: [f64; 2],
    ) -> Result<Option<[i32; 2]>, MeshError> {
        let [low, high] = self.ideal_mm;
        let within = |place: f64, low: f64, high: f64| (low..=high).contains(&place);
        if !(within(ideal[0], low[0], high[0]) && within(ideal[1], low[1], high[1])) {
            return Ok(None);
        }
        let [x_mm, y_mm] = ideal.map(single);
        let near = sources.next(SensorPoint::new(x_mm, y_mm));
        let near = near.map_or([0.0; 2], |near| [near.dx_mm, near.dy_mm].map(f64::from));
        let Some([dx, dy]) = layout.form.source(ideal, near) else {
            return Ok(None);
        };
        let [farthest_x, farthest_y] = self.farthest_mm;
        if (ideal[0] + dx).abs() > farthest_x || (ideal[1] + dy).abs() > farthest_y {
            return Ok(None);
        }
        let vertex = [
            self.rest_px[0] + dx / self.pixel_mm,
            self.rest_px[1] - dy / self.pixel_mm,
        ];
        match vertex.map(fixed) {
            [Some(col), Some(row)] => Ok(Some([col, row])),
            _ => Err(MeshError::TooFar {
                displacement_px: vertex[0].abs().max(vertex[1].abs()),
            }),
        }
    }
}

/// Returns the least and the largest ideal x and y of measured points within `margin_mm` of the
/// sensor.
fn ideal_limits(form: &Form, half_mm: [f64; 2], margin_mm: f64) -> [[f64; 2]; 2] {
    const PLACES: u32 = 512;
    let mut limits = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for place in 0..=PLACES {
        let along = 2.0 * f64::from(place) / f64::from(PLACES) - 1.0;
        for [x, y] in [[along, 1.0], [along, -1.0], [1.0, along], [-1.0, along]] {
            let ideal = form.ideal([x * half_mm[0], y * half_mm[1]]);
            for axis in 0..2 {
                if let ([low, high], Some(place)) = (&mut limits, ideal.get(axis)) {
                    low[axis] = low[axis].min(*place);
                    high[axis] = high[axis].max(*place);
                }
            }
        }
    }
    let [low, high] = limits;
    [
        low.map(|low| low - margin_mm),
        high.map(|high| high + margin_mm),
    ]
}

/// Returns the number of the last vertex along a side: that of the first cell behind the last
/// pixel.
const fn last_vertex(side_px: u32, shift: u32) -> u32 {
    (side_px.saturating_sub(1) >> shift) + 1
}

/// Returns the widest spacing whose error is within [`LARGEST_ERROR_PX`], with the bounds of the
/// map and the distance of a vertex from the sensor.
fn spacing(form: &Form, sensor: &Sensor) -> Option<(u32, SourceBounds, f64)> {
    let pixel_mm = f64::from(sensor.pixel_mm());
    let half_mm =
        [sensor.width_px(), sensor.height_px()].map(|side| 0.5 * f64::from(side) * pixel_mm);
    let on_sensor = SourceBounds::over(form, half_mm)?;
    let largest_stretch = on_sensor.stretch * STRETCH_AROUND;
    let mut spacing_px = WIDEST_SPACING_PX;
    while spacing_px > 0 {
        if error_px(&on_sensor, sensor, spacing_px) <= LARGEST_ERROR_PX {
            // The diagonal of a cell.
            let diagonal_mm = std::f64::consts::SQRT_2 * f64::from(spacing_px) * pixel_mm;
            let margin_mm = largest_stretch * diagonal_mm;
            let around = SourceBounds::over(form, half_mm.map(|half| half + margin_mm));
            if let Some(bounds) = around
                && bounds.stretch <= largest_stretch.min(LARGEST_STRETCH)
                && error_px(&bounds, sensor, spacing_px) <= LARGEST_ERROR_PX
            {
                return Some((spacing_px, bounds, margin_mm));
            }
        }
        spacing_px /= 2;
    }
    None
}

/// Returns the bound of a place's error, pixels.
fn error_px(bounds: &SourceBounds, sensor: &Sensor, spacing_px: u32) -> f64 {
    let [by_x, by_y] = bounds.second_per_mm;
    let spacing_px = f64::from(spacing_px);
    let of_lines = spacing_px * spacing_px / 8.0 * (by_x + by_y) * f64::from(sensor.pixel_mm());
    of_lines + ROUNDING_PX
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

/// Returns pixels in fixed point, unless they are too many.
fn fixed(pixels: f64) -> Option<i32> {
    let steps = (pixels * f64::from(1 << VERTEX_BITS)).round();
    (steps.abs() < f64::from(i32::MAX)).then(|| nearest(steps))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a whole number below 2³¹ in size"
)]
const fn nearest(whole: f64) -> i32 {
    whole as i32
}

#[expect(clippy::cast_possible_truncation, reason = "that is the rounding")]
const fn single(number: f64) -> f32 {
    number as f32
}

/// Returns the last 32 bits of a number.
#[expect(clippy::cast_possible_truncation, reason = "that is the result")]
const fn low(number: i64) -> i32 {
    number as i32
}

/// Returns a number that is known to be small.
fn small(number: i64) -> i32 {
    i32::try_from(number).unwrap_or(i32::MAX)
}
