//! Functions of the geometry that are generic over the correction, once more with residual grids.

use fmc_camera::geometry::{
    gridded_correction::GriddedCorrection,
    mesh::{source_mesh::SourceMesh, source_row::SourceRow, vertex::VertexRow},
};

/// Keeps the functions for a correction with grids.
pub(crate) fn keep() {
    keep![
        SourceMesh::<GriddedCorrection<'_>>::new,
        SourceMesh::<GriddedCorrection<'_>>::block_length,
        SourceMesh::<GriddedCorrection<'_>>::bound_nm,
        SourceRow::<GriddedCorrection<'_>>::new,
        SourceRow::<GriddedCorrection<'_>>::next,
        VertexRow::vertices::<GriddedCorrection<'_>>,
        VertexRow::words::<GriddedCorrection<'_>>,
        VertexRow::sources::<GriddedCorrection<'_>>,
        VertexRow::write_words::<GriddedCorrection<'_>>,
    ];
}
