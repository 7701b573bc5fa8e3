//! Rows of equidistant points, for warp engines.
//!
//! Two fields along a row are of use, and neither is the negative of the other:
//! - [`displacement_rows`]: at points of the *measured* image the distortion, measured - ideal,
//!   which leads from a measured pixel to its corrected place. It is computed by differences, in 13
//!   instructions per point. Graphics processors draw it; [`pixel_correction`] has it in pixels.
//! - [`source_row`]: at points of the *ideal* image the way to the measured point, which leads from
//!   an output pixel to its source. Warp engines read it; [`vertex`] has it in pixels and
//!   [`format`](mod@format) in the formats that they store.

mod differences;
pub mod displacement_rows;
pub mod format;
pub mod pixel_correction;
mod rounding_bound;
mod row_polynomial;
pub mod source_row;
pub mod vertex;
