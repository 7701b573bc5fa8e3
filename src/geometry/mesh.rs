//! Rows of equidistant points, for warp engines.
//!
//! Two fields along a row are of use, and neither is the negative of the other:
//! - [`displacement_rows`]: at points of the *measured* image the distortion, measured - ideal,
//!   which leads from a measured pixel to its corrected place. It is computed by differences, in 13
//!   instructions per point. Graphics processors draw it; [`pixel_correction`] has it in pixels.
//! - [`source_mesh`]: at points of the *ideal* image the way to the measured point, which leads
//!   from an output pixel to its source, by differences as well. Warp engines read it, in the
//!   formats that [`format`](mod@format) has. [`source_row`] has it point by point, and [`vertex`]
//!   in pixels.

#[cfg(host_kernel)]
mod block_group;
mod block_matrix;
mod block_row;
mod differences;
pub mod displacement_rows;
pub mod format;
pub mod pixel_correction;
mod rounding_bound;
mod row_polynomial;
mod row_store;
mod single_vertices;
mod source_bound;
pub mod source_mesh;
pub mod source_row;
mod source_words;
pub mod vertex;
