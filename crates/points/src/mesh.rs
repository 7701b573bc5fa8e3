//! Mesh of the sources of a corrected image.

use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::mesh::vertex::VertexRow;

use fmc_camera::geometry::mesh::vertex::MeshError;
use thiserror::Error;

/// Sources of the vertices of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Rows, columns, and the two numbers of a source.
    pub shape: [usize; 3],
    /// Column and row of each source, px.
    pub sources_px: Vec<f64>,
}

/// Reason why there is no mesh.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum MeshRefusal {
    /// A row would have too many vertices.
    #[error("spacing = {spacing_px}: more than 65535 vertices in a row")]
    Vertices {
        /// Distance of the vertices, px.
        spacing_px: u16,
    },
    /// A vertex has no source.
    #[error(transparent)]
    Source(#[from] MeshError),
}

/// Returns the mesh with a vertex every `spacing_px` pixels, the last at the last pixel or beyond.
///
/// # Errors
/// [`MeshRefusal`] for a vertex without a source, or a row of more than 65,535 vertices. A spacing
/// of 0 is one of 1.
#[inline(never)]
pub fn mesh(
    correction: &GriddedCorrection<'_>,
    pixel_um: f64,
    spacing_px: u16,
) -> Result<Mesh, MeshRefusal> {
    let sensor = correction.polynomial().sensor();
    let spacing_px = spacing_px.max(1);
    let spacing = u32::from(spacing_px);
    let vertices =
        [sensor.height_px(), sensor.width_px()].map(|side| (side - 1).div_ceil(spacing) + 1);
    let [rows, columns] = vertices;
    let count = u16::try_from(columns).map_err(|_| MeshRefusal::Vertices { spacing_px })?;
    let mesh = SourceMesh::new(correction, spacing_px);
    let [_, row_length] = vertices.map(|count| count as usize);
    let mut displacements = vec![Displacement::default(); row_length];
    let mut sources_px = Vec::with_capacity(2 * row_length * rows as usize);
    for row in 0..rows {
        let vertices = VertexRow {
            first_col_px: 0,
            row_px: row * spacing,
            spacing_px,
            count,
            origin_px: [0, 0],
        };
        let found = vertices.sources(&mesh, &mut displacements)?;
        for (column, displacement) in (0..columns).zip(found) {
            // Rows go down.
            let [dx_um, dy_um] =
                [displacement.dx_mm, displacement.dy_mm].map(|d| 1000.0 * f64::from(d));
            sources_px.push(f64::from(column * spacing) + dx_um / pixel_um);
            sources_px.push(f64::from(row * spacing) - dy_um / pixel_um);
        }
    }
    Ok(Mesh {
        shape: [rows as usize, row_length, 2],
        sources_px,
    })
}
