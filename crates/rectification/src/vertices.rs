//! Rows of vertices: sources of some output pixels.

use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::mesh::source_row::SourceRow;
use fmc_camera::geometry::sensor::SensorPoint;

use crate::fixed_point::{fixed, single};
use crate::form::Form;
use crate::mesh_error::MeshError;

/// A vertex without a source.
pub(crate) const NONE: [i32; 2] = [i32::MIN; 2];

/// A row of vertices, without those at its ends that have no source.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct VertexRow {
    pub(crate) first: usize,
    pub(crate) vertices: Vec<[i32; 2]>,
    /// Least and largest displacement of its rows.
    pub(crate) rows: Option<[i32; 2]>,
}

impl VertexRow {
    /// Returns the vertices from a number on, which is not before the first.
    pub(crate) fn from(&self, number: usize) -> &[[i32; 2]] {
        self.vertices.get(number - self.first..).unwrap_or_default()
    }
}

/// Parts of a mesh: the frame, and the output image.
pub(crate) struct Layout<'a> {
    pub(crate) correction: &'a GriddedCorrection<'a>,
    pub(crate) form: &'a Form,
    /// The point of the sensor frame in the middle of the output.
    pub(crate) middle: SensorPoint,
    pub(crate) size_px: [u32; 2],
}

/// Ideal places of vertices, and the sources among which they are looked for.
pub(crate) struct Places {
    pub(crate) pixel_mm: f64,
    pub(crate) middle_mm: [f64; 2],
    /// Half of the output's sides less one, pixels.
    pub(crate) centre_px: [f64; 2],
    pub(crate) offset_px: [f64; 2],
    /// Rest of the way from an output pixel to its source, less offset and distortion.
    pub(crate) rest_px: [f64; 2],
    /// Farthest |x| and |y| of a source.
    pub(crate) farthest_mm: [f64; 2],
    /// Least and largest ideal x and y of such a source.
    pub(crate) ideal_mm: [[f64; 2]; 2],
}

impl Places {
    pub(crate) fn new(layout: &Layout<'_>, margin_mm: f64) -> Self {
        let sensor = layout.correction.polynomial().sensor();
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
    pub(crate) fn row(
        &self,
        layout: &Layout<'_>,
        row_px: u32,
        shift: u32,
    ) -> Result<VertexRow, MeshError> {
        let [width, _] = layout.size_px;
        let y = (self.centre_px[1] - f64::from(row_px)) * self.pixel_mm + self.middle_mm[1];
        let mut found = VertexRow::default();
        let mut sources = SourceRow::new(layout.correction.polynomial());
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
    pub(crate) fn vertex(
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
pub(crate) fn ideal_limits(form: &Form, half_mm: [f64; 2], margin_mm: f64) -> [[f64; 2]; 2] {
    const PLACES: u32 = 512;
    let mut limits = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for place in 0..=PLACES {
        let along = 2.0 * f64::from(place) / f64::from(PLACES) - 1.0;
        for [x, y] in [[along, 1.0], [along, -1.0], [1.0, along], [-1.0, along]] {
            let ideal = form.ideal([x * half_mm[0], y * half_mm[1]]);
            let [low, high] = &mut limits;
            for ((low, high), place) in low.iter_mut().zip(high).zip(ideal) {
                *low = low.min(place);
                *high = high.max(place);
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
pub(crate) const fn last_vertex(side_px: u32, shift: u32) -> u32 {
    (side_px.saturating_sub(1) >> shift) + 1
}
