//! Residual grids from distortion tables: polynomial and cubic B-splines, by least squares
//! together.

pub mod fit;
pub mod grid_file;
pub mod lattice;
mod polynomial;
mod roughness;
mod smoother;
pub mod table;
