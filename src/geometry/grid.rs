//! Residual grid: the distortion that the polynomial leaves, as a uniform cubic B-spline.
//!
//! A lens and a chip each leave a structure of their own: that of the lens moves with the principal
//! point, that of the chip does not ([`GridCarrier`]). The coefficients stay where they are stored,
//! in flash memory for example; a [`ResidualGrid`] borrows the bytes of the file and is valid for
//! as long as they are there.
//!
//! # Examples
//! ```
//! use fmc_camera::SensorPoint;
//! use fmc_camera::geometry::grid::{GridCarrier, GridHeader, PlacedGrid, ResidualGrid};
//!
//! let header = GridHeader {
//!     carrier: GridCarrier::Sensor,
//!     columns: 4,
//!     rows: 4,
//!     first_node: SensorPoint::new(-3.0, -3.0),
//!     pitch_mm: 2.0,
//!     scale_mm: 1e-7,
//! };
//! // Equal coefficients are a constant: 10000 · 0.1 nm to the right, -0.5 µm upwards.
//! let mut file = header.to_bytes().to_vec();
//! for _ in 0..16 {
//!     file.extend([10_000_i16.to_le_bytes(), (-5000_i16).to_le_bytes()].concat());
//! }
//! file.extend(GridHeader::checksum(&file).to_le_bytes());
//! let grid = ResidualGrid::parse(&file)?;
//! let found = PlacedGrid::calibrated(&grid).displacement(SensorPoint::new(0.3, -0.8));
//! assert!((found.dx_mm - 1e-3).abs() < 1e-9 && (found.dy_mm + 5e-4).abs() < 1e-9);
//! # Ok::<(), fmc_camera::geometry::grid::GridError>(())
//! ```

mod bounds;
mod grid_buffer;
mod grid_checksums;
mod grid_error;
mod header;
mod node;
mod placed_grid;
mod range;
mod residual_grid;

pub use bounds::GridBounds;
pub use grid_buffer::GridBuffer;
pub use grid_checksums::GridChecksums;
pub use grid_error::GridError;
pub use header::{GridCarrier, GridHeader};
pub use placed_grid::PlacedGrid;
pub use range::{MAX_FILE_BYTES, MAX_NODES, MIN_SIDE_NODES};
pub use residual_grid::ResidualGrid;
