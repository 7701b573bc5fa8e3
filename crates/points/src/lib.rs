//! Points in arrays, as another language has them: of one frame ([`FramePoints`]), of many
//! ([`FlightPoints`]), in columns of a table ([`ColumnPoints`]), and the vertices of a mesh
//! ([`mesh()`]).
//!
//! An array is of one precision for its whole length ([`Points`]). In single precision the answers
//! have the bits of the camera. In double precision a coordinate keeps its digits: the distortion
//! is computed as the camera does, with the terms that its precision leaves out, and added.
//!
//! Everything that is done once for each point is here, and nothing of the other language, so that
//! a program can compile this crate for speed and the rest of itself for size. For this the
//! functions that take arrays are not generic, and are never part of those that call them.
//!
//! Everything computes in the calling thread.

#![forbid(unsafe_code)]

mod answer;
mod columns;
mod coordinate;
mod correction_kernel;
mod direction;
mod flight;
mod flight_points;
mod frame_corrections;
mod frame_in_use;
mod frame_points;
mod mesh;
mod numbers;
mod off_sensor;
mod point_error;
mod runs;
mod slices;
mod unit;

pub use answer::Answer;
pub use columns::{ColumnPoints, Flag, FlaggedColumns};
pub use coordinate::Coordinate;
pub use correction_kernel::CorrectionKernel;
pub use direction::Direction;
pub use flight::{Flight, FlightCamera, left_out};
pub use flight_points::FlightPoints;
pub use frame_corrections::FrameCorrections;
pub use frame_points::FramePoints;
pub use mesh::{Mesh, MeshRefusal, mesh};
pub use off_sensor::OffSensor;
pub use point_error::PointError;
pub use runs::places;
pub use slices::{Answers, Points, PointsMut};
pub use unit::Unit;

/// Points that are computed together: their numbers fit the first-level cache.
const TOGETHER: usize = 512;
