//! Residual grids from distortion tables: polynomial and cubic B-splines, by least squares
//! together.

pub mod calibrated_grid;
pub mod calibration;
mod design;
pub mod fit;
pub mod grid_file;
pub mod lattice;
pub mod model_grid;
mod outcome;
mod plane_target;
mod plausibility;
pub mod polynomial;
mod reduced;
pub mod request;
mod roughness;
pub mod run_out;
mod smoother;
pub mod table;
mod warnings;
