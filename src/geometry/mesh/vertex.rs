//! Vertices of a warp engine's mesh, in pixels.

use core::fmt;

use super::format::{MeshFormat, OutOfFormat, Vertex, Word};
use super::row_store::vertex;
use super::source_row::SourceRow;
use crate::geometry::exposure_distortion::ExposureDistortion;
use crate::geometry::inverse::DistortError;
use crate::geometry::sensor::{PixelPoint, Sensor, pixels};

/// A row of vertices of the output image, or of the recorded one
/// ([`corrections`](Self::corrections)).
///
/// The output image has the pixels of the sensor at their *ideal* places: it is the corrected
/// image, about the same principal point. An engine that is given a part of the source image counts
/// from [`Self::origin_px`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VertexRow {
    /// Column of the first vertex, pixels of the whole image.
    pub first_col_px: u32,
    /// Row of all vertices, pixels of the whole image.
    pub row_px: u32,
    /// Distance from one vertex to the next, pixels.
    pub spacing_px: u16,
    /// Number of vertices.
    pub count: u16,
    /// Column and row of the whole image from which source coordinates are counted: the first pixel
    /// of the part of the source image that the engine is given. Displacements do not depend on it.
    pub origin_px: [u32; 2],
}

/// A row of a mesh cannot be given.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MeshError {
    /// A vertex lies more than one spacing beyond the last column or row.
    OffImage {
        /// Its column, pixels of the whole image.
        col_px: u32,
        /// Its row.
        row_px: u32,
    },
    /// A vertex has no source.
    Distort {
        /// Its column, pixels of the whole image.
        col_px: u32,
        /// Its row.
        row_px: u32,
        /// Error of the inverse.
        error: DistortError,
    },
    /// A number does not fit the format.
    Format(OutOfFormat),
    /// The mesh was prepared for another spacing than the row's.
    Spacing {
        /// Distance from one vertex of the row to the next, pixels.
        row_px: u16,
        /// Spacing for which the mesh was prepared, pixels.
        mesh_px: u16,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OffImage { col_px, row_px } => write!(
                f,
                "the vertex at column {col_px}, row {row_px} is more than one spacing off the image"
            ),
            Self::Distort {
                col_px,
                row_px,
                error,
            } => write!(f, "the vertex at column {col_px}, row {row_px}: {error}"),
            Self::Format(error) => error.fmt(f),
            Self::Spacing { row_px, mesh_px } => write!(
                f,
                "the vertices are {row_px} px apart, and the mesh was prepared for {mesh_px} px"
            ),
        }
    }
}

impl core::error::Error for MeshError {}

impl VertexRow {
    /// Returns the vertices with their sources, in order; vertices after the first error are not
    /// valid.
    ///
    /// # Accuracy
    /// As for [`SourceRow`], divided by the pixel. The place of the vertex itself is rounded to 8
    /// nm at 52 mm, which changes 0.5 mm of distortion over 104 mm by at most 0.3 nm.
    ///
    /// # Errors
    /// [`MeshError`], which names the vertex.
    pub fn vertices<'frame, D: ExposureDistortion>(
        &self,
        correction: &'frame D,
    ) -> impl Iterator<Item = Result<Vertex, MeshError>> + use<'frame, D> {
        let row = *self;
        let sensor = *correction.polynomial().sensor();
        let mut sources = SourceRow::new(correction);
        (0..row.count).map(move |index| row.vertex(&sensor, &mut sources, index))
    }

    /// Returns the vertices as a warp engine stores them, in order.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
    /// use fmc_camera::geometry::frame_correction::FrameCorrection;
    /// use fmc_camera::geometry::mesh::{format::MeshFormat, vertex::VertexRow};
    /// let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    /// lens.distortion.k1 = -1e-6;
    /// let correction = FrameCorrection::without_motion(&Calibration::new(lens)?);
    /// let (first_col_px, row_px, origin_px) = (2000, 3000, [0, 0]);
    /// let row = VertexRow { first_col_px, row_px, spacing_px: 16, count: 1, origin_px };
    /// let word = row.words(&correction, MeshFormat::S16Q3).next();
    /// // 20 mm to the left of the centre K1·r³ is 8 µm to the right: 0.8 px, six eighths.
    /// assert_eq!(word.unwrap().unwrap(), [6, 0, 0, 0]);
    /// # Ok::<(), fmc_camera::geometry::calibration::CalibrationError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError`], which names the vertex.
    pub fn words<'frame, D: ExposureDistortion>(
        &self,
        correction: &'frame D,
        format: MeshFormat,
    ) -> impl Iterator<Item = Result<Word, MeshError>> + use<'frame, D> {
        self.vertices(correction)
            .map(move |vertex| format.word(&vertex?).map_err(MeshError::Format))
    }

    /// Returns column and row of a vertex that is at most one spacing beyond the image.
    pub(super) fn place(&self, sensor: &Sensor, index: u16) -> Result<[u32; 2], MeshError> {
        let offset_px = u32::from(self.spacing_px).wrapping_mul(u32::from(index));
        let col_px = self.first_col_px.saturating_add(offset_px);
        let row_px = self.row_px;
        let beyond = |place_px: u32, side_px: u32| {
            place_px >= side_px.saturating_add(u32::from(self.spacing_px))
        };
        if beyond(col_px, sensor.width_px()) || beyond(row_px, sensor.height_px()) {
            return Err(MeshError::OffImage { col_px, row_px });
        }
        Ok([col_px, row_px])
    }

    fn vertex<D: ExposureDistortion>(
        &self,
        sensor: &Sensor,
        sources: &mut SourceRow<'_, D>,
        index: u16,
    ) -> Result<Vertex, MeshError> {
        let [col_px, row_px] = self.place(sensor, index)?;
        let ideal = sensor.sensor_from_pixel(PixelPoint {
            col_px: pixels(col_px),
            row_px: pixels(row_px),
        });
        let d = sources.next(ideal).map_err(|error| MeshError::Distort {
            col_px,
            row_px,
            error,
        })?;
        Ok(vertex(
            self.counted_from_origin([col_px, row_px]),
            d,
            sensor.pixel_mm(),
        ))
    }

    /// Returns the column and row of a vertex from the origin.
    pub(super) fn counted_from_origin(&self, [col_px, row_px]: [u32; 2]) -> [i32; 2] {
        let [origin_col_px, origin_row_px] = self.origin_px;
        [
            from_origin(col_px, origin_col_px),
            from_origin(row_px, origin_row_px),
        ]
    }
}

/// Returns the pixels from the origin, negative before it. An origin off every image gives a number
/// that no format holds.
fn from_origin(place_px: u32, origin_px: u32) -> i32 {
    let signed = |pixels: u32| i32::try_from(pixels).unwrap_or(i32::MAX);
    signed(place_px).saturating_sub(signed(origin_px))
}
