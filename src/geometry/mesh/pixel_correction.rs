//! Corrections of the recorded image's pixels, for meshes that push.

use super::displacement_rows::DisplacementRows;
use super::rounding_bound::{SECOND_ORDER, UNIT_ROUNDOFF, absolute};
use super::vertex::{MeshError, VertexRow};
use crate::geometry::frame_correction::FrameCorrection;
use crate::geometry::newton_step::longer_than_diagonal;
use crate::geometry::sensor::{PixelPoint, Sensor, pixels};

/// The way of a pixel of the recorded image to its place in the corrected one: corrected -
/// recorded.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct PixelCorrection {
    /// Columns, to the right.
    pub cols_px: f32,
    /// Rows, downwards.
    pub rows_px: f32,
}

/// Corrections of equidistant vertices of the recorded image, for one frame: prepared once, then
/// computed row by row by [`VertexRow::corrections`].
///
/// # Model
/// Graphics processors draw the recorded image as a mesh of triangles, each vertex at its corrected
/// place. They need corrected - recorded at vertices of the *recorded* image, which is -(measured -
/// ideal). [`DisplacementRows`] gives it without an inverse.
///
/// # Units and frames
/// Vertices are pixels of the recorded image, the centre of its first pixel (0, 0); results are
/// pixels, columns to the right and rows downwards, `-Dx·(1/p)` and `Dy·(1/p)` with the pixel p.
/// The corrected image has the same pixels and principal point.
///
/// # Accuracy
/// [`Self::rounding_bound_px`] is `(ε + s)/p + 4u·|c|` for a correction c, against the form's exact
/// value at the vertex's exact place, with u = 2⁻²⁴:
///
/// - ε is [`DisplacementRows::rounding_bound_nm`].
/// - s is the change of the distortion due to the vertex's rounded place: along the row five
///   roundings of the half width (two of the pixel's length, one of the row's first vertex, and one
///   of the way from it, which is twice as long), across it three of the half height, times the
///   largest slopes, those of absolute values of the coefficients.
/// - 4u·|c| is the rounding of the product, and of 1/p with the pixel's two roundings in it.
///
/// The bound assumes that no number underflows, which excludes corrections below 1e-30 px.
///
/// It also holds up to one spacing beyond the image, where the same polynomial is used: a vertex
/// there ends the last cell, and no calibration has an image point there. The bound is at most 5.5
/// nm for the cameras of `host-sim/cameras` and for 0.5 mm of distortion over 104 mm, up to 1024
/// pixels from vertex to vertex; at most 1 nm was found (`tests/geometry/pixel_correction.rs`).
///
/// A vertex costs two products more than a point of [`DisplacementRows`]; a division would take 14
/// cycles on a Cortex-M4F (its manual).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrectionMesh {
    rows: DisplacementRows,
    sensor: Sensor,
    spacing_px: u16,
    /// Pixels per millimetre.
    pixels_per_mm: f32,
    /// Bound on the effect of the rounded places of vertices, nm.
    place_bound_nm: f32,
    interpolation_bound_px: f32,
}

impl CorrectionMesh {
    /// Returns the mesh of a frame with vertices every `spacing_px` pixels along its rows.
    #[must_use]
    pub fn new(correction: &FrameCorrection, spacing_px: u16) -> Self {
        let sensor = *correction.sensor();
        let spacing_mm = f32::from(spacing_px) * sensor.pixel_mm();
        let pixels_per_mm = 1.0 / sensor.pixel_mm();
        let centre = correction.centre();
        let radius = longer_than_diagonal(
            sensor.half_width_mm() + spacing_mm + centre.x_mm.abs(),
            sensor.half_height_mm() + spacing_mm + centre.y_mm.abs(),
        );
        let curvature = correction.form().largest_curvature(radius);
        Self {
            rows: DisplacementRows::with_margin(correction, spacing_mm, spacing_mm),
            sensor,
            spacing_px,
            pixels_per_mm,
            interpolation_bound_px: 0.25 * curvature * spacing_mm * spacing_mm * pixels_per_mm,
            place_bound_nm: place_bound_nm(correction, spacing_mm),
        }
    }

    /// Upper bound of the rounding error of a correction of up to `largest_px`, pixels per axis.
    #[must_use]
    pub fn rounding_bound_px(&self, largest_px: f32) -> f32 {
        let row_nm = self.rows.rounding_bound_nm() + self.place_bound_nm;
        let product_px = 4.0 * UNIT_ROUNDOFF * largest_px.abs();
        SECOND_ORDER * (1e-6 * row_nm * self.pixels_per_mm + product_px)
    }

    /// Upper bound of the error that a graphics processor makes between vertices, pixels: it
    /// interpolates linearly in triangles, the two halves of squares of one spacing.
    ///
    /// # Model
    /// `C·s²/(4p)` with the spacing s and the form's largest curvature C to one spacing beyond the
    /// sensor: the error is half the mean, weighted as the interpolation is, of the second
    /// derivative along the ways to the three corners, and the mean of their squares is at most
    /// s²/2. The bound is proportional to the square of the spacing. At 16 pixels it is reached
    /// where K1 rules, and up to 11 times the error where terms compete; more at wide spacing.
    #[must_use]
    pub const fn interpolation_bound_px(&self) -> f32 {
        self.interpolation_bound_px
    }
}

/// Returns a bound on the effect of the rounded places of vertices up to `margin_mm` beyond the
/// sensor, nm per axis.
fn place_bound_nm(correction: &FrameCorrection, margin_mm: f32) -> f32 {
    let sensor = correction.sensor();
    let centre = correction.centre();
    let reach_x = sensor.half_width_mm() + margin_mm;
    let reach_y = sensor.half_height_mm() + margin_mm;
    let steepest = absolute(correction.form())
        .jacobian(reach_x + centre.x_mm.abs(), reach_y + centre.y_mm.abs());
    let [along, across] = [5.0 * reach_x, 3.0 * reach_y];
    let dx = along * steepest.dx_by_x + across * steepest.dx_by_y;
    let dy = along * steepest.dy_by_x + across * steepest.dy_by_y;
    // `f32::max` would drop a NaN.
    let larger = if dx > dy || dx.is_nan() { dx } else { dy };
    1e6 * UNIT_ROUNDOFF * larger
}

impl VertexRow {
    /// Writes the corrections of this row's vertices of the recorded image, in order, as many as
    /// `corrections` has room for, and returns the part of it that is filled. [`Self::origin_px`]
    /// does not matter.
    ///
    /// # Model
    /// As in [`CorrectionMesh`]; the bits are those of [`DisplacementRow::write`] times 1/p.
    ///
    /// # Units and frames
    /// Pixels, columns to the right, rows downwards.
    ///
    /// # Accuracy
    /// [`CorrectionMesh::rounding_bound_px`].
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
    /// use fmc_camera::geometry::frame_correction::FrameCorrection;
    /// use fmc_camera::geometry::mesh::pixel_correction::{CorrectionMesh, PixelCorrection};
    /// use fmc_camera::geometry::mesh::vertex::VertexRow;
    /// let mut lens = CalibrationParameters::new(100.0, [8001, 6001], 10.0);
    /// lens.distortion.k1 = -1e-6;
    /// let correction = FrameCorrection::without_motion(&Calibration::new(lens)?);
    /// let mesh = CorrectionMesh::new(&correction, 1000);
    /// let (first_col_px, row_px, origin_px) = (2000, 3000, [0, 0]);
    /// let row = VertexRow { first_col_px, row_px, spacing_px: 1000, count: 2, origin_px };
    /// let mut corrections = [PixelCorrection::default(); 2];
    /// row.corrections(&mesh, &mut corrections)?;
    /// // The image is K1·r³ too close to the centre, 8 µm at 20 mm to the left of it and 1 µm at
    /// // 10 mm: it goes 0.8 px and 0.1 px to the left.
    /// for (found, expected_px) in corrections.iter().zip([-0.8, -0.1]) {
    ///     assert!((found.cols_px - expected_px).abs() < 1e-5);
    /// }
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::OffImage`], which names the first vertex that lies more than one spacing beyond
    /// the last column or row; [`MeshError::Spacing`] for a mesh of another spacing. In both cases
    /// nothing is filled.
    ///
    /// [`DisplacementRow::write`]: super::displacement_rows::DisplacementRow::write
    pub fn corrections<'out>(
        &self,
        mesh: &CorrectionMesh,
        corrections: &'out mut [PixelCorrection],
    ) -> Result<&'out mut [PixelCorrection], MeshError> {
        if self.spacing_px != mesh.spacing_px {
            return Err(MeshError::Spacing {
                row_px: self.spacing_px,
                mesh_px: mesh.spacing_px,
            });
        }
        let room = u16::try_from(corrections.len()).unwrap_or(u16::MAX);
        let count = self.count.min(room);
        let corrections = corrections
            .get_mut(..usize::from(count))
            .unwrap_or_default();
        let Some(last) = count.checked_sub(1) else {
            return Ok(corrections);
        };
        let sensor = &mesh.sensor;
        // Columns rise along the row, so that the last vertex decides.
        if self.place(sensor, last).is_err() {
            for index in 0..count {
                self.place(sensor, index)?;
            }
        }
        let first = sensor.sensor_from_pixel(PixelPoint {
            col_px: pixels(self.first_col_px),
            row_px: pixels(self.row_px),
        });
        let pixels_per_mm = mesh.pixels_per_mm;
        mesh.rows
            .row(first)
            .write_as(corrections, |displacement| PixelCorrection {
                cols_px: displacement.dx_mm * -pixels_per_mm,
                rows_px: displacement.dy_mm * pixels_per_mm,
            });
        Ok(corrections)
    }
}
