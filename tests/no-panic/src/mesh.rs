//! Rows for warp engines.

use fmc_camera::geometry::mesh::{
    MeshRow,
    displacement_rows::{DisplacementRow, DisplacementRows},
    format::{MeshFormat, q12_20, s16q3, single, uq12_4},
    source_row::SourceRow,
    vertex::VertexRow,
};

/// Keeps the public functions of `fmc_camera::geometry::mesh`.
pub(crate) fn keep() {
    keep![
        MeshRow::points,
        DisplacementRows::new,
        DisplacementRows::restart_interval,
        DisplacementRows::rounding_bound_nm,
        DisplacementRows::row,
        DisplacementRow::write,
        SourceRow::new,
        SourceRow::next,
        VertexRow::vertices,
        VertexRow::words,
        MeshFormat::bytes,
        MeshFormat::quantisation_px,
        MeshFormat::word,
        s16q3::bytes,
        uq12_4::bytes,
        q12_20::bytes,
        single::bytes,
        single::quantisation_px,
    ];
}
