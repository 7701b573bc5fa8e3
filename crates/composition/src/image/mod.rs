//! Images in memory, and places of the same content in two of them.

pub mod matching;
mod plane;

pub use plane::Plane;
