//! Mosaic of the sub-images in the virtual image.

mod composite;
mod geometry;
mod green;
mod layer;
pub mod registration;
mod seam;
mod steps;

pub use composite::{Composite, compose, memory_bytes};
pub use geometry::Geometry;
pub use green::{GreenMatch, green_pairs};
pub use layer::Layer;
pub use steps::{SeamStep, steps};
