//! Meshes of sources by differences, for warp engines.

use super::block_matrix::{BlockMatrix, NODES};
use super::source_bound::SourceBound;
use crate::geometry::exposure_distortion::ExposureDistortion;
use crate::geometry::frame_correction::FrameCorrection;
use crate::geometry::sensor::{PixelPoint, Sensor, SensorPoint, pixels};

/// Largest error of a source by differences, nm per axis: where the longest blocks would exceed it,
/// they are shorter.
pub const SOURCE_BLOCK_NM: f32 = 4.0;

/// Ways from the vertices of the corrected image to their sources, for one frame: prepared once,
/// then computed row by row by [`VertexRow::sources`] and [`VertexRow::write_words`].
///
/// # Model
/// `d = D(ideal + d)`, as [`SourceRow`] has it. Along a row d is smooth where the measured points
/// lie on the sensor. There the row is cut into blocks of [`Self::block_length`] vertices, the
/// first from the first vertex on whose measured point is on the sensor, the last up to the last.
/// In every block six vertices, at 0, 1/8, 3/8, 5/8, 7/8 and 1, are solved by Newton's method; the
/// polynomial of degree 5 through them is computed at the others by its forward differences, in ten
/// additions per vertex. All other vertices are solved one by one: those whose measured point is
/// off the sensor or so near its upper or lower edge that one between two nodes might be, those of
/// rows shorter than a block, and all of a frame that has no blocks. All terms of the form are
/// evaluated.
///
/// A vertex of a frame that has blocks has the same bits however its row is cut into
/// [`VertexRow`]s, and on every machine.
///
/// # Units and frames
/// Vertices are pixels of the corrected image; the sources of [`VertexRow::sources`] are measured -
/// ideal in the sensor frame, mm.
///
/// # Accuracy
/// [`Self::bound_nm`] holds for every vertex of a block, against the exact inverse at the vertex's
/// exact place. With u = 2⁻²⁴, blocks of n vertices and length L, and the displacement's Taylor
/// coefficients along a row at most sₖ:
///
/// `error ≤ w₆·s₆L⁶ + Λ·e + u·(n·A + S)`:
///
/// - sₖ are the coefficients of the series s that solves `(1 - c₁)s = t + c₂s² + … + c₆s⁶`, where
///   cₖ bounds the k-th Taylor coefficient of D in any direction. That of `(X, Y)·Rⁿ` is at most
///   `C(2n + 1, k)·r²ⁿ⁺¹⁻ᵏ`, as the expansion of (r² + 2rt·cosφ + t²)ⁿ has no negative coefficient
///   but the cosine's powers. A frame whose c₁ exceeds one half has no blocks.
/// - w₆ = 0.00069 is the largest product of distances to the nodes, Λ = 1.79 the largest sum of the
///   absolute Lagrange polynomials.
/// - e is the largest error of a node: roundings of D, term by term, five of its place times D's
///   slope, and what the last Newton step leaves, all over 1 - c₁.
/// - A: each of n additions rounds the value by half a unit in its last place and the difference of
///   order k by `u·hᵏ·k!·pₖ`, of which `C(n, k + 1)` times as much reaches the end: `Lᵏpₖ/(k + 1)`
///   with the coefficients pₖ of the interpolating polynomial, `pₖ = Σ C(m, k)·sₘLᵐ⁻ᵏ`.
/// - S: the roundings of the coefficients at the start of a block.
///
/// The length is the longest of 64, 56, … 16 that keeps the bound within [`SOURCE_BLOCK_NM`]. At
/// most 0.5 nm were found on the published cameras (`tests/geometry/source_mesh.rs`).
///
/// [`SourceRow`]: super::source_row::SourceRow
/// [`VertexRow`]: super::vertex::VertexRow
/// [`VertexRow::sources`]: super::vertex::VertexRow::sources
/// [`VertexRow::write_words`]: super::vertex::VertexRow::write_words
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceMesh<'frame, D = FrameCorrection> {
    pub(super) correction: &'frame D,
    pub(super) spacing_px: u16,
    pub(super) blocks: Option<Blocks>,
}

/// Blocks of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Blocks {
    pub(super) matrix: BlockMatrix,
    /// Vertices from the first of a block to each of its nodes.
    pub(super) nodes: [u16; 6],
    /// Largest change of a displacement from a vertex to the nearest node, mm.
    pub(super) off_nodes_mm: f32,
    bound_nm: f32,
}

impl<'frame, D: ExposureDistortion> SourceMesh<'frame, D> {
    /// Returns the mesh of a frame with vertices every `spacing_px` pixels along its rows. A frame
    /// with residual grids has no blocks: across a knot of a grid the third derivative jumps, so
    /// that a polynomial of degree 5 does not follow.
    #[must_use]
    pub fn new(correction: &'frame D, spacing_px: u16) -> Self {
        let polynomial = correction.polynomial();
        let step_mm = f32::from(spacing_px) * polynomial.sensor().pixel_mm();
        let bound = if correction.is_polynomial() && spacing_px > 0 {
            SourceBound::new(polynomial)
        } else {
            None
        };
        let blocks = bound.and_then(|bound| {
            BlockMatrix::ALL.into_iter().find_map(|matrix| {
                let bound_nm = bound.nanometres(matrix.length, step_mm);
                (bound_nm <= SOURCE_BLOCK_NM).then(|| Blocks {
                    matrix,
                    nodes: NODES.map(|eighths| eighths * (matrix.length / 8)),
                    off_nodes_mm: bound.off_nodes_mm(matrix.length, step_mm),
                    bound_nm,
                })
            })
        });
        Self {
            correction,
            spacing_px,
            blocks,
        }
    }

    /// Returns the number of vertices from the start of a block to the next; `None` if every vertex
    /// is solved by itself, each predicted from those before it in its row.
    #[must_use]
    pub fn block_length(&self) -> Option<u16> {
        self.blocks.map(|blocks| blocks.matrix.length)
    }

    /// Returns an upper bound of the error of the vertices of a block, nm per axis; `None` as for
    /// [`Self::block_length`].
    #[must_use]
    pub fn bound_nm(&self) -> Option<f32> {
        self.blocks.map(|blocks| blocks.bound_nm)
    }
}

/// Returns the ideal point of a vertex.
pub(super) fn ideal(sensor: &Sensor, [col_px, row_px]: [u32; 2]) -> SensorPoint {
    sensor.sensor_from_pixel(PixelPoint {
        col_px: pixels(col_px),
        row_px: pixels(row_px),
    })
}
