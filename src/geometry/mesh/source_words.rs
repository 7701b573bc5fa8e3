//! Rows of a mesh of sources, in mm and as warp engines store them.

use super::block_row::BlockRow;
use super::format::{MeshFormat, q12_20, s16q3, single, uq12_4};
use super::row_store::{Millimetres, RowStore};
use super::source_mesh::SourceMesh;
use super::source_row::SourceRow;
use super::vertex::{MeshError, VertexRow};
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::exposure_distortion::ExposureDistortion;

impl VertexRow {
    /// Writes the ways from this row's vertices to their sources, in order, as many as `sources`
    /// has room for, and returns the part of it that is filled. [`Self::origin_px`] does not
    /// matter.
    ///
    /// # Model
    /// That of [`SourceMesh`].
    ///
    /// # Units and frames
    /// Sensor frame, mm; measured - ideal, as a function of the *ideal* point.
    ///
    /// # Accuracy
    /// [`SourceMesh::bound_nm`] in blocks, that of [`SourceRow`] elsewhere.
    ///
    /// # Errors
    /// [`MeshError`], which names the first vertex that is off the image or has no source; those
    /// before it are written. [`MeshError::Spacing`] for a mesh of another spacing.
    pub fn sources<'out, D: ExposureDistortion>(
        &self,
        mesh: &SourceMesh<'_, D>,
        sources: &'out mut [Displacement],
    ) -> Result<&'out mut [Displacement], MeshError> {
        let sources = at_most(sources, self.count);
        self.fill(mesh, Millimetres, sources)?;
        Ok(sources)
    }

    /// Writes this row's vertices as a warp engine stores them, as many as `bytes` has room for,
    /// and returns the part of it that is filled.
    ///
    /// # Model
    /// That of [`SourceMesh`]; the differences are in the format's own steps. A number that lies
    /// within rounding of the middle of two steps may get either.
    ///
    /// # Accuracy
    /// As [`Self::sources`], divided by the pixel, and [`MeshFormat::quantisation_px`].
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
    /// use fmc_camera::geometry::frame_correction::FrameCorrection;
    /// use fmc_camera::geometry::mesh::{format::MeshFormat, source_mesh::SourceMesh};
    /// use fmc_camera::geometry::mesh::vertex::VertexRow;
    /// let mut lens = CalibrationParameters::new(100.0, [8001, 6001], 10.0);
    /// lens.distortion.k1 = -1e-6;
    /// let correction = FrameCorrection::without_motion(&Calibration::new(lens)?);
    /// let mesh = SourceMesh::new(&correction, 16);
    /// let (first_col_px, row_px, origin_px) = (2000, 3000, [0, 0]);
    /// let row = VertexRow { first_col_px, row_px, spacing_px: 16, count: 2, origin_px };
    /// let mut bytes = [0; 8];
    /// // 20 mm to the left of the centre K1·r³ is 8 µm to the right: 0.8 px, six eighths.
    /// assert_eq!(row.write_words(&mesh, MeshFormat::S16Q3, &mut bytes)?, [6, 0, 0, 0, 6, 0, 0, 0]);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Self::sources`], and [`MeshError::Format`] for the first vertex that the format does
    /// not hold.
    pub fn write_words<'out, D: ExposureDistortion>(
        &self,
        mesh: &SourceMesh<'_, D>,
        format: MeshFormat,
        bytes: &'out mut [u8],
    ) -> Result<&'out mut [u8], MeshError> {
        let pixels_per_mm = 1.0 / mesh.correction.polynomial().sensor().pixel_mm();
        let length = usize::from(self.count).saturating_mul(format.bytes());
        let room = bytes.len() - bytes.len() % format.bytes();
        let bytes = bytes.get_mut(..length.min(room)).unwrap_or_default();
        match format {
            MeshFormat::S16Q3 => {
                let store = s16q3::Store::new(pixels_per_mm);
                self.fill(mesh, store, bytes.as_chunks_mut().0)
            }
            MeshFormat::Uq12Q4 => {
                let store = uq12_4::Store::new(pixels_per_mm);
                self.fill(mesh, store, bytes.as_chunks_mut().0)
            }
            MeshFormat::Q12Q20 => {
                let store = q12_20::Store::new(pixels_per_mm);
                self.fill(mesh, store, bytes.as_chunks_mut().0)
            }
            MeshFormat::Single => {
                let store = single::Store::new(pixels_per_mm);
                self.fill(mesh, store, bytes.as_chunks_mut().0)
            }
        }?;
        Ok(bytes)
    }

    /// Fills a slice with the row's vertices.
    fn fill<D: ExposureDistortion, S: RowStore>(
        &self,
        mesh: &SourceMesh<'_, D>,
        store: S,
        words: &mut [S::Word],
    ) -> Result<(), MeshError> {
        if self.spacing_px != mesh.spacing_px {
            return Err(MeshError::Spacing {
                row_px: self.spacing_px,
                mesh_px: mesh.spacing_px,
            });
        }
        let polynomial = mesh.correction.polynomial();
        if let Some(blocks) = &mesh.blocks {
            return BlockRow::new(self, polynomial, blocks).fill(store, words);
        }
        let mut row = SourceRow::new(mesh.correction);
        let sensor = polynomial.sensor();
        self.fill_singly(sensor, &store, |ideal| row.next(ideal), (0, words))
    }
}

/// Returns at most the first `count` elements of a slice.
fn at_most<T>(slice: &mut [T], count: u16) -> &mut [T] {
    let count = usize::from(count).min(slice.len());
    slice.split_at_mut(count).0
}
