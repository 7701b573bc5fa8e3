//! Points, interior orientations and meshes of many frames.

mod arrays;
pub(super) mod flight;
mod gridded;
mod lists;
mod orientations;
mod parquet;
mod points;
mod poses;
mod refused;
mod shifted;
mod trajectory;
